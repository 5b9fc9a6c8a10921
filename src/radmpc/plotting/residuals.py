"""What identification leaves unexplained: against Gaussian quantiles, and against its own past."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure, SubFigure
from scipy.special import ndtri

from radmpc.arrays import Vector
from radmpc.identification.identify import Identification
from radmpc.plotting.canvas.figure import check_figure, new_figure
from radmpc.plotting.canvas.style import (
    COLUMN_WIDTH,
    LABEL_SIZE,
    MUTED,
    PALETTE,
    TICK_SIZE,
    TITLE_SIZE,
)

__all__ = ["plot_residuals"]

_HEIGHT = 2.3
"""Height of the two panels [in]."""

_MOST_POINTS = 1500
"""Points of a quantile plot: of more, those in the middle would only cover each other."""


def plot_residuals(
    identified: Identification, figure: Figure | SubFigure | None = None
) -> tuple[Axes, Axes]:
    """Draw the residuals of an identification.

    Parameters
    ----------
    identified : Identification
        What logs tell.
    figure : Figure, SubFigure or None
        Where; None makes one of two columns.

    Returns
    -------
    tuple of Axes
        Quantiles of the whitened residuals against Gaussian ones, a state a color, where vehicles
        differ each scaled by its own covariance; and correlations of residuals with earlier ones,
        with the band that white ones stay in.
    """
    check_figure(figure)
    drawn = new_figure(2.0 * COLUMN_WIDTH, _HEIGHT) if figure is None else figure
    quantiles, past = drawn.subplots(1, 2)
    _draw_quantiles(quantiles, identified)
    _draw_past(past, identified)
    for axes in (quantiles, past):
        axes.tick_params(labelsize=TICK_SIZE, length=2.0, width=0.5, pad=1.5)
        axes.set_axisbelow(True)
        axes.grid(color="#E4E4E4", linewidth=0.4)
        for name, spine in axes.spines.items():
            spine.set_linewidth(0.5)
            spine.set_visible(name in {"left", "bottom"})
    return quantiles, past


def _draw_quantiles(axes: Axes, identified: Identification) -> None:
    """Draw sorted residuals over Gaussian quantiles."""
    reach = 0.0
    for i, (name, column) in enumerate(_columns(identified).items()):
        count = len(column)
        expected = ndtri((np.arange(count) + 0.5) / count)
        # All of both tails, and a few between.
        kept = np.unique(
            np.concatenate([
                np.arange(min(count, _MOST_POINTS // 3)),
                np.linspace(0, count - 1, _MOST_POINTS // 3).astype(int),
                np.arange(max(count - _MOST_POINTS // 3, 0), count),
            ])
        )  # fmt: skip
        axes.plot(
            expected[kept], np.sort(column)[kept], linestyle="none", marker=".", markersize=2.0,
            color=PALETTE[i % len(PALETTE)], gid=f"quantiles:{i}", zorder=3, label=name,
        )  # fmt: skip
        reach = max(reach, float(np.abs(expected).max()))
    axes.plot(
        [-reach, reach], [-reach, reach], color=MUTED, linewidth=0.7, gid="gaussian", zorder=2
    )
    if reach > 0.0:
        axes.legend(
            fontsize=TICK_SIZE, loc="upper left", frameon=False, markerscale=2.5,
            handletextpad=0.1, borderaxespad=0.2, labelspacing=0.2,
        )  # fmt: skip
    _name(axes, "Residuals", "Gaussian quantile [std. dev.]", "residual [std. dev.]")


def _columns(identified: Identification) -> dict[str, Vector]:
    """Return whitened residuals by the names of their states, each vehicle's by its own numbers."""
    axes = "xyz"[: identified.model.dimension]
    names = [*axes, *(f"v{axis}" for axis in axes)]
    found: dict[str, list[Vector]] = {}
    for one in identified.groups:
        columns = one.residuals.shape[1]
        states = [names[i] for i in one.residual_states]
        labels = states or [f"component {i + 1}" for i in range(columns)]
        for label, column in zip(labels, one.residuals.T, strict=True):
            found.setdefault(label, []).append(column)
    order = {name: i for i, name in enumerate(names)}
    ordered = sorted(found, key=lambda label: order.get(label, len(names)))
    return {label: np.concatenate(found[label]) for label in ordered}


def _draw_past(axes: Axes, identified: Identification) -> None:
    """Draw autocorrelations with the band of white noise."""
    seen = identified.pooled.autocorrelation
    axes.axhline(0.0, color=MUTED, linewidth=0.5, zorder=1)
    if seen.lags.size:
        seconds = identified.model.dt * seen.lags
        axes.fill_between(
            seconds, -1.96 * seen.deviations, 1.96 * seen.deviations,
            color="#E4E4E4", linewidth=0.0, gid="white", zorder=0,
        )  # fmt: skip
        axes.vlines(seconds, 0.0, seen.values, color=PALETTE[0], linewidth=1.0, gid="correlations")
    if identified.pooled.color > 0.0 and seen.lags.size:
        axes.plot(
            seconds,
            identified.pooled.color**seen.lags,
            color=PALETTE[1],
            linewidth=0.8,
            gid="memory",
        )
    _name(axes, "Memory", "lag [s]", "autocorrelation [-]")


def _name(axes: Axes, title: str, across: str, up: str) -> None:
    """Write what axes show."""
    axes.set_title(title, loc="left", fontsize=TITLE_SIZE, fontweight="bold", pad=3.0)
    axes.set_xlabel(across, fontsize=LABEL_SIZE, labelpad=1.0)
    axes.set_ylabel(up, fontsize=LABEL_SIZE, labelpad=1.0)
