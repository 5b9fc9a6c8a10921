"""Obstacles and goals as outlines, lines and triangles in local coordinates."""

from __future__ import annotations

from typing import Literal

import numpy as np

from radmpc.arrays import Matrix
from radmpc.facets import facets, surface
from radmpc.geometry import Polytope
from radmpc.model.obstacle import LineShape, Obstacle, PolygonShape
from radmpc.model.vehicle import Goal
from radmpc.model.visits import Visit

__all__ = ["Kind", "footprint", "goal_outline", "holes", "kind_of", "outline", "triangles"]

Kind = Literal["Polygon", "LineString", "Point"]
"""What maps call what has an area, a length, or neither."""


def outline(obstacle: Obstacle, step: int) -> tuple[Kind, Matrix]:
    """Return what a plane obstacle is at a step, and its corners (v, 2) [m].

    Those of a polygon are counter-clockwise, those of a line in order.

    Parameters
    ----------
    obstacle : Obstacle
        In the plane.
    step : int
        Step k; any of a fixed obstacle.
    """
    # All plane obstacles but polygons and lines are convex: one piece.
    corners = obstacle.at(step)[0].vertices
    if len(corners) > 2 and isinstance(obstacle.shape, PolygonShape):
        vertices = obstacle.shape.vertices
        corners = vertices if _area(vertices) > 0.0 else vertices[::-1]
    if len(corners) > 1 and isinstance(obstacle.shape, LineShape):
        return "LineString", obstacle.shape.points
    return kind_of(corners), corners


def holes(obstacle: Obstacle) -> list[Matrix]:
    """Return the corners of an obstacle's holes, clockwise, (h, 2) each [m].

    Parameters
    ----------
    obstacle : Obstacle
        In the plane; only polygons have holes.
    """
    free = obstacle.shape.holes if isinstance(obstacle.shape, PolygonShape) else ()
    return [corners if _area(corners) < 0.0 else corners[::-1] for corners in free]


def kind_of(corners: Matrix) -> Kind:
    """Return what the corners of a convex set (v, d) make."""
    return "Point" if len(corners) == 1 else "LineString" if len(corners) == 2 else "Polygon"


def footprint(piece: Polytope) -> tuple[Kind, Matrix]:
    """Return what a body is as seen from above, and its corners (v, 2) [m]."""
    shadow = piece.vertices[:, :2]
    corners = shadow[facets(shadow).corners]
    return kind_of(corners), corners


def goal_outline(goal: Goal | Visit) -> Matrix | None:
    """Return a goal's corners in the plane, counter-clockwise, (4, 2) [m]; None if it has no area.

    Of a goal in space this is what is seen from above. Visits are boxes alike.
    """
    (west, south), (east, north) = goal.lower[:2], goal.upper[:2]
    if not (west < east and south < north):
        return None
    return np.array([[west, south], [east, south], [east, north], [west, north]])


def triangles(piece: Polytope) -> Matrix:
    """Return a convex piece as triangles, their corners in a row, (3 k, d) [m].

    In space they are its surface, seen counter-clockwise from outside. Of what has no area there
    are none.
    """
    corners = piece.vertices
    if piece.dimension == 3:
        return surface(corners).reshape(-1, 3)
    fan = [(0, i, i + 1) for i in range(1, len(corners) - 1)]
    return np.asarray(corners[np.array(fan, dtype=np.int64).ravel()])


def _area(corners: Matrix) -> float:
    """Return the signed area of an outline [m²]; positive if it runs counter-clockwise."""
    x, y = corners.T
    return float(0.5 * np.sum(x * np.roll(y, -1) - y * np.roll(x, -1)))
