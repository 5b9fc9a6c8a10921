"""Medians with their spread over a number, one line per method."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from radmpc.plotting.canvas.columns import columns_within
from radmpc.plotting.canvas.figure import DPI
from radmpc.plotting.canvas.style import (
    COLUMN_WIDTH,
    LABEL_SIZE,
    MUTED,
    PALETTE,
    TICK_SIZE,
    TITLE_SIZE,
)
from radmpc.records import dataclass

__all__ = ["Chart", "Spread", "plot_chart"]

_HEIGHT = 2.5
"""Height of a chart [in]."""

_LOOKS = {"frameon": False, "handlelength": 1.6, "columnspacing": 1.2, "borderaxespad": 0.0}

_SIDESTEP = 0.08
"""How far apart the methods stand at one number, so that their bars do not hide each other."""

_MARKERS = ("o", "s", "^", "D", "v", "P")


@dataclass(frozen=True, slots=True)
class Spread:
    """One method's line.

    Attributes
    ----------
    label : str
        In the legend.
    x : sequence of float
        Fleet sizes, or other numbers along the axis.
    low, middle, high : sequence of float
        The bar's ends and the marker.
    is_bound : sequence of bool
        Where the middle is a lower bound only: an open marker with an arrow up.
    look : int or None
        Which color and marker, so that a method looks the same in all charts; None counts on.
    """

    label: str
    x: Sequence[float]
    low: Sequence[float]
    middle: Sequence[float]
    high: Sequence[float]
    is_bound: Sequence[bool] = ()
    look: int | None = None


@dataclass(frozen=True, slots=True)
class Chart:
    """Several lines with what stands around them.

    Attributes
    ----------
    spreads : sequence of Spread
        The lines.
    title, x_label, y_label : str
        What it shows; labels with units.
    is_log : bool
        Whether the y axis is logarithmic.
    line : float or None
        A value to mark by a line across.
    """

    spreads: Sequence[Spread]
    title: str
    x_label: str
    y_label: str
    is_log: bool = False
    line: float | None = None


def plot_chart(chart: Chart, ax: Axes | None = None) -> Axes:
    """Draw medians and spreads.

    Parameters
    ----------
    chart : Chart
        What to draw.
    ax : Axes or None
        Where; None makes a figure of one column.

    Returns
    -------
    Axes
        The axes drawn on; nothing is shown and nothing saved.
    """
    spreads = chart.spreads
    axes = _new_axes() if ax is None else ax
    middle = 0.5 * (len(spreads) - 1)
    for number, spread in enumerate(spreads):
        look = number if spread.look is None else spread.look
        _draw(axes, spread, look, _SIDESTEP * (number - middle))
    if chart.line is not None:
        axes.axhline(chart.line, color="#C00000", linewidth=0.7, linestyle=(0, (4, 2)), zorder=1)
    if chart.is_log:
        axes.set_yscale("log")
    axes.set_title(chart.title, loc="left", fontsize=TITLE_SIZE, fontweight="bold", pad=3.0)
    axes.set_xlabel(chart.x_label, fontsize=LABEL_SIZE, labelpad=1.0)
    axes.set_ylabel(chart.y_label, fontsize=LABEL_SIZE, labelpad=1.0)
    axes.tick_params(which="both", labelsize=TICK_SIZE, length=2.0, width=0.5, pad=1.5)
    ticks = sorted({float(x) for spread in spreads for x in spread.x})
    axes.set_xticks(ticks, [f"{x:g}" for x in ticks])
    axes.grid(axis="y", color="#E4E4E4", linewidth=0.4, zorder=0)
    axes.set_axisbelow(True)
    for name, spine in axes.spines.items():
        spine.set_linewidth(0.5)
        spine.set_visible(name in {"left", "bottom"})
    if not spreads:
        # A study interrupted before its first result: a chart without lines, and none to explain.
        axes.text(
            0.5, 0.5, "no results yet", transform=axes.transAxes, ha="center", va="center",
            fontsize=LABEL_SIZE, color=MUTED,
        )  # fmt: skip
        return axes
    _add_legend(axes)
    return axes


def _add_legend(ax: Axes) -> None:
    """Say below the axes which line is which, two side by side where they are short enough."""
    handles, labels = ax.get_legend_handles_labels()
    entries = dict(zip(labels, handles, strict=True))
    width = float(ax.get_window_extent().width / ax.figure.dpi)
    ax.legend(
        handles, labels, loc="upper center", bbox_to_anchor=(0.5, -0.16), fontsize=TICK_SIZE,
        ncols=columns_within(entries, width, _LOOKS, most=2), **_LOOKS,
    )  # fmt: skip


def _draw(ax: Axes, spread: Spread, number: int, sidestep: float) -> None:
    """Draw one line with its bars."""
    color, marker = PALETTE[number % len(PALETTE)], _MARKERS[number % len(_MARKERS)]
    x = np.asarray(spread.x, dtype=float) + sidestep
    low, middle, high = (
        np.asarray(v, dtype=float) for v in (spread.low, spread.middle, spread.high)
    )
    ax.plot(
        x, middle, color=color, linewidth=0.9, marker=marker, markersize=3.2, zorder=3,
        label=spread.label, gid=f"line:{spread.label}",
    )  # fmt: skip
    ax.vlines(x, low, high, color=color, linewidth=0.7, alpha=0.6, zorder=2)
    is_bound = np.asarray(spread.is_bound if len(spread.is_bound) else np.zeros(x.size), dtype=bool)
    if is_bound.any():
        ax.plot(
            x[is_bound], middle[is_bound], linestyle="none", marker=marker, markersize=4.2,
            markerfacecolor="white", markeredgecolor=color, markeredgewidth=0.8, zorder=4,
            gid=f"bound:{spread.label}",
        )  # fmt: skip
        for place, value in zip(x[is_bound], middle[is_bound], strict=True):
            ax.annotate(
                "", (place, value), xytext=(0.0, 9.0), textcoords="offset points",
                arrowprops={"arrowstyle": "<-", "color": color, "linewidth": 0.8},
                zorder=4,
            )  # fmt: skip


def _new_axes() -> Axes:
    """Return axes in a figure of their own."""
    figure = Figure(figsize=(COLUMN_WIDTH, _HEIGHT), dpi=DPI, layout="constrained")
    FigureCanvasAgg(figure)
    return figure.add_subplot()
