"""The picture of an answer."""

from __future__ import annotations

from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.transforms import ScaledTranslation
from mpl_toolkits.mplot3d import Axes3D

from radmpc.model.plan import Plan
from radmpc.plotting.curves import confidence_ellipses, mean_path
from radmpc.plotting.extent import plan_extent
from radmpc.plotting.figure import new_axes, settle_axes, settle_layout
from radmpc.plotting.flat import draw_trajectory
from radmpc.plotting.labels import LabelBoard
from radmpc.plotting.scenario import draw_surroundings, name_vehicles
from radmpc.plotting.space import draw_trajectory_3d
from radmpc.plotting.style import MUTED, TICK_SIZE, vehicle_colors
from radmpc.plotting.title import draw_title, num_title_lines

__all__ = ["plot_plan"]

_LEGEND_DROP = 0.27  # from the axes' lower edge, past ticks and label [in]


def plot_plan(plan: Plan, ax: Axes | None = None) -> Axes:
    """Draw a plan in its scenario: mean paths, 3σ ellipses, hulls, one hue per set.

    Parameters
    ----------
    plan : Plan
        What to draw; without trajectories the scenario alone, and a note.
    ax : Axes or None
        Where; three-dimensional for a scenario in space. None makes a figure of one column.

    Returns
    -------
    Axes
        The axes drawn on; nothing is shown and nothing saved.
    """
    scenario = plan.scenario
    extent = plan_extent(plan)
    axes = new_axes(extent, num_title_lines(plan) + 1) if ax is None else ax
    settle_axes(axes, extent)
    draw_title(axes, plan)
    if ax is None:
        _draw_legend(axes)
    settle_layout(axes)
    colors = vehicle_colors([v.name for v in scenario.vehicles], plan.sets)
    board = LabelBoard(axes)
    for vehicle, trajectory in zip(scenario.vehicles, plan.trajectories, strict=False):
        color = colors[vehicle.name]
        if isinstance(axes, Axes3D):
            draw_trajectory_3d(axes, vehicle, trajectory, scenario.dt, color)
        else:
            draw_trajectory(axes, vehicle, trajectory, scenario.dt, color)
            board.avoid(mean_path(vehicle, trajectory, scenario.dt)[::2])
            board.avoid(*(outline[::4] for outline in confidence_ellipses(vehicle, trajectory)))
    draw_surroundings(axes, scenario, board, colors)
    name_vehicles(axes, scenario, board, colors)
    return axes


def _draw_legend(ax: Axes) -> None:
    """Say below the axes what the signs mean."""
    figure = ax.get_figure(root=True)
    if figure is None:
        return
    start = Line2D([], [], color=MUTED, linestyle="none", marker="o", markersize=5)
    start.set_markerfacecolor("white")
    entries = {
        "start": start,
        "mean path, steps": Line2D([], [], color=MUTED, linewidth=1.1, marker=".", markersize=4),
        "3σ": Patch(facecolor="#55555533", edgecolor="#55555573", linewidth=0.35),
        "swept hull": Patch(facecolor="#5555551A"),
        "goal": Line2D([], [], color=MUTED, linestyle="none", marker="*", markersize=6),
    }
    is_flat = not isinstance(ax, Axes3D)
    if not is_flat:
        del entries["swept hull"]
    below = ScaledTranslation(0.0, -_LEGEND_DROP if is_flat else 0.0, figure.dpi_scale_trans)
    ax.legend(
        list(entries.values()),
        list(entries),
        loc="upper center",
        bbox_to_anchor=(0.5, 0.0),
        bbox_transform=ax.transAxes + below,
        ncols=len(entries),
        fontsize=TICK_SIZE,
        frameon=False,
        handlelength=1.4,
        handletextpad=0.4,
        columnspacing=1.0,
        borderaxespad=0.0,
        borderpad=0.1,
    )
