"""What a key of a scenario costs: curves of cost over its values."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes

from radmpc.errors import ArgumentError
from radmpc.plotting.canvas.figure import check_axes, new_figure
from radmpc.plotting.canvas.style import (
    ALERT,
    COLUMN_WIDTH,
    LABEL_SIZE,
    PALETTE,
    TICK_SIZE,
    TITLE_SIZE,
)
from radmpc.records import dataclass

__all__ = ["CostPoint", "plot_costs"]

_HEIGHT = 2.4
"""Of the figure [in]."""

_DECADES = 1.0
"""Decades that positive values must span for a logarithmic axis."""


@dataclass(frozen=True, slots=True)
class CostPoint:
    """One plan of a curve.

    Attributes
    ----------
    value : float or str
        Of the key that runs along the axis.
    curve : str
        What the curve holds fixed; empty where there is one.
    cost, bound : float or None
        Of the plan, None where there is none; and the lower bound.
    is_within : bool
        Whether its certificate is within Δ.
    """

    value: float | str
    curve: str
    cost: float | None
    bound: float | None
    is_within: bool


def plot_costs(key: str, points: Sequence[CostPoint], ax: Axes | None = None) -> Axes:
    """Draw costs over the values of a key.

    Parameters
    ----------
    key : str
        The label of the axis.
    points : sequence of CostPoint
        In any order; texts as values stand side by side.
    ax : Axes or None
        Where; None makes a figure of one column.

    Returns
    -------
    Axes
        A line per curve, down to the lower bound a shade; a cross on the axis where there is no
        plan.

    Raises
    ------
    ArgumentError
        If there is no point.
    """
    check_axes(ax, 2)
    if not points:
        raise ArgumentError("there must be at least one point, got none")
    axes = new_figure(COLUMN_WIDTH, _HEIGHT).add_subplot() if ax is None else ax
    values = [point.value for point in points]
    numbers = [value for value in values if not isinstance(value, str)]
    is_scale = len(numbers) == len(values)
    words = list(dict.fromkeys(str(value) for value in values))
    curves = list(dict.fromkeys(point.curve for point in points))
    for i, curve in enumerate(curves):
        own = [point for point in points if point.curve == curve]
        across = np.array([p.value if is_scale else words.index(str(p.value)) for p in own], float)
        order = np.argsort(across, kind="stable")
        _draw(axes, across[order], [own[k] for k in order], curve, PALETTE[i % len(PALETTE)])
    if not is_scale:
        axes.set_xticks(range(len(words)), words, parse_math=False)
    elif min(numbers) > 0.0 and np.log10(max(numbers) / min(numbers)) >= _DECADES:
        axes.set_xscale("log")
    _finish(axes, key, curves)
    return axes


def _draw(axes: Axes, across: np.ndarray, points: list[CostPoint], curve: str, color: str) -> None:
    """Draw one curve."""
    costs = np.array([np.nan if p.cost is None else p.cost for p in points])
    bounds = np.array(
        [c if p.bound is None else p.bound for p, c in zip(points, costs, strict=True)]
    )
    axes.plot(across, costs, color=color, linewidth=1.1, label=curve or None, zorder=3)
    axes.fill_between(across, bounds, costs, color=color, alpha=0.15, linewidth=0.0, zorder=1)
    within = np.array([p.is_within for p in points])
    for is_within, face in ((True, color), (False, "white")):
        chosen = within == is_within
        axes.plot(
            across[chosen], costs[chosen], linestyle="none", marker="o", markersize=3.0,
            markerfacecolor=face, markeredgecolor=color, markeredgewidth=0.8, zorder=4,
        )  # fmt: skip
    none = np.isnan(costs)
    axes.plot(
        across[none], np.zeros(int(none.sum())), linestyle="none", marker="x", markersize=4.0,
        color=ALERT, transform=axes.get_xaxis_transform(), clip_on=False, zorder=5, gid="no plan",
    )  # fmt: skip


def _finish(axes: Axes, key: str, curves: list[str]) -> None:
    """Write what the axes show."""
    axes.set_title(
        f"Cost over {key}", loc="left", fontsize=TITLE_SIZE, fontweight="bold", pad=3.0,
        parse_math=False,
    )  # fmt: skip
    axes.set_xlabel(key, fontsize=LABEL_SIZE, labelpad=1.0, parse_math=False)
    axes.set_ylabel("cost [m/s²]", fontsize=LABEL_SIZE, labelpad=1.0)
    axes.tick_params(which="both", labelsize=TICK_SIZE, length=2.0, width=0.5, pad=1.5)
    axes.grid(color="#E4E4E4", linewidth=0.4)
    axes.set_axisbelow(True)
    for name, spine in axes.spines.items():
        spine.set_linewidth(0.5)
        spine.set_visible(name in {"left", "bottom"})
    if len(curves) > 1:
        for text in axes.legend(fontsize=TICK_SIZE, frameon=False).get_texts():
            text.set_parse_math(False)
