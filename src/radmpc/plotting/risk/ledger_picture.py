"""The picture of where Δ went: by cause and step, by vehicle, and what was left unused."""

from __future__ import annotations

import math
from typing import overload

import numpy as np
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.figure import Figure, SubFigure
from matplotlib.ticker import MaxNLocator

from radmpc.model.given import check_plan
from radmpc.model.ledger import bound_texts
from radmpc.model.plan import Plan
from radmpc.plotting.canvas.figure import check_axes, check_figure
from radmpc.plotting.canvas.headline import PLAIN, figure_headline
from radmpc.plotting.canvas.style import ALERT, LABEL_SIZE, MUTED, TICK_SIZE, TITLE_SIZE
from radmpc.plotting.risk.ledger_looks import (
    ROW,
    has_layout,
    new_column,
    percent,
    say_nothing,
    settle_part,
    write_beside,
)
from radmpc.plotting.risk.ledger_rows import map_rows
from radmpc.plotting.risk.ledger_shares import plot_risk_shares, shares_height

__all__ = ["plot_ledger", "plot_risk_map"]

_DECADES = 8
"""Powers of ten that the map's colors span; risks below are left blank."""

_MAP_FRAME = 0.80
"""Height of heading, ticks, labels and color bar of the map [in]."""

_BAR_GAP = 0.04
"""Space between the map's label and the color bar [in]."""

_HEADLINES = 0.32
"""Height of name and certificate [in]."""

_LINE = 0.14
"""Height of a line of the headlines [in]."""


@overload
def plot_ledger(plan: Plan, figure: None = None) -> Figure: ...
@overload
def plot_ledger(plan: Plan, figure: Figure | SubFigure) -> Figure | SubFigure: ...
@rc_context(PLAIN)
def plot_ledger(plan: Plan, figure: Figure | SubFigure | None = None) -> Figure | SubFigure:
    """Draw the risk ledger: by cause and step above, shares of Δ by vehicle below.

    Parameters
    ----------
    plan : Plan
        With a certificate; without one the figure says so.
    figure : Figure, SubFigure or None
        Where, beside whatever it holds already. None makes a figure of one column.

    Returns
    -------
    Figure or SubFigure
        With two axes and a color bar; nothing is shown and nothing saved.

    Examples
    --------
    >>> import radmpc
    >>> from radmpc.experiments.families import paper
    >>> plan = radmpc.plan(paper(2, seed=1), "distance", rng=0).require()
    >>> len(radmpc.plot_ledger(plan).axes)
    3
    """
    check_plan(plan)
    check_figure(figure)
    heights = [_map_height(plan), shares_height(plan)]
    if figure is None:
        figure = new_column(sum(heights) + _HEADLINES)
    upper, lower = figure.subplots(2, 1, height_ratios=heights)
    _write_headlines(figure, plan)
    plot_risk_map(plan, upper)
    plot_risk_shares(plan, lower)
    return figure


@rc_context(PLAIN)
def plot_risk_map(plan: Plan, ax: Axes | None = None) -> Axes:
    """Draw the risk by cause and step as a map of powers of ten.

    The share of Δ stands beside each row: the largest 20 causes, the others in one row.

    Parameters
    ----------
    plan : Plan
        With a certificate; without one the axes say so.
    ax : Axes or None
        Where. None makes a figure of one column.

    Returns
    -------
    Axes
        The axes drawn on; the color bar is below them, in the same figure.
    """
    check_plan(plan)
    check_axes(ax, 2)
    axes = new_column(_map_height(plan)).add_subplot() if ax is None else ax
    names, risks = map_rows(plan, _DECADES)
    settle_part(axes, "by cause and step", "step [-]")
    if not names:
        return say_nothing(axes, plan)
    with np.errstate(divide="ignore"):  # blank where there is no risk
        powers = np.log10(risks)
    top = math.ceil(float(powers.max()))
    mesh = axes.pcolormesh(
        np.arange(risks.shape[1] + 1) - 0.5,
        np.arange(len(names) + 1) - 0.5,
        np.ma.masked_less(powers, top - _DECADES),
        cmap="cividis_r",  # lightness alone tells its order, in gray and to the color-blind
        vmin=top - _DECADES,
        vmax=top,
        edgecolors="white",
        linewidth=0.4,
        gid="risk-map",
    )
    axes.set_xlim(-0.5, risks.shape[1] - 0.5)
    axes.hlines(
        np.arange(len(names)) + 0.5, -0.5, risks.shape[1] - 0.5, colors="#E4E4E4", linewidths=0.4
    )
    axes.set_ylim(len(names) - 0.5, -0.5)
    axes.set_yticks(range(len(names)), names)
    axes.xaxis.set_major_locator(MaxNLocator(integer=True))
    for row, total in enumerate(risks.sum(axis=1)):
        write_beside(axes, row, percent(float(total) / plan.risk.bound), f"share:{names[row]}")
    axes.annotate(
        "of Δ", (1.0, 1.0), xycoords="axes fraction", xytext=(3.0, 3.0), color=MUTED,
        textcoords="offset points", fontsize=TICK_SIZE, annotation_clip=False, gid="share",
    )  # fmt: skip
    _add_color_bar(axes, mesh, len(names))
    return axes


def _map_height(plan: Plan) -> float:
    """Return the height that the map asks for [in]."""
    return _MAP_FRAME + ROW * max(2, len(map_rows(plan, _DECADES)[0]))


def _write_headlines(figure: Figure | SubFigure, plan: Plan) -> None:
    """Write the scenario's name and its certificate against Δ, in red if that is above."""
    # The empty line makes room for the smaller one, which no layout engine would see.
    headline = figure.suptitle(
        figure_headline(figure, plan.scenario.name) + "\n",
        x=0.02,
        ha="left",
        fontsize=TITLE_SIZE,
        fontweight="bold",
    )
    certified, bound = plan.risk.certified, plan.risk.bound
    if certified is None:
        text, color = "no certificate", MUTED
    else:
        risk, limit = bound_texts(certified, bound)
        text, color = f"risk at most {risk}, within Δ = {limit}", MUTED
        if certified > bound:
            text, color = f"risk at most {risk}: ABOVE Δ = {limit}", ALERT
    figure.text(
        0.02,
        headline.get_position()[1] - _LINE * figure.dpi / figure.bbox.height,
        text,
        fontsize=LABEL_SIZE,
        color=color,
        va="top",
        gid="certificate",
    )


def _add_color_bar(ax: Axes, mesh: ScalarMappable, num_rows: int) -> None:
    """Say below the map, of so many rows, what its colors mean."""
    figure = ax.get_figure(root=True)
    if figure is None:
        return
    # Where nothing makes room for ticks and label between the two, the bar keeps away itself.
    pad = _BAR_GAP / (ROW * max(2, num_rows)) if has_layout(ax) else 0.22
    bar = figure.colorbar(mesh, ax=ax, location="bottom", aspect=40, pad=pad, shrink=0.9)
    bar.set_label("log₁₀ of the risk per step [-]; blank: less", fontsize=LABEL_SIZE, labelpad=1.0)
    bar.ax.tick_params(labelsize=TICK_SIZE, length=2.0, width=0.5, pad=1.5)
    bar.locator = MaxNLocator(integer=True)
    bar.outline.set_linewidth(0.5)
    bar.update_ticks()
