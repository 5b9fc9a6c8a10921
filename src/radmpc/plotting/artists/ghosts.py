"""Moving obstacles where a vehicle is nearest: else a crossing path looks like a collision."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

import numpy as np
import shapely
from matplotlib.axes import Axes
from matplotlib.patches import Circle, Polygon
from mpl_toolkits.mplot3d import Axes3D
from mpl_toolkits.mplot3d.art3d import Line3DCollection, Poly3DCollection

from radmpc.arrays import Matrix, Vector
from radmpc.facets import facets, surface
from radmpc.model.obstacle import Obstacle
from radmpc.model.plan import Plan
from radmpc.model.relations.concerns import is_for
from radmpc.plotting.artists.flat import Color
from radmpc.plotting.artists.obstacles import along_lines, ring_of, seen
from radmpc.plotting.canvas.space_labels import Board, SpaceBoard
from radmpc.plotting.canvas.style import NUMBER_SIZE, OBSTACLE_FILL, WALL_WIDTH
from radmpc.plotting.clearances import distances_at_steps, touches_sweep
from radmpc.plotting.curves import Plane, positions
from radmpc.records import dataclass

__all__ = ["Ghost", "draw_ghosts", "nearest_ghosts"]

_MOST_PER_OBSTACLE = 3
"""Ghosts of one obstacle: more would hide each other."""

_DASH = 4.0
"""Length of dashes of ghosts at one step [line widths]."""

Dashes = Literal["solid"] | tuple[float, tuple[float, float]]
"""A line's style, as matplotlib takes it."""


@dataclass(frozen=True, slots=True, eq=False)
class Ghost:
    """A moving obstacle and a vehicle at the step at which they are nearest.

    Attributes
    ----------
    obstacle : Obstacle
        What moves.
    index : int
        Of the vehicle.
    step : int
        Step at which they are nearest.
    distance : float
        Between the hulls at that step [m].
    """

    obstacle: Obstacle
    index: int
    step: int
    distance: float


def nearest_ghosts(plan: Plan) -> tuple[Ghost, ...]:
    """Return the ghosts of a plan.

    Parameters
    ----------
    plan : Plan
        Without trajectories there are none.

    Returns
    -------
    tuple of Ghost
        For every moving obstacle at most three, the nearest first: of the vehicles that it concerns
        and that cross its way, or of the nearest of them if none does.
    """
    found: list[Ghost] = []
    for obstacle in plan.scenario.obstacles:
        if not obstacle.is_moving or not plan.trajectories:
            continue
        flown = enumerate(plan.scenario.vehicles)
        concerned = [i for i, vehicle in flown if is_for(obstacle, vehicle.name)]
        crossing = [i for i in concerned if touches_sweep(plan, i, obstacle)]
        ghosts = sorted(
            (_ghost(plan, i, obstacle) for i in crossing or concerned), key=lambda g: g.distance
        )
        found += ghosts[: _MOST_PER_OBSTACLE if crossing else 1]
    return tuple(found)


def draw_ghosts(ax: Axes, plan: Plan, board: Board, colors: dict[str, Color], plane: Plane) -> None:
    """Draw obstacle and hull at the nearest step in the vehicle's color, and the step's number.

    Parameters
    ----------
    ax : Axes
        Axes to draw on.
    plan : Plan
        With moving obstacles or without.
    board : LabelBoard or SpaceBoard
        Where other texts stand.
    colors : dict
        Color by vehicle.
    plane : (int, int)
        The two coordinates that are drawn.
    """
    ghosts = nearest_ghosts(plan)
    for number, ghost in enumerate(ghosts):
        dashes = _dashes(ghosts, number)
        vehicle = plan.scenario.vehicles[ghost.index]
        color = colors[vehicle.name]
        place = positions(vehicle, plan.trajectories[ghost.index])[ghost.step]
        name, text = f"{ghost.obstacle.name}:{vehicle.name}", f"step {ghost.step}"
        if isinstance(board, SpaceBoard):
            top = _draw_solid(ax, ghost, color, dashes, f"ghost:{name}")
            ax.plot(
                *place[:, None], linestyle="none", marker="o", markersize=6.0, color=color,
                markerfacecolor=(*color, 0.3), markeredgewidth=0.8, zorder=52, gid=f"near:{name}",
            )  # fmt: skip
            board.beside(text, top, color, size=NUMBER_SIZE, gid=f"ghost-step:{name}")
            continue
        x, y = place[list(plane)]
        hull = Circle(
            (float(x), float(y)), vehicle.radius, facecolor=(*color, 0.25), edgecolor=color,
            linewidth=0.9, zorder=5.2, gid=f"near:{name}",
        )  # fmt: skip
        ax.add_patch(hull)
        corners = _draw_outline(ax, ghost, color, dashes, plane, f"ghost:{name}")
        board.avoid(along_lines(np.vstack([corners, corners[:1]])))
        middle, half = 0.5 * (corners.max(0) + corners.min(0)), 0.5 * np.ptp(corners, axis=0)
        board.beside(text, middle, half, color, size=NUMBER_SIZE, gid=f"ghost-step:{name}")


def _ghost(plan: Plan, index: int, obstacle: Obstacle) -> Ghost:
    """Return where a vehicle and an obstacle are nearest."""
    distances = distances_at_steps(plan, index, obstacle)
    step = int(distances.argmin())
    return Ghost(obstacle, index, step, float(distances[step]))


def _dashes(ghosts: Sequence[Ghost], number: int) -> Dashes:
    """Return the line that shows a ghost beside those of the same obstacle at the same step.

    Each has dashes where the others have gaps: one would cover the others.
    """
    one = ghosts[number]
    same = [i for i, g in enumerate(ghosts) if g.obstacle is one.obstacle and g.step == one.step]
    if len(same) == 1:
        return "solid"
    offset = _DASH * ((len(same) - same.index(number)) % len(same))
    return offset, (_DASH, _DASH * (len(same) - 1))


def _draw_outline(
    ax: Axes, ghost: Ghost, color: Color, dashes: Dashes, plane: Plane, gid: str
) -> Matrix:
    """Draw an obstacle in the plane; return its corners, (c, 2) [m]."""
    outline = shapely.union_all([seen(p, plane) for p in ghost.obstacle.at(ghost.step)])
    if outline.area == 0.0:
        corners = np.asarray(shapely.get_coordinates(outline))
        ax.plot(
            *corners.T, color=color, linewidth=WALL_WIDTH, linestyle=dashes, marker="o",
            markersize=WALL_WIDTH, markeredgewidth=0.0, zorder=2.45, gid=gid,
        )  # fmt: skip
        return corners
    ring = ring_of(outline)
    # Below all outlines, of which one would else be hidden by the next one's area.
    ax.add_patch(Polygon(ring, facecolor=OBSTACLE_FILL, edgecolor="none", zorder=2.44))
    ax.add_patch(
        Polygon(
            ring, fill=False, edgecolor=color, linewidth=0.9, linestyle=dashes, zorder=2.45, gid=gid
        )
    )
    return ring


def _draw_solid(ax: Axes3D, ghost: Ghost, color: Color, dashes: Dashes, gid: str) -> Vector:
    """Draw an obstacle in space; return its highest corner, (3,) [m]."""
    for piece in ghost.obstacle.at(ghost.step):
        triangles = surface(piece.vertices)
        if len(triangles) > 0:
            ax.add_collection3d(
                Poly3DCollection(triangles, facecolors=OBSTACLE_FILL, alpha=0.45, linewidths=0.0)
            )
        edges = piece.vertices[facets(piece.vertices).edges]
        width = 0.9 if len(triangles) > 0 else WALL_WIDTH
        ax.add_collection3d(
            Line3DCollection(edges, colors=[color], linewidths=width, linestyles=[dashes], gid=gid)
        )
    corners = np.vstack([piece.vertices for piece in ghost.obstacle.at(ghost.step)])
    return np.asarray(corners[corners[:, 2].argmax()])
