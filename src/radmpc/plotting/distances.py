"""The picture of clearances over time."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib import rc_context
from matplotlib.axes import Axes

from radmpc.arguments import check_integer
from radmpc.model.given import check_plan
from radmpc.model.plan import Plan
from radmpc.plotting.canvas.figure import check_axes, numbers_of
from radmpc.plotting.canvas.headline import PLAIN, write_headline
from radmpc.plotting.canvas.style import ALERT, LABEL_SIZE, MUTED, PALETTE, TICK_SIZE
from radmpc.plotting.clearances import Clearance, closest_clearances
from radmpc.plotting.risk.ledger_looks import (
    LINE,
    draw_key,
    key_width,
    new_column,
    say_nothing,
    settle_part,
)

__all__ = ["plot_distances"]

_HEIGHT = 2.4
"""Height of the figure with a legend of two lines, as of five encounters with short names [in]."""

_LINES, _COLUMNS = 2, 3

_LEAST_LETTERS = 5
"""Letters that a name in the key has at least [-]."""

_SIGMAS = 3.0
"""Half width of the bands [standard deviations]."""

_TALL = 3.0
"""Height of the view, in multiples of what the least distances need [-]."""


@rc_context(PLAIN)
def plot_distances(plan: Plan, ax: Axes | None = None, *, most: int = 6) -> Axes:
    """Draw the distances between hulls over time, for the encounters that come closest.

    Encounters are those between two vehicles, of a vehicle and an obstacle, and ranges that are
    kept. Closest are those of the fewest standard deviations, which the key tells of each: what is
    nearer in meters may be less likely to touch.

    A line is the distance on the mean paths, the band below it three standard deviations along
    the line between the two: where a band reaches the red line, hulls touching is no rare event.
    Dots are steps; with avoidance at steps they alone count.

    Parameters
    ----------
    plan : Plan
        With trajectories; without them the axes say so.
    ax : Axes or None
        Where. None makes a figure of one column.
    most : int
        Encounters drawn at most, between 1 and 6.

    Returns
    -------
    Axes
        The axes drawn on; nothing is shown and nothing saved.

    Examples
    --------
    >>> import radmpc
    >>> from radmpc.experiments.families import paper
    >>> plan = radmpc.plan(paper(2, seed=1), "distance", rng=0).require()
    >>> radmpc.plot_distances(plan, most=2).get_ylabel()
    'distance of hulls [m]'
    """
    check_plan(plan)
    check_axes(ax, 2)
    check_integer(most, "most", 1)
    axes = new_column(_HEIGHT).add_subplot() if ax is None else ax
    with numbers_of(axes):
        settle_part(axes, "", "time [s]")
    write_headline(axes, plan.scenario.name, ": closest encounters in σ")
    if not plan.trajectories:
        return say_nothing(axes, plan)
    clearances = closest_clearances(plan, min(most, len(PALETTE)))
    labels = _labels(axes, clearances, at_steps=plan.scenario.avoidance == "steps")
    drawn = zip(clearances, PALETTE, labels, strict=False)
    for number, (clearance, color, label) in enumerate(drawn):
        _draw_clearance(axes, clearance, color, number, label)
    axes.axhline(0.0, color=ALERT, linewidth=0.8, zorder=3, gid="allowed")
    axes.annotate(
        "hulls touch", (1.0, 0.0), xycoords=("axes fraction", "data"), xytext=(-2.0, -2.0),
        textcoords="offset points", fontsize=TICK_SIZE, color=ALERT, ha="right", va="top",
    )  # fmt: skip
    if plan.scenario.avoidance == "steps" and clearances:
        axes.text(
            1.0, 1.0, "at steps (dots) only", transform=axes.transAxes, ha="right", va="bottom",
            fontsize=TICK_SIZE, color=MUTED, gid="avoidance",
        )  # fmt: skip
    _settle_view(axes, plan, [(c.distance, c.sigma) for c in clearances])
    what = "distance of hulls, left of ranges" if plan.scenario.keep else "distance of hulls"
    axes.set_ylabel(f"{what} [m]", fontsize=LABEL_SIZE, labelpad=1.0)
    axes.grid(axis="y", color="#E4E4E4", linewidth=0.4, zorder=0)
    if clearances:
        axes.fill_between(
            [], [], [], color=MUTED, alpha=0.15, linewidth=0.0, label=f"band: within {_SIGMAS:g}σ"
        )
        _draw_key(axes, is_alone=ax is None)
    else:
        axes.text(
            0.5, 0.5, "nothing near", transform=axes.transAxes, ha="center", color=MUTED,
            fontsize=LABEL_SIZE,
        )  # fmt: skip
    return axes


def _labels(ax: Axes, clearances: Sequence[Clearance], *, at_steps: bool) -> list[str]:
    """Return the key's texts; names have as many letters as fit into the width of the axes."""
    figure = ax.get_figure(root=True)
    room = np.inf if figure is None else float(ax.get_window_extent().width / figure.dpi)
    letters = max((len(name) for c in clearances for name in c.names), default=0)
    while True:
        labels = [
            f"{one.name_within(letters)}: {one.least(at_steps=at_steps):.1f}σ" for one in clearances
        ]
        if letters <= _LEAST_LETTERS or key_width(labels) <= room:
            return labels
        letters -= 1


def _draw_clearance(ax: Axes, clearance: Clearance, color: str, number: int, label: str) -> None:
    """Draw one encounter: line, dots at steps, and band."""
    times, distance = clearance.times, clearance.distance
    ax.plot(
        times, distance, color=color, linewidth=1.1, label=label, zorder=4,
        linestyle=("solid", (0, (5, 1.2)), (0, (2, 1)))[number % 3],
        gid=f"distance:{clearance.name}",
    )  # fmt: skip
    ax.plot(
        clearance.at_steps(times), clearance.at_steps(distance), linestyle="none", marker=".",
        markersize=3.6, color=color, zorder=5, gid=f"steps:{clearance.name}",
    )  # fmt: skip
    ax.fill_between(
        times, distance - _SIGMAS * clearance.sigma, distance, color=color, alpha=0.15,
        linewidth=0.0, zorder=2, gid=f"band:{clearance.name}",
    )  # fmt: skip


def _draw_key(ax: Axes, *, is_alone: bool) -> None:
    """Say which line is which; a figure of its own grows by the lines that long names take."""
    more = draw_key(ax, _COLUMNS) - _LINES
    figure = ax.get_figure(root=True)
    if is_alone and more > 0 and figure is not None:
        figure.set_figheight(_HEIGHT + LINE * more)


def _settle_view(ax: Axes, plan: Plan, bands: list[tuple[np.ndarray, np.ndarray]]) -> None:
    """Show where it is close; what is far away leaves at the top."""
    ax.set_xlim(0.0, plan.scenario.dt * plan.scenario.horizon)
    if not bands:
        ax.set_ylim(-0.25, 1.0)  # room for the name of the red line
        return
    low = min(float((distance - _SIGMAS * sigma).min()) for distance, sigma in bands)
    widest = max(float(sigma.max()) for _, sigma in bands)
    least = max(float(distance.min()) for distance, _ in bands)
    size = max(*(v.radius for v in plan.scenario.vehicles), _SIGMAS * widest, least)
    ax.set_ylim(min(low, 0.0) - 0.25 * size, _TALL * size)
