"""Legends in as few lines as their width allows."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from matplotlib.legend import Legend

from radmpc.plotting.canvas.figure import DPI, new_figure
from radmpc.plotting.canvas.style import TICK_SIZE

__all__ = ["columns_within", "legend_width", "lines_within"]

_PAPER = 1.0
"""Width and height of the figure on which legends are measured, which no size depends on [in]."""


def columns_within(
    entries: Mapping[str, Any], width: float, looks: Mapping[str, Any], *, most: int | None = None
) -> int:
    """Return how many columns make the fewest lines of a legend that fits a width, at least one.

    The legend is measured as it will be drawn: what letters and signs take is nothing to guess.

    Parameters
    ----------
    entries : mapping
        Handles by what they mean.
    width : float
        What the legend may take [in].
    looks : mapping
        What the legend will be drawn with beside its columns and the size of its font.
    most : int or None
        Columns at most; None is as many as there are entries.
    """
    count = max(1, len(entries))
    most = count if most is None else min(most, count)
    tried = dict.fromkeys(-(-count // lines) for lines in range(-(-count // most), count + 1))
    for columns in tried:
        if legend_width(list(entries.values()), list(entries), columns, looks) <= width:
            return columns
    return 1


def legend_width(
    handles: Sequence[Any], labels: Sequence[str], columns: int, looks: Mapping[str, Any]
) -> float:
    """Return the width of a legend as it will be drawn [in].

    Parameters
    ----------
    handles, labels : sequence
        Its entries.
    columns : int
        How many stand side by side.
    looks : mapping
        As in `columns_within`.
    """
    legend = Legend(
        new_figure(_PAPER, _PAPER), handles, labels, ncols=columns, fontsize=TICK_SIZE, **looks
    )
    return float(legend.get_window_extent().width) / DPI


def lines_within(entries: Mapping[str, Any], width: float, looks: Mapping[str, Any]) -> int:
    """Return how many lines such a legend takes.

    Parameters
    ----------
    entries, width, looks
        As in `columns_within`.
    """
    return -(-len(entries) // columns_within(entries, width, looks))
