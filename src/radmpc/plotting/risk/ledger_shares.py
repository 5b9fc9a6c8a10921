"""Each vehicle's share of Δ, and what was left unused, as bars."""

from __future__ import annotations

import numpy as np
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.text import Text

from radmpc.arrays import Matrix, Vector
from radmpc.model.given import check_plan
from radmpc.model.ledger import CAUSES
from radmpc.model.plan import Cause, Plan
from radmpc.plotting.canvas.columns import columns_within
from radmpc.plotting.canvas.figure import check_axes, settle_layout
from radmpc.plotting.canvas.headline import PLAIN
from radmpc.plotting.canvas.style import ALERT, OBSTACLE_FILL, PALETTE, TICK_SIZE
from radmpc.plotting.risk.ledger_looks import (
    LINE,
    ROW,
    new_column,
    percent,
    say_nothing,
    settle_part,
    write_beside,
)
from radmpc.plotting.risk.ledger_rows import share_rows

__all__ = ["plot_risk_shares", "shares_height"]

_FRAME = 0.60
"""Height of heading, ticks, label and a line of the legend [in]."""

_ONE_LINE = 3
"""Causes that stand beside the heading in one line, unless names are long."""

_REACH = 1.12
"""How far right the legend reaches, above the percentages: a share of the axes' width [-]."""

_GAP = 0.08
"""Width between the heading and the legend beside it [in]."""

_LOOKS = {
    "columnspacing": 0.9,
    "frameon": False,
    "handlelength": 1.0,
    "handletextpad": 0.4,
    "borderaxespad": 0.1,
    "borderpad": 0.1,
    "labelspacing": 0.2,
}

_COLORS: dict[Cause, str] = {
    "pair": PALETTE[0],
    "obstacle": PALETTE[4],
    "workspace": PALETTE[2],
    "range": PALETTE[3],
}
_LABELS: dict[Cause, str] = {
    "pair": "half of pairs",
    "obstacle": "obstacles",
    "workspace": "workspace",
    "range": "half of ranges",
}


@rc_context(PLAIN)
def plot_risk_shares(plan: Plan, ax: Axes | None = None) -> Axes:
    """Draw each vehicle's share of Δ by cause, and what was left unused or is missing.

    The risk of a pair is shared half and half between its vehicles. The 20 largest shares stand
    alone, the others in one bar.

    Parameters
    ----------
    plan : Plan
        With a certificate; without one the axes say so.
    ax : Axes or None
        Where. None makes a figure of one column.

    Returns
    -------
    Axes
        The axes drawn on.
    """
    check_plan(plan)
    check_axes(ax, 2)
    axes = new_column(shares_height(plan)).add_subplot() if ax is None else ax
    heading = settle_part(axes, "by vehicle", "share of Δ [%]")
    if plan.risk.certified is None:
        return say_nothing(axes, plan)
    lengths = _draw_bars(axes, *share_rows(plan))
    unused = 100.0 * (1.0 - plan.risk.certified / plan.risk.bound)
    _draw_unused(axes, unused, len(lengths))
    axes.set_xlim(0.0, 1.0001 * max(float(lengths.max()), abs(unused), 1e-9))
    _add_legend(axes, heading)
    return axes


def _draw_bars(ax: Axes, names: list[str], shares: Matrix) -> Vector:
    """Draw a bar per vehicle, its causes end to end; return the bars' lengths [%]."""
    left = np.zeros(len(names))
    for column, cause in enumerate(CAUSES):
        width = 100.0 * shares[:, column]
        if width.any():
            bars = ax.barh(
                np.arange(len(names)), width, 0.7, left, color=_COLORS[cause], label=_LABELS[cause]
            )
            for name, patch in zip(names, bars.patches, strict=True):
                patch.set_gid(f"{cause}:{name}")
        left += width
    ax.set_yticks(range(len(names)), names)
    for row, length in enumerate(left):
        write_beside(ax, row, percent(float(length) / 100.0), f"percent:{names[row]}")
    return left


def _draw_unused(ax: Axes, unused: float, row: int) -> None:
    """Draw what is left of Δ below the vehicles, in gray; what exceeds it in red [%]."""
    if unused >= 0.0:
        name, (bar,) = "unused", ax.barh(row, unused, 0.7, color=OBSTACLE_FILL)
    else:
        name, (bar,) = "above Δ", ax.barh(row, -unused, 0.7, color=ALERT)
    bar.set_gid("unused")
    names = [label.get_text() for label in ax.get_yticklabels()]
    ax.set_yticks(range(row + 1), [*names, name])
    ax.set_ylim(row + 0.5, -0.5)
    write_beside(ax, row, percent(abs(unused) / 100.0), "percent:unused")


def shares_height(plan: Plan) -> float:
    """Return the height that the bars ask for [in]."""
    names, shares = share_rows(plan)
    has_second_line = np.count_nonzero(shares.any(axis=0)) > _ONE_LINE
    return _FRAME + ROW * (len(names) + 1) + LINE * has_second_line


def _add_legend(ax: Axes, heading: Text) -> None:
    """Say which color is which cause, above the bars and beside the heading."""
    handles, labels = ax.get_legend_handles_labels()
    if not handles:
        return
    settle_layout(ax)  # names take their width from the axes
    pixels = _REACH * ax.get_window_extent().width - heading.get_window_extent().width
    room = pixels / ax.figure.dpi - _GAP
    entries = dict(zip(labels, handles, strict=True))
    ax.legend(
        handles, labels, loc="lower right", bbox_to_anchor=(_REACH, 0.99), fontsize=TICK_SIZE,
        ncols=columns_within(entries, room, _LOOKS), **_LOOKS,
    )  # fmt: skip
