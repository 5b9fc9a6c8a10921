"""The legend below a plan's picture: the signs as they are drawn."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure, SubFigure
from matplotlib.layout_engine import ConstrainedLayoutEngine
from matplotlib.legend_handler import HandlerTuple
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.transforms import ScaledTranslation
from mpl_toolkits.mplot3d import Axes3D

from radmpc.model.plan import Plan
from radmpc.model.scenario import Scenario
from radmpc.plotting.artists.flat import VISIT_DASHES
from radmpc.plotting.artists.ghosts import nearest_ghosts
from radmpc.plotting.artists.highlights import worst_rows
from radmpc.plotting.artists.relations import FOR_SOME, RANGE_DASHES
from radmpc.plotting.artists.straying import SPREAD_DASHES
from radmpc.plotting.canvas.columns import columns_within, lines_within
from radmpc.plotting.canvas.style import (
    ALERT,
    COLUMN_WIDTH,
    MAX_LABELS,
    MUTED,
    OBSTACLE_EDGE,
    OBSTACLE_FILL,
    STAR_SIZE,
    TICK_SIZE,
    Dashes,
    numbered_steps,
    vehicle_dashes,
)
from radmpc.plotting.curves import stays

__all__ = [
    "draw_film_legend",
    "draw_legend",
    "draw_views_legend",
    "num_film_legend_lines",
    "num_legend_lines",
    "num_views_legend_lines",
]

_DROP = 0.27
"""Distance of the legend from the axes' lower edge, past ticks and label [in]."""

_BESIDE = 0.5
"""Width of ticks, label and margins beside axes, which a legend below them leaves free [in]."""

_MARGINS = 0.1
"""Width that a legend below several panels leaves free [in]."""

_LOOKS: dict[str, Any] = {
    "handler_map": {tuple: HandlerTuple(ndivide=1)},
    "frameon": False,
    "handlelength": 1.4,
    "handletextpad": 0.4,
    "columnspacing": 1.0,
    "borderaxespad": 0.0,
    "borderpad": 0.1,
}

Handle = Artist | tuple[Artist, ...]


def num_legend_lines(plan: Plan) -> int:
    """Return how many lines the legend of a plan in a figure of its own, of one column, takes."""
    return lines_within(_entries(plan), COLUMN_WIDTH - _BESIDE, _LOOKS)


def num_views_legend_lines(plan: Plan, width: float) -> int:
    """Return how many lines the legend below three panels takes.

    Parameters
    ----------
    plan : Plan
        What is drawn.
    width : float
        Of the figure [in].
    """
    return lines_within(_entries(plan, is_flat=True), width - _MARGINS, _LOOKS)


def num_film_legend_lines(plan: Plan) -> int:
    """Return how many lines the legend of a film in a figure of its own, of one column, takes."""
    return lines_within(_film_entries(plan), COLUMN_WIDTH - _BESIDE, _LOOKS)


def draw_legend(ax: Axes, plan: Plan) -> None:
    """Say below the axes what the signs mean that are drawn.

    Parameters
    ----------
    ax : Axes
        Below which.
    plan : Plan
        What is drawn.
    """
    _place(ax, _entries(plan))


def draw_views_legend(figure: Figure | SubFigure, plan: Plan) -> None:
    """Say below all panels what the signs mean that are drawn.

    Parameters
    ----------
    figure : Figure or SubFigure
        Below whose panels.
    plan : Plan
        What is drawn.
    """
    entries = _entries(plan, is_flat=True)
    root = figure.get_figure(root=True)
    is_laid_out = root is not None and isinstance(root.get_layout_engine(), ConstrainedLayoutEngine)
    handles: list[Any] = list(entries.values())
    columns = columns_within(entries, _width(figure) - _MARGINS, _LOOKS)
    figure.legend(
        handles, list(entries), ncols=columns, fontsize=TICK_SIZE,
        loc="outside lower center" if is_laid_out else "lower center", **_LOOKS,
    )  # fmt: skip


def draw_film_legend(ax: Axes, plan: Plan) -> None:
    """Say below the axes what the signs of a film mean.

    Parameters
    ----------
    ax : Axes
        Below which.
    plan : Plan
        What is drawn.
    """
    _place(ax, _film_entries(plan))


def _film_entries(plan: Plan) -> dict[str, Handle]:
    """Return the handles of a film's legend by what they mean."""
    entries: dict[str, Handle] = {"start": _sign("o", 5.5, "none", MUTED, 0.9)}
    if plan.trajectories:
        is_flat = plan.scenario.dimension == 2
        size = 8.0 if is_flat else 5.0
        entries["hull" if is_flat else "center"] = _sign("o", size, "#55555566", MUTED, 0.6)
        entries["3σ"] = _sign("o", 5.0, "#555555B0" if is_flat else "none", MUTED, 0.4)
        entries["temporal obstacle"] = Patch(
            facecolor="#55555512", edgecolor="#55555599" if is_flat else "none", linewidth=0.5,
            linestyle=(0, (3, 1.5)),
        )  # fmt: skip
    entries["goal"] = _sign("*", STAR_SIZE, MUTED, "white", 0.4)
    flat = plan.scenario.dimension == 2
    entries |= _surroundings(plan.scenario, is_flat=flat)
    return entries | _relations(plan.scenario, "range", is_flat=flat)


def _width(figure: Figure | SubFigure) -> float:
    """Return the width of a figure or of a part of one [in]."""
    return float(figure.bbox.width / figure.dpi)


def _place(ax: Axes, entries: dict[str, Handle]) -> None:
    """Put a legend below the axes' labels."""
    figure = ax.get_figure(root=True)
    if figure is None:
        return
    drop = 0.0 if isinstance(ax, Axes3D) else -_DROP
    below = ScaledTranslation(0.0, drop, figure.dpi_scale_trans)
    ax.legend(
        list(entries.values()),
        list(entries),
        loc="upper center",
        bbox_to_anchor=(0.5, 0.0),
        bbox_transform=ax.transAxes + below,
        ncols=columns_within(entries, _width(figure) - _BESIDE, _LOOKS),
        fontsize=TICK_SIZE,
        **_LOOKS,
    )


def _entries(plan: Plan, *, is_flat: bool | None = None) -> dict[str, Handle]:
    """Return the legend's handles by what they mean; None is whether the scenario is flat."""
    is_flat = plan.scenario.dimension == 2 if is_flat is None else is_flat
    entries: dict[str, Handle] = {"start": _sign("o", 5.5, "none", MUTED, 0.9)}
    if plan.trajectories:
        line = Line2D([], [], color=MUTED, linewidth=1.1, marker=".", markersize=4)
        entries["mean path, step no." if _are_steps_numbered(plan) else "mean path"] = line
        if any(dashes != "solid" for dashes in _dashes(plan)):
            dashed = Line2D([], [], color=MUTED, linewidth=1.1, linestyle=(0, (5, 1.2)))
            entries["same set (first solid)"] = dashed
        if is_flat:
            entries["3σ"] = _sign("o", 7.0, "#55555533", "#55555573", 0.35)
            entries["swept hull"] = Patch(facecolor="#5555551A")
        else:
            entries["3σ"] = _sign("o", 7.0, "none", "#55555580", 0.4)
    star = _sign("*", STAR_SIZE, MUTED, "white", 0.4)
    entries["goal"] = (_sign("s", 6.0, "#55555540", MUTED, 0.7), star) if is_flat else star
    entries |= _surroundings(plan.scenario, is_flat=is_flat)
    name = "range, widest" if plan.trajectories else "range"
    entries |= _relations(plan.scenario, name, is_flat=is_flat)
    if nearest_ghosts(plan):
        entries["when nearest"] = (
            _sign("s", 7.5, OBSTACLE_FILL, MUTED, 0.9),
            _sign("o", 4.0, "#55555540", MUTED, 0.9),
        )
    if worst_rows(plan):
        entries["most risk"] = _sign("o", 6.5, "none", ALERT, 1.0)
    return entries


def _surroundings(scenario: Scenario, *, is_flat: bool) -> dict[str, Handle]:
    """Return the signs of places of obstacles that are uncertain, and of visits."""
    entries: dict[str, Handle] = {}
    if any(obstacle.spread is not None for obstacle in scenario.obstacles):
        entries["obstacle's 3σ"] = Line2D(
            [], [], color=MUTED, linewidth=0.6, linestyle=SPREAD_DASHES
        )
    if any(vehicle.via for vehicle in scenario.vehicles):
        if is_flat:
            entries["visit, no. ①"] = Patch(
                facecolor="none", edgecolor=MUTED, linewidth=0.8, linestyle=VISIT_DASHES
            )
        else:
            entries["visit"] = _sign("D", 5.0, "none", MUTED, 0.8)
    return entries


def _relations(scenario: Scenario, name: str, *, is_flat: bool) -> dict[str, Handle]:
    """Return the signs of obstacles for some vehicles only, and of ranges under a name."""
    entries: dict[str, Handle] = {}
    if any(obstacle.concerns is not None for obstacle in scenario.obstacles):
        looks = FOR_SOME if is_flat else {"facecolor": OBSTACLE_FILL, "alpha": 0.4}
        entries["for some only"] = Patch(edgecolor=OBSTACLE_EDGE, linewidth=0.5, **looks)
    if scenario.keep:
        entries[name] = Line2D([], [], color=MUTED, linewidth=0.8, linestyle=RANGE_DASHES)
    return entries


def _are_steps_numbered(plan: Plan) -> bool:
    """Whether a panel may have numbers of steps: not of who stays, nor in large fleets."""
    if plan.scenario.num_vehicles > MAX_LABELS or not numbered_steps(plan.scenario.horizon):
        return False
    flown = zip(plan.scenario.vehicles, plan.trajectories, strict=True)
    return not all(stays(*one) for one in flown)


def _dashes(plan: Plan) -> Iterable[Dashes]:
    """Return the line styles of a plan's paths."""
    return vehicle_dashes([vehicle.name for vehicle in plan.scenario.vehicles], plan.sets).values()


def _sign(marker: str, size: float, face: str, edge: str, width: float) -> Line2D:
    """Return a marker alone."""
    return Line2D(
        [], [], linestyle="none", marker=marker, markersize=size, markerfacecolor=face,
        markeredgecolor=edge, markeredgewidth=width,
    )  # fmt: skip
