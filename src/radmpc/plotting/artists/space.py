"""The artists of a picture in space."""

from __future__ import annotations

import numpy as np
from mpl_toolkits.mplot3d import Axes3D
from mpl_toolkits.mplot3d.art3d import Line3DCollection, Poly3DCollection

from radmpc.arrays import Matrix
from radmpc.facets import facets, surface
from radmpc.model.obstacle import Obstacle
from radmpc.model.plan import Trajectory
from radmpc.model.scenario import Workspace
from radmpc.model.vehicle import Vehicle
from radmpc.plotting.artists.flat import Color
from radmpc.plotting.artists.relations import name_text
from radmpc.plotting.canvas.space_labels import SpaceBoard
from radmpc.plotting.canvas.style import (
    MUTED,
    NUMBER_SIZE,
    OBSTACLE_EDGE,
    OBSTACLE_FILL,
    POST_SIZE,
    STAR_SIZE,
    WALL_WIDTH,
    Dashes,
    numbered_steps,
)
from radmpc.plotting.curves import ellipsoid_rings, mean_path, point_along, positions, stays

__all__ = [
    "draw_ends_3d",
    "draw_obstacle_3d",
    "draw_trajectory_3d",
    "draw_workspace_3d",
    "number_steps_3d",
]

_PALE = 0.4
"""Opacity of obstacles that some vehicles pass through, as a share of that of others [-]."""


def draw_workspace_3d(ax: Axes3D, workspace: Workspace) -> None:
    """Draw the twelve edges of the workspace.

    Parameters
    ----------
    ax : Axes3D
        Axes to draw on.
    workspace : Workspace
        The box to draw.
    """
    corners = np.array(
        np.meshgrid(*zip(workspace.lower, workspace.upper, strict=True), indexing="ij")
    ).reshape(3, -1)
    edges = [
        np.stack([a, b])
        for i, a in enumerate(corners.T)
        for b in corners.T[i + 1 :]
        if np.count_nonzero(a != b) == 1
    ]
    ax.add_collection3d(
        Line3DCollection(edges, colors=MUTED, linewidths=0.5, linestyles="dashed", gid="workspace")
    )


def draw_obstacle_3d(
    ax: Axes3D,
    obstacle: Obstacle,
    board: SpaceBoard,
    *,
    is_named: bool = True,
    strength: float = 1.0,
) -> None:
    """Draw an obstacle and, on request, its name; a moving one fades in from first to last step.

    A strength below 1 makes a moving one paler.

    Parameters
    ----------
    ax : Axes3D
        Axes to draw on.
    obstacle : Obstacle
        The obstacle to draw.
    board : SpaceBoard
        Where other texts stand.
    is_named : bool
        Whether its name is written.
    strength : float
        Opacity of a moving obstacle, as a share of the usual [-].
    """
    last = len(obstacle.steps) - 1
    for step, pieces in enumerate(obstacle.steps):
        alpha = 0.45 if last == 0 else strength * (0.03 + 0.3 * (step / last) ** 2)
        if obstacle.concerns is not None:
            alpha *= _PALE
        for piece in pieces:
            _draw_piece_3d(ax, obstacle.name, piece.vertices, alpha)
    if not is_named:
        return
    top = np.vstack([piece.vertices for piece in obstacle.steps[-1]])
    place = (*top.mean(axis=0)[:2], float(top[:, 2].max()))
    board.beside(name_text(obstacle), np.asarray(place), MUTED, gid=f"label:{obstacle.name}")


def _draw_piece_3d(ax: Axes3D, name: str, corners: Matrix, alpha: float) -> None:
    """Draw a convex piece: its surface and edges, a wire as a line, a post as a dot."""
    # A facet's corners in order would need more than its triangles do; their edges would show.
    triangles, gid = surface(corners), f"obstacle:{name}"
    if len(corners) == 1:
        ax.plot(*corners.T, color=OBSTACLE_EDGE, marker="o", markersize=POST_SIZE, gid=gid)
        return
    has_surface = len(triangles) > 0
    if has_surface:
        ax.add_collection3d(
            Poly3DCollection(
                triangles, facecolors=OBSTACLE_FILL, alpha=alpha, linewidths=0.0, gid=gid
            )
        )
    edges = Line3DCollection(
        corners[facets(corners).edges],
        colors=OBSTACLE_EDGE,
        linewidths=0.5 if has_surface else WALL_WIDTH,
        alpha=min(1.0, 2.0 * alpha),
        capstyle="round",
    )
    if not has_surface:
        edges.set_gid(gid)
    ax.add_collection3d(edges)


def draw_ends_3d(ax: Axes3D, vehicle: Vehicle, color: Color) -> None:
    """Draw the start as a circle, visits as rhombs, the goal as a star, in front of all else.

    Parameters
    ----------
    ax : Axes3D
        Axes to draw on.
    vehicle : Vehicle
        Whose start and goal.
    color : (float, float, float)
        Of the vehicle.
    """
    # matplotlib sorts faces and edges by depth, but marks only by zorder.
    ax.plot(
        *vehicle.start_position[:, None],
        linestyle="none",
        marker="o",
        markersize=7.0,
        markerfacecolor="none",
        markeredgewidth=0.9,
        color=color,
        zorder=52,
        gid=f"start:{vehicle.name}",
    )
    for j, visit in enumerate(vehicle.via, start=1):
        ax.plot(
            *visit.center[:, None],
            linestyle="none",
            marker="D",
            markersize=5.0,
            markerfacecolor="none",
            markeredgewidth=0.8,
            color=color,
            zorder=53,
            gid=f"visit {j}:{vehicle.name}",
        )
    ax.plot(
        *vehicle.goal.center[:, None],
        linestyle="none",
        marker="*",
        markersize=STAR_SIZE + 1.0,
        markeredgewidth=0.4,
        markeredgecolor="white",
        color=color,
        zorder=54,
        gid=f"goal:{vehicle.name}",
    )


def draw_trajectory_3d(
    ax: Axes3D,
    vehicle: Vehicle,
    trajectory: Trajectory,
    color: Color,
    dashes: Dashes = "solid",
) -> None:
    """Draw some 3σ ellipsoids as rings, the mean path, its shadow, steps and direction.

    Parameters
    ----------
    ax : Axes3D
        Axes to draw on.
    vehicle : Vehicle
        The vehicle.
    trajectory : Trajectory
        Its part of the plan.
    color : (float, float, float)
        Of the vehicle.
    dashes : str or tuple
        Line style of the vehicle.
    """
    name, path = vehicle.name, mean_path(vehicle, trajectory)
    all_rings = ellipsoid_rings(vehicle, trajectory)
    last = len(all_rings) // 3 - 1
    rings = [ring for k in (*numbered_steps(last), last) for ring in all_rings[3 * k : 3 * k + 3]]
    ax.add_collection3d(
        Line3DCollection(rings, colors=[(*color, 0.4)], linewidths=0.35, gid=f"ellipses:{name}")
    )
    floor = np.column_stack([path[:, :2], np.full(len(path), ax.get_zlim()[0])])
    ax.plot(*floor.T, color=color, alpha=0.35, linewidth=0.7, gid=f"shadow:{name}")
    ax.plot(*path.T, color=color, linewidth=1.1, linestyle=dashes, zorder=50, gid=f"path:{name}")
    steps = positions(vehicle, trajectory)[1:]
    ax.plot(
        *steps.T, linestyle="none", marker=".", markersize=3.0, color=color, zorder=51,
        gid=f"steps:{name}",
    )  # fmt: skip
    found = point_along(path, 0.5)
    if found is not None:
        point, direction = found
        length = 0.05 * float(np.ptp(path, axis=0).max())
        ax.quiver(
            *(point - 0.5 * length * direction), *(length * direction),
            color=color, linewidth=1.1, arrow_length_ratio=0.9, gid=f"arrow:{name}",
        )  # fmt: skip


def number_steps_3d(
    vehicle: Vehicle, trajectory: Trajectory, color: Color, board: SpaceBoard
) -> None:
    """Write the numbers of some steps beside their dots, as in the plane.

    Parameters
    ----------
    vehicle : Vehicle
        Whose steps.
    trajectory : Trajectory
        Its part of the plan.
    color : (float, float, float)
        Of the numbers.
    board : SpaceBoard
        Where other texts stand.
    """
    if stays(vehicle, trajectory):
        return
    places = positions(vehicle, trajectory)
    for k in numbered_steps(len(places) - 1):
        gid = f"step:{vehicle.name}:{k}"
        board.beside(str(k), places[k], color, size=NUMBER_SIZE, gid=gid, is_needed=False)
