"""Headlines that fit above what they head: names of scenarios may be of any length."""

from __future__ import annotations

from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure, SubFigure

from radmpc.plotting.canvas.figure import DPI, new_figure
from radmpc.plotting.canvas.style import TITLE_SIZE

__all__ = ["PLAIN", "cut_headline", "figure_headline", "shorten", "write_headline"]

_BESIDE = 0.4
"""Width of ticks and label left of axes, which a headline does not stand above [in]."""

_MARGINS = 0.1
"""Width left free by a headline above a whole figure [in]."""

_GROWTH = 1.3
"""How much wider than before the layout one of several axes may be, with what is beside it [-]."""


PLAIN: dict[Any, Any] = {"text.parse_math": False, "axes.formatter.use_mathtext": False}
"""Settings of matplotlib for texts with names: a dollar in them begins no formula, so that numbers
at axes are none, either."""


def write_headline(ax: Axes, name: str, ending: str = "") -> None:
    """Write a headline above axes: a name, cut where it would run off, and what it ends on.

    A layout makes room for half of a longer one: axes would shrink, down to nothing.

    Parameters
    ----------
    ax : Axes
        Above which.
    name : str
        What is cut.
    ending : str
        What is not.
    """
    figure = ax.get_figure(root=True)
    if figure is not None:
        width = _GROWTH * ax.get_window_extent().width / figure.dpi
        if len(figure.axes) == 1:
            width = figure.bbox.width / figure.dpi - _BESIDE
        name, ending = shorten(name, float(width), ending), ""
    _set_title(ax, name + ending)


def cut_headline(ax: Axes) -> None:
    """Cut a headline once more after the layout: axes in space begin far from the left.

    Parameters
    ----------
    ax : Axes
        Where they are to stay, with a headline of which the first line may be cut.
    """
    figure = ax.get_figure(root=True)
    if figure is None:
        return
    first, *below = ax.get_title(loc="left").split("\n")
    width = float(figure.bbox.width - ax.get_window_extent().x0) / figure.dpi - _MARGINS
    _set_title(ax, "\n".join([shorten(first, width), *below]))


def _set_title(ax: Axes, text: str) -> None:
    """Write a headline as it is."""
    ax.set_title(
        text, loc="left", fontsize=TITLE_SIZE, fontweight="bold", pad=3.0, parse_math=False
    )


def figure_headline(figure: Figure | SubFigure, name: str) -> str:
    """Return a headline above all panels of a figure: a name, cut where it would run off.

    Parameters
    ----------
    figure : Figure or SubFigure
        Above whose panels.
    name : str
        One line.
    """
    return shorten(name, float(figure.bbox.width / figure.dpi) - _MARGINS)


def shorten(name: str, width: float, ending: str = "") -> str:
    """Return a name and an ending that fit a width as a headline, the name cut where it must be.

    Parameters
    ----------
    name : str
        At least one letter of it is kept.
    width : float
        What both may take [in].
    ending : str
        Kept as it is.
    """
    paper = new_figure(1.0, 1.0)  # no size depends on the paper's
    text = paper.text(0.0, 0.0, "", fontsize=TITLE_SIZE, fontweight="bold", parse_math=False)
    kept, told = len(name), name + ending
    while kept > 1:
        text.set_text(told)
        measured = text.get_window_extent().width / DPI
        if measured <= width:
            break
        kept = max(1, min(kept - 1, int(kept * width / measured)))
        told = f"{name[:kept].rstrip()}…{ending}"
    return told
