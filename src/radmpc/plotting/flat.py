"""The artists of a plane picture."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import shapely
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.patches import Circle, FancyArrowPatch, Polygon, Rectangle

from radmpc.arrays import Matrix
from radmpc.model.obstacle import Obstacle
from radmpc.model.plan import Trajectory
from radmpc.model.scenario import Workspace
from radmpc.model.vehicle import Vehicle
from radmpc.plotting.curves import confidence_ellipses, mean_path, point_along, positions
from radmpc.plotting.labels import LabelBoard
from radmpc.plotting.style import MUTED, OBSTACLE_EDGE, OBSTACLE_FILL

__all__ = ["Color", "draw_ends", "draw_obstacle", "draw_trajectory", "draw_workspace"]

Color = tuple[float, float, float]


def draw_workspace(ax: Axes, workspace: Workspace, board: LabelBoard) -> None:
    """Draw the outline of the workspace."""
    width, height = workspace.upper - workspace.lower
    ax.add_patch(
        Rectangle(
            (float(workspace.lower[0]), float(workspace.lower[1])),
            float(width),
            float(height),
            fill=False,
            edgecolor=MUTED,
            linewidth=0.7,
            linestyle=(0, (6, 3)),
            zorder=1,
            gid="workspace",
        )
    )
    low, high = workspace.lower, workspace.upper
    corners = np.array([low, (high[0], low[1]), high, (low[0], high[1]), low])
    board.avoid(_dense(corners, 60))


def draw_obstacle(ax: Axes, obstacle: Obstacle, board: LabelBoard) -> None:
    """Draw an obstacle and its name; a moving one fades in from its first step to its last."""
    last = len(obstacle.steps) - 1
    for step, pieces in enumerate(obstacle.steps):
        outline = shapely.union_all([shapely.Polygon(piece.vertices) for piece in pieces])
        alpha = 1.0 if last == 0 else 0.08 + 0.72 * (step / last) ** 2
        ax.add_patch(
            Polygon(
                _ring(outline),
                facecolor=OBSTACLE_FILL,
                edgecolor=OBSTACLE_EDGE,
                linewidth=0.6,
                alpha=alpha,
                zorder=2,
                gid=f"obstacle:{obstacle.name}",
            )
        )
        board.avoid(_dense(_ring(outline)))
    _name_obstacle(obstacle, board)


def _name_obstacle(obstacle: Obstacle, board: LabelBoard) -> None:
    """Write the name inside the largest piece, upright or turned, else beside it."""
    largest = max(obstacle.steps[-1], key=lambda p: shapely.Polygon(p.vertices).area)
    width, height = np.ptp(largest.vertices, axis=0)
    center = largest.vertices.mean(axis=0)
    if board.fits(obstacle.name, width, height):
        board.put(obstacle.name, center, MUTED)
    elif board.fits(obstacle.name, height, width):
        board.put(obstacle.name, center, MUTED, rotation=90.0)
    else:
        board.beside(obstacle.name, center, 0.5 * np.array([width, height]), MUTED)


def draw_ends(ax: Axes, vehicle: Vehicle, color: Color) -> None:
    """Draw the hull at the start as an open circle, the goal as a box with a star."""
    x, y = vehicle.start_position
    ax.add_patch(
        Circle(
            (float(x), float(y)),
            vehicle.radius,
            facecolor="white",
            edgecolor=color,
            linewidth=0.9,
            zorder=6,
            gid=f"start:{vehicle.name}",
        )
    )
    lower, size = vehicle.goal.lower, vehicle.goal.upper - vehicle.goal.lower
    ax.add_patch(
        Rectangle(
            (float(lower[0]), float(lower[1])),
            float(size[0]),
            float(size[1]),
            facecolor=(*color, 0.25),
            edgecolor=color,
            linewidth=0.7,
            zorder=6,
            gid=f"goal:{vehicle.name}",
        )
    )
    ax.plot(
        *vehicle.goal.center[:, None],
        marker="*",
        markersize=5.5,
        markeredgewidth=0.4,
        markeredgecolor="white",
        color=color,
        zorder=8,
        gid=f"star:{vehicle.name}",
    )


def draw_trajectory(
    ax: Axes, vehicle: Vehicle, trajectory: Trajectory, dt: float, color: Color
) -> None:
    """Draw the swept hull, the 3σ ellipses, the mean path, its steps and its direction."""
    name, path = vehicle.name, mean_path(vehicle, trajectory, dt)
    swept = shapely.LineString(path).buffer(vehicle.radius)
    ax.add_patch(
        Polygon(
            np.asarray(swept.exterior.coords),
            facecolor=(*color, 0.10),
            edgecolor="none",
            zorder=2.5,
            gid=f"hull:{name}",
        )
    )
    ax.add_collection(
        PolyCollection(
            confidence_ellipses(vehicle, trajectory),
            facecolors=[(*color, 0.20)],
            edgecolors=[(*color, 0.45)],
            linewidths=0.35,
            zorder=3,
            gid=f"ellipses:{name}",
        ),
        autolim=False,
    )
    ax.plot(*path.T, color=color, linewidth=1.1, zorder=5, gid=f"path:{name}")
    steps = positions(vehicle, trajectory)[1:]
    ax.plot(
        *steps.T, linestyle="none", marker=".", markersize=3.2, color=color, zorder=5.5,
        gid=f"steps:{name}",
    )  # fmt: skip
    for share in (0.3, 0.7):
        _draw_arrow(ax, path, share, color, name)


def _draw_arrow(ax: Axes, path: Matrix, share: float, color: Color, name: str) -> None:
    """Draw an arrow head on the path."""
    found = point_along(path, share)
    if found is None:
        return
    point, direction = found
    # The shaft is shrunk to nothing: only the head shows, whatever the scale.
    tail = point - 1e-3 * direction
    ax.add_patch(
        FancyArrowPatch(
            (float(tail[0]), float(tail[1])),
            (float(point[0]), float(point[1])),
            arrowstyle="-|>,head_length=0.5,head_width=0.28",
            mutation_scale=9.0,
            shrinkA=0.0,
            shrinkB=0.0,
            linewidth=0.4,
            color=color,
            zorder=6.5,
            gid=f"arrow:{name}",
        )
    )


def _ring(polygon: shapely.Geometry) -> Matrix:
    """Return the outer corners of a polygon."""
    outline = polygon if polygon.geom_type == "Polygon" else polygon.convex_hull
    return np.asarray(outline.exterior.coords)


def _dense(ring: Matrix, count: int = 8) -> Matrix:
    """Return points along a closed line, so that texts notice its sides too."""
    share = np.linspace(0.0, 1.0, count, endpoint=False)[:, None]
    return np.vstack([a + share * (b - a) for a, b in pairwise(ring)])
