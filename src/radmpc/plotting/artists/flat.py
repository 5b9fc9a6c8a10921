"""The artists of a plane picture."""

from __future__ import annotations

import numpy as np
import shapely
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.patches import Circle, Rectangle

from radmpc.arrays import Vector
from radmpc.model.plan import Trajectory
from radmpc.model.scenario import Workspace
from radmpc.model.vehicle import Vehicle
from radmpc.plotting.artists.arrows import draw_arrows
from radmpc.plotting.artists.obstacles import along_lines, patch_of
from radmpc.plotting.canvas.labels import LabelBoard
from radmpc.plotting.canvas.style import MUTED, NUMBER_SIZE, STAR_SIZE, Dashes, numbered_steps
from radmpc.plotting.curves import (
    ABOVE,
    Plane,
    confidence_ellipses,
    mean_path,
    positions,
)

__all__ = [
    "VISIT_DASHES",
    "Color",
    "draw_ends",
    "draw_trajectory",
    "draw_workspace",
    "number_steps",
    "number_visits",
]

Color = tuple[float, float, float]

VISIT_DASHES = (0, (2, 1.2))
"""Line style of boxes that are visited."""


def draw_workspace(ax: Axes, workspace: Workspace, board: LabelBoard, plane: Plane = ABOVE) -> None:
    """Draw the outline of the workspace.

    Parameters
    ----------
    ax : Axes
        Axes to draw on.
    workspace : Workspace
        The box to draw.
    board : LabelBoard
        Where texts stand.
    plane : (int, int)
        The two coordinates that are drawn.
    """
    low, high = workspace.lower[list(plane)], workspace.upper[list(plane)]
    width, height = high - low
    ax.add_patch(
        Rectangle(
            (float(low[0]), float(low[1])),
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
    corners = np.array([low, (high[0], low[1]), high, (low[0], high[1]), low])
    board.avoid(along_lines(corners, 60))


def draw_ends(ax: Axes, vehicle: Vehicle, color: Color, plane: Plane = ABOVE) -> None:
    """Draw the hull at the start as an open circle, visits as boxes, the goal as one with a star.

    Parameters
    ----------
    ax : Axes
        Axes to draw on.
    vehicle : Vehicle
        Whose start and goal.
    color : (float, float, float)
        Of the vehicle.
    plane : (int, int)
        The two coordinates that are drawn.
    """
    seen = list(plane)
    x, y = vehicle.start_position[seen]
    ax.add_patch(
        Circle(
            (float(x), float(y)),
            vehicle.radius,
            facecolor="none",
            edgecolor=color,
            linewidth=0.9,
            zorder=4,
            gid=f"start:{vehicle.name}",
        )
    )
    lower, size = vehicle.goal.lower[seen], (vehicle.goal.upper - vehicle.goal.lower)[seen]
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
    for j, visit in enumerate(vehicle.via, start=1):
        _draw_visit(ax, visit.lower[seen], visit.upper[seen], color, f"visit {j}:{vehicle.name}")
    ax.plot(
        *vehicle.goal.center[seen, None],
        marker="*",
        markersize=STAR_SIZE,
        markeredgewidth=0.4,
        markeredgecolor="white",
        color=color,
        zorder=8,
        gid=f"star:{vehicle.name}",
    )


def _draw_visit(ax: Axes, lower: Vector, upper: Vector, color: Color, name: str) -> None:
    """Draw a box that is visited."""
    width, height = (upper - lower).tolist()
    ax.add_patch(
        Rectangle(
            (float(lower[0]), float(lower[1])),
            width,
            height,
            facecolor="none",
            edgecolor=color,
            linewidth=0.8,
            linestyle=VISIT_DASHES,
            zorder=6,
            gid=name,
        )
    )


def number_visits(vehicle: Vehicle, color: Color, board: LabelBoard, plane: Plane = ABOVE) -> None:
    """Write the places of visits in their order beside their boxes, framed unlike steps' numbers.

    Parameters
    ----------
    vehicle : Vehicle
        Whose visits.
    color : (float, float, float)
        Of the numbers.
    board : LabelBoard
        Where other texts stand.
    plane : (int, int)
        The two coordinates that are drawn.
    """
    seen = list(plane)
    for j, visit in enumerate(vehicle.via, start=1):
        half = 0.5 * (visit.upper - visit.lower)[seen]
        board.beside(
            str(j), visit.center[seen], half, color, size=NUMBER_SIZE,
            gid=f"visit-number:{vehicle.name}:{j}", is_framed=True,
        )  # fmt: skip


def draw_trajectory(
    ax: Axes,
    vehicle: Vehicle,
    trajectory: Trajectory,
    color: Color,
    dashes: Dashes = "solid",
    plane: Plane = ABOVE,
) -> None:
    """Draw the swept hull, the 3σ ellipses, the mean path, its steps and its direction.

    Parameters
    ----------
    ax : Axes
        Axes to draw on.
    vehicle : Vehicle
        The vehicle.
    trajectory : Trajectory
        Its part of the plan.
    color : (float, float, float)
        Of the vehicle.
    dashes : str or tuple
        Line style of the vehicle.
    plane : (int, int)
        The two coordinates that are drawn.
    """
    name, path = vehicle.name, mean_path(vehicle, trajectory)[:, list(plane)]
    # One that comes back to where it was leaves what lies within free.
    swept = patch_of(shapely.LineString(path).buffer(vehicle.radius))
    swept.set(facecolor=(*color, 0.10), edgecolor="none", zorder=2.5, gid=f"hull:{name}")
    ax.add_patch(swept)
    ax.add_collection(
        PolyCollection(
            confidence_ellipses(vehicle, trajectory, plane=plane),
            facecolors=[(*color, 0.20)],
            edgecolors=[(*color, 0.45)],
            linewidths=0.35,
            zorder=3,
            gid=f"ellipses:{name}",
        ),
        autolim=False,
    )
    ax.plot(*path.T, color=color, linewidth=1.1, linestyle=dashes, zorder=5, gid=f"path:{name}")
    steps = positions(vehicle, trajectory)[:, list(plane)]
    ax.plot(
        *steps[1:].T, linestyle="none", marker=".", markersize=3.2, color=color, zorder=5.5,
        gid=f"steps:{name}",
    )  # fmt: skip
    draw_arrows(ax, path, steps, color, name)


def number_steps(
    vehicle: Vehicle,
    trajectory: Trajectory,
    color: Color,
    board: LabelBoard,
    plane: Plane = ABOVE,
) -> None:
    """Write the numbers of some steps beside their dots, where they lie on no other text.

    Those of a vehicle that stays are left out, too.

    Parameters
    ----------
    vehicle : Vehicle
        Whose steps.
    trajectory : Trajectory
        Its part of the plan.
    color : (float, float, float)
        Of the numbers.
    board : LabelBoard
        Where other texts stand.
    plane : (int, int)
        The two coordinates that are drawn.
    """
    places = positions(vehicle, trajectory)[:, list(plane)]
    if np.ptp(places, axis=0).max() <= vehicle.radius:
        return
    for k in numbered_steps(len(places) - 1):
        board.beside(
            str(k),
            places[k],
            np.zeros(2),
            color,
            size=NUMBER_SIZE,
            gid=f"step:{vehicle.name}:{k}",
            is_needed=False,
        )
