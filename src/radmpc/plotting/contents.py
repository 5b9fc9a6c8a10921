"""All of a plan within axes whose limits and size are final, flat or in space."""

from __future__ import annotations

from matplotlib.axes import Axes

from radmpc.model.plan import Plan
from radmpc.plotting.artists.flat import Color, draw_trajectory, number_steps
from radmpc.plotting.artists.ghosts import draw_ghosts
from radmpc.plotting.artists.highlights import draw_worst
from radmpc.plotting.artists.relations import draw_ranges
from radmpc.plotting.artists.space import draw_trajectory_3d, number_steps_3d
from radmpc.plotting.canvas.space_labels import Board, SpaceBoard, board_of, show_all
from radmpc.plotting.canvas.style import vehicle_colors, vehicle_dashes
from radmpc.plotting.curves import ABOVE, Plane, confidence_ellipses, mean_path
from radmpc.plotting.scenario import draw_surroundings, most_named, name_obstacles, name_vehicles

__all__ = ["draw_contents"]

_SWEEP = 0.4
"""Opacity of moving obstacles beside their ghosts, as a share of the usual [-]."""


def draw_contents(ax: Axes, plan: Plan, plane: Plane = ABOVE) -> None:
    """Draw surroundings, trajectories, ghosts of moving obstacles, names and the worst steps.

    Parameters
    ----------
    ax : Axes
        With limits and size.
    plan : Plan
        What to draw.
    plane : (int, int)
        Which coordinates flat axes show.
    """
    scenario, names = plan.scenario, [v.name for v in plan.scenario.vehicles]
    colors = vehicle_colors(names, plan.sets)
    board = board_of(ax)
    _draw_trajectories(ax, plan, board, colors, plane)
    strength = _SWEEP if plan.trajectories else 1.0
    draw_surroundings(ax, scenario, board, colors, strength=strength, plane=plane)
    most = most_named(scenario, board)
    name_vehicles(scenario, board, colors, plane, most=most)
    name_obstacles(scenario, board, plane, most=most)
    draw_ranges(ax, plan, board, plane, is_named=scenario.num_vehicles <= most)
    draw_ghosts(ax, plan, board, colors, plane)
    _number_steps(plan, board, colors, plane)
    draw_worst(ax, plan, plane)
    show_all(ax)


def _draw_trajectories(
    ax: Axes, plan: Plan, board: Board, colors: dict[str, Color], plane: Plane
) -> None:
    """Draw where all vehicles go."""
    scenario = plan.scenario
    dashes = vehicle_dashes(list(colors), plan.sets)
    for vehicle, trajectory in zip(scenario.vehicles, plan.trajectories, strict=False):
        look = colors[vehicle.name], dashes[vehicle.name]
        path = mean_path(vehicle, trajectory)
        if isinstance(board, SpaceBoard):
            draw_trajectory_3d(ax, vehicle, trajectory, *look)
            board.avoid(path[::2])
            continue
        draw_trajectory(ax, vehicle, trajectory, *look, plane)
        board.avoid(path[::2, list(plane)])
        ellipses = confidence_ellipses(vehicle, trajectory, plane=plane)
        board.avoid(*(outline[::4] for outline in ellipses))


def _number_steps(plan: Plan, board: Board, colors: dict[str, Color], plane: Plane) -> None:
    """Write step numbers on the paths, unless there are too many to read."""
    if plan.scenario.num_vehicles > most_named(plan.scenario, board):
        return
    for vehicle, trajectory in zip(plan.scenario.vehicles, plan.trajectories, strict=False):
        color = colors[vehicle.name]
        if isinstance(board, SpaceBoard):
            number_steps_3d(vehicle, trajectory, color, board)
        else:
            number_steps(vehicle, trajectory, color, board, plane)
