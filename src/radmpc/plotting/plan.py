"""The picture of an answer."""

from __future__ import annotations

from types import NoneType

from matplotlib.axes import Axes
from mpl_toolkits.mplot3d import Axes3D

from radmpc.arguments import check_kind
from radmpc.model.given import check_plan
from radmpc.model.plan import Plan
from radmpc.plotting.artists.flat import Color, draw_trajectory, number_steps
from radmpc.plotting.artists.highlights import draw_worst
from radmpc.plotting.artists.legend import draw_legend, num_legend_lines
from radmpc.plotting.artists.space import draw_trajectory_3d, number_steps_3d
from radmpc.plotting.canvas.extent import plan_extent
from radmpc.plotting.canvas.figure import check_axes, new_axes, settle_axes, settle_layout
from radmpc.plotting.canvas.labels import LabelBoard
from radmpc.plotting.canvas.style import MAX_LABELS, vehicle_colors, vehicle_dashes
from radmpc.plotting.canvas.title import draw_title, num_title_lines
from radmpc.plotting.curves import confidence_ellipses, mean_path
from radmpc.plotting.scenario import draw_surroundings, name_vehicles

__all__ = ["plot_plan"]


def plot_plan(
    plan: Plan, ax: Axes | None = None, *, details: bool = True, title: str | None = None
) -> Axes:
    """Draw a plan in its scenario: mean paths, 3σ ellipses, hulls, one hue per set.

    Some steps have their numbers: paths that cross at other times do not meet. Where the
    certificate exceeds the bound, red rings show the steps that risk the most.

    Parameters
    ----------
    plan : Plan
        What to draw; without trajectories the scenario alone, and why.
    ax : Axes or None
        Where; three-dimensional for a scenario in space. None makes a figure of one column.
    details : bool
        Whether run time and planner are told.
    title : str or None
        Headline; None is the scenario's name.

    Returns
    -------
    Axes
        The axes drawn on; nothing is shown and nothing saved.
    """
    check_plan(plan)
    check_axes(ax, plan.scenario.dimension)
    check_kind(title, (str, NoneType), "title", "text or None")
    extent = plan_extent(plan)
    lines = num_title_lines(plan, details=details) + num_legend_lines(plan)
    axes = new_axes(extent, lines) if ax is None else ax
    settle_axes(axes, extent)
    draw_title(axes, plan, details=details, headline=title)
    if ax is None:
        draw_legend(axes, plan)
    settle_layout(axes)
    scenario, names = plan.scenario, [v.name for v in plan.scenario.vehicles]
    colors = vehicle_colors(names, plan.sets)
    board = LabelBoard(axes)
    _draw_trajectories(axes, plan, board, colors)
    draw_surroundings(axes, scenario, board, colors)
    name_vehicles(axes, scenario, board, colors)
    _number_steps(axes, plan, board, colors)
    draw_worst(axes, plan)
    return axes


def _draw_trajectories(ax: Axes, plan: Plan, board: LabelBoard, colors: dict[str, Color]) -> None:
    """Draw where all vehicles go."""
    scenario = plan.scenario
    dashes = vehicle_dashes(list(colors), plan.sets)
    for vehicle, trajectory in zip(scenario.vehicles, plan.trajectories, strict=False):
        look = colors[vehicle.name], dashes[vehicle.name]
        if isinstance(ax, Axes3D):
            draw_trajectory_3d(ax, vehicle, trajectory, scenario.dt, *look)
        else:
            draw_trajectory(ax, vehicle, trajectory, scenario.dt, *look)
            board.avoid(mean_path(vehicle, trajectory)[::2])
            board.avoid(*(outline[::4] for outline in confidence_ellipses(vehicle, trajectory)))


def _number_steps(ax: Axes, plan: Plan, board: LabelBoard, colors: dict[str, Color]) -> None:
    """Write step numbers on the paths, unless there are too many to read."""
    if plan.scenario.num_vehicles > MAX_LABELS:
        return
    for vehicle, trajectory in zip(plan.scenario.vehicles, plan.trajectories, strict=False):
        color = colors[vehicle.name]
        if isinstance(ax, Axes3D):
            number_steps_3d(ax, vehicle, trajectory, color)
        else:
            number_steps(vehicle, trajectory, color, board)
