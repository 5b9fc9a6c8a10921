"""How residuals of successive steps belong together."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from radmpc.arrays import Indices, Matrix, Vector
from radmpc.records import dataclass

__all__ = ["LEAST_CHANGE", "Autocorrelation", "autocorrelation", "moving_states", "whitened"]

LEAST_CHANGE = 1e-9
"""Share of the largest deviation [-] up to which residuals of a state never change: rounding."""

_MOST_LAGS = 30
"""Lags that are looked at, and drawn."""


@dataclass(frozen=True, slots=True, eq=False)
class Autocorrelation:
    """Correlations of residuals with those some steps later, the axes taken together.

    Attributes
    ----------
    lags : (L,) array
        Steps between them, from 1.
    values : (L,) array
        Correlations [-].
    deviations : (L,) array
        Standard deviations that white residuals would give them.
    """

    lags: Vector
    values: Vector
    deviations: Vector

    @property
    def first(self) -> float:
        """The correlation from step to step."""
        return float(self.values[0]) if self.values.size else 0.0

    @property
    def first_score(self) -> float:
        """The same in standard deviations."""
        return float(self.values[0] / self.deviations[0]) if self.values.size else 0.0


def moving_states(residuals: Matrix) -> Indices:
    """Return the states whose residuals change.

    Parameters
    ----------
    residuals : (N, n) array
        Of every step.

    Returns
    -------
    (k,) array
        Their numbers.
    """
    scale = residuals.std(axis=0)
    return np.flatnonzero(scale > LEAST_CHANGE * max(float(scale.max(initial=0.0)), 1e-150))


def whitened(residuals: Matrix) -> Matrix:
    """Return residuals scaled to the unit covariance, states that never change left out.

    Of all ways to do so this one keeps every column closest to its state's residuals (Kessy, Lewin
    and Strimmer 2018), unless fewer columns than states are independent.

    Parameters
    ----------
    residuals : (N, n) array
        With mean zero.
    """
    moving = residuals[:, moving_states(residuals)]
    if not moving.size:
        return moving
    scaled = moving / moving.std(axis=0)
    values, vectors = np.linalg.eigh(scaled.T @ scaled / len(scaled))
    is_real = values > 1e-9
    turned = scaled @ (vectors[:, is_real] / np.sqrt(values[is_real]))
    return np.asarray(turned @ vectors.T if is_real.all() else turned)


def autocorrelation(pieces: Sequence[Matrix]) -> Autocorrelation:
    """Return the autocorrelation of residuals.

    Parameters
    ----------
    pieces : sequence of (k, p) array
        Whitened residuals, a piece per run without a gap.
    """
    num_axes = pieces[0].shape[1] if pieces else 0
    longest = max((len(piece) for piece in pieces), default=0)
    power = sum(float(np.sum(piece**2)) for piece in pieces)
    count = sum(len(piece) for piece in pieces)
    lags, values, deviations = [], [], []
    for lag in range(1, min(_MOST_LAGS, longest // 3) + 1):
        pairs = sum(max(len(piece) - lag, 0) for piece in pieces)
        if not pairs or not num_axes or power <= 0.0:
            break
        product = sum(float(np.sum(piece[lag:] * piece[:-lag])) for piece in pieces)
        lags.append(float(lag))
        values.append(product / pairs / (power / count))
        deviations.append(1.0 / np.sqrt(pairs * num_axes))
    return Autocorrelation(np.array(lags), np.array(values), np.array(deviations))
