"""Obstacles and goals as outlines and triangles in local coordinates."""

from __future__ import annotations

import numpy as np
from scipy.spatial import ConvexHull

from radmpc.arrays import Matrix
from radmpc.geometry import Polytope
from radmpc.model.obstacle import Obstacle, PolygonShape
from radmpc.model.vehicle import Goal

__all__ = ["footprint", "goal_outline", "outline", "triangles"]


def outline(obstacle: Obstacle, step: int) -> Matrix:
    """Return the corners of a plane obstacle at a step, counter-clockwise, (v, 2) [m]."""
    if isinstance(obstacle.shape, PolygonShape):
        vertices = obstacle.shape.vertices
        return vertices if _area(vertices) > 0.0 else vertices[::-1]
    # All other plane obstacles are convex: one piece.
    return obstacle.at(step)[0].vertices


def footprint(piece: Polytope) -> Matrix:
    """Return the outline of a body seen from above, counter-clockwise, (v, 2) [m]."""
    shadow = piece.vertices[:, :2]
    return np.asarray(shadow[ConvexHull(shadow).vertices])


def goal_outline(goal: Goal) -> Matrix | None:
    """Return a goal's corners in the plane, counter-clockwise, (4, 2) [m]; None if it has no area.

    Of a goal in space this is what is seen from above.
    """
    (west, south), (east, north) = goal.lower[:2], goal.upper[:2]
    if not (west < east and south < north):
        return None
    return np.array([[west, south], [east, south], [east, north], [west, north]])


def triangles(piece: Polytope) -> Matrix:
    """Return a convex piece as triangles, their corners in a row, (3 k, d) [m].

    In space they are its surface, seen counter-clockwise from outside.
    """
    corners = piece.vertices
    if piece.dimension == 2:
        fan = [(0, i, i + 1) for i in range(1, len(corners) - 1)]
        return np.asarray(corners[np.array(fan).ravel()])
    hull = ConvexHull(corners)
    first, second, third = corners[hull.simplices.T]
    # Qhull gives no order; the plane's normal points outward.
    normals = np.cross(second - first, third - first)
    is_inward = np.einsum("ij,ij->i", normals, hull.equations[:, :3]) < 0.0
    second[is_inward], third[is_inward] = third[is_inward], second[is_inward]
    return np.asarray(np.stack([first, second, third], axis=1).reshape(-1, 3))


def _area(corners: Matrix) -> float:
    """Return the signed area of an outline [m²]; positive if it runs counter-clockwise."""
    x, y = corners.T
    return float(0.5 * np.sum(x * np.roll(y, -1) - y * np.roll(x, -1)))
