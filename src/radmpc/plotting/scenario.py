"""The picture of a question: what stands where and who goes where."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from mpl_toolkits.mplot3d import Axes3D

from radmpc.arrays import Matrix
from radmpc.model.given import check_scenario
from radmpc.model.scenario import Scenario
from radmpc.plotting.artists.flat import Color, draw_ends, draw_workspace
from radmpc.plotting.artists.obstacles import draw_obstacle
from radmpc.plotting.artists.space import (
    draw_ends_3d,
    draw_name_3d,
    draw_obstacle_3d,
    draw_workspace_3d,
)
from radmpc.plotting.canvas.extent import scenario_extent
from radmpc.plotting.canvas.figure import check_axes, new_axes, settle_axes, settle_layout
from radmpc.plotting.canvas.labels import LabelBoard
from radmpc.plotting.canvas.style import MAX_LABELS, TITLE_SIZE, vehicle_colors

__all__ = ["draw_surroundings", "name_vehicles", "plot_scenario"]


def plot_scenario(scenario: Scenario, ax: Axes | None = None) -> Axes:
    """Draw obstacles, workspace, starts and goals.

    Parameters
    ----------
    scenario : Scenario
        What to draw.
    ax : Axes or None
        Where; three-dimensional for a scenario in space. None makes a figure of one column.

    Returns
    -------
    Axes
        The axes drawn on; nothing is shown and nothing saved.
    """
    check_scenario(scenario)
    check_axes(ax, scenario.dimension)
    extent = scenario_extent(scenario)
    axes = new_axes(extent) if ax is None else ax
    settle_axes(axes, extent)
    axes.set_title(scenario.name, loc="left", fontsize=TITLE_SIZE, fontweight="bold", pad=3.0)
    settle_layout(axes)
    colors = vehicle_colors([v.name for v in scenario.vehicles], [])
    board = LabelBoard(axes)
    draw_surroundings(axes, scenario, board, colors)
    name_vehicles(axes, scenario, board, colors)
    return axes


def draw_surroundings(
    ax: Axes,
    scenario: Scenario,
    board: LabelBoard,
    colors: dict[str, Color],
    *,
    moving: bool = True,
) -> None:
    """Draw everything but trajectories and the names of vehicles; moving obstacles on request."""
    is_named = max(len(scenario.obstacles), scenario.num_vehicles) <= MAX_LABELS
    obstacles = [o for o in scenario.obstacles if moving or not o.is_moving]
    if isinstance(ax, Axes3D):
        if scenario.workspace is not None:
            draw_workspace_3d(ax, scenario.workspace)
        for obstacle in obstacles:
            draw_obstacle_3d(ax, obstacle, is_named=is_named)
        for vehicle in scenario.vehicles:
            draw_ends_3d(ax, vehicle, colors[vehicle.name])
        return
    if scenario.workspace is not None:
        draw_workspace(ax, scenario.workspace, board)
    for vehicle in scenario.vehicles:
        draw_ends(ax, vehicle, colors[vehicle.name])
        start = vehicle.start_position
        board.avoid(_ring(start, vehicle.radius), _ring(vehicle.goal.center, 0.5 * vehicle.radius))
    for obstacle in obstacles:
        draw_obstacle(ax, obstacle, board, is_named=is_named)


def name_vehicles(
    ax: Axes, scenario: Scenario, board: LabelBoard, colors: dict[str, Color]
) -> None:
    """Write every vehicle's name beside its start, unless there are too many to read."""
    if scenario.num_vehicles > MAX_LABELS:
        return
    for vehicle in scenario.vehicles:
        color = colors[vehicle.name]
        if isinstance(ax, Axes3D):
            draw_name_3d(ax, vehicle.name, vehicle.start_position, color)
        else:
            hull = np.full(2, vehicle.radius)
            board.beside(vehicle.name, vehicle.start_position, hull, color)


def _ring(center: Matrix, radius: float) -> Matrix:
    """Return points on and in a circle, for texts to stay off."""
    angles = np.linspace(0.0, 2.0 * np.pi, 12, endpoint=False)
    circle = center + radius * np.column_stack([np.cos(angles), np.sin(angles)])
    return np.vstack([circle, center])
