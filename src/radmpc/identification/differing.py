"""Vehicles that differ: whether they do, and what they tell together nevertheless."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.special import chdtrc

from radmpc.identification.estimate import Estimate
from radmpc.identification.intervals import Interval
from radmpc.identification.model import StepModel
from radmpc.identification.spectral.alike import chance_of_spectra
from radmpc.identification.tails import scatter, tails
from radmpc.records import replace

__all__ = ["scaled_apart", "vehicles_differ"]

_DOUBT = 0.01
"""Probability [-] of such a difference between vehicles of one kind below which they count as
different."""


def vehicles_differ(pooled: Estimate, each: Sequence[Estimate], model: StepModel) -> bool:
    """Whether vehicles have noise or feedback of their own.

    Parameters
    ----------
    pooled : Estimate
        Of all vehicles together.
    each : sequence of Estimate
        Of every vehicle.
    model : StepModel
        Their dynamics.
    """
    if len(each) < 2:
        return False
    if any(one.measurement is not None for one in (pooled, *each)):
        chances = [_spectral_chance(pooled, each, model)]
    else:
        chances = [_covariance_chance(pooled, each)]
    gains = [one.gain for one in each if one.gain is not None]
    if len(gains) == len(each):
        chances.append(_gain_chance(gains))
    return bool(min(chances) < _DOUBT / len(chances))


def _spectral_chance(pooled: Estimate, each: Sequence[Estimate], model: StepModel) -> float:
    """Return the chance of such disturbances and sensors of vehicles that are alike."""
    steps = float(sum(one.num_steps for one in each))
    kind = pooled.tails
    if kind is not None and all(one.residuals.size for one in each):
        kind = tails([one.residuals for one in each])
    looseness = steps / scatter(kind, steps)[0]
    pieces = [[rows for _, _, rows in one.noise] for one in each]
    return chance_of_spectra(pieces, model, max(pooled.color, 0.0), looseness)


def _covariance_chance(pooled: Estimate, each: Sequence[Estimate]) -> float:
    """Return the chance of such covariances of vehicles that are alike, by Box's test."""
    n = pooled.covariance.value.shape[0]
    worths = np.array([one.worth for one in each])
    weights = worths / worths.sum()
    parts = [one.covariance.value for one in each]
    mean = sum((w * part for w, part in zip(weights, parts, strict=True)), np.zeros((n, n)))
    scale = np.sqrt(np.maximum(np.diag(mean), 1e-200))
    floor = 1e-9 * np.eye(n)
    logs = [np.linalg.slogdet(part / np.outer(scale, scale) + floor)[1] for part in [mean, *parts]]
    statistic = float(worths.sum() * logs[0] - np.sum(worths * np.array(logs[1:])))
    groups = len(each) - 1
    correction = (2 * n**2 + 3 * n - 1) / (6.0 * (n + 1) * groups)
    correction *= float(np.sum(1.0 / worths)) - 1.0 / worths.sum()
    freedom = 0.5 * groups * n * (n + 1)
    return float(chdtrc(freedom, max(statistic * (1.0 - correction), 0.0)))


def _gain_chance(gains: Sequence[Interval]) -> float:
    """Return the chance of such feedback of vehicles that are alike, by chi-square."""
    values = np.array([gain.value for gain in gains])
    widths = np.array([gain.high - gain.value for gain in gains]) / 1.96
    variances = np.clip(widths**2, 1e-300, 1e300)
    center = np.sum(values / variances, axis=0) / np.sum(1.0 / variances, axis=0)
    # Gains that a program computed are exact: differences in their last digits are none.
    apart = np.abs(values - center) > 1e-6 * np.abs(center).max()
    spread = np.sum(np.where(apart, (values - center) ** 2 / variances, 0.0))
    return float(chdtrc((len(gains) - 1) * values[0].size, spread))


def scaled_apart(pooled: Estimate, each: Sequence[Estimate], share: float) -> Estimate:
    """Return an estimate of all vehicles with the tails of residuals that are each scaled apart.

    Together, Gaussian residuals of several sizes would be heavy-tailed.

    Parameters
    ----------
    pooled : Estimate
        Of all vehicles together.
    each : sequence of Estimate
        Of every vehicle.
    share : float
        Correlation of the noise between vehicles at equal times [-].
    """
    kind = pooled.tails
    if kind is not None and all(one.residuals.size for one in each):
        kind = tails([one.residuals for one in each])
    steps = sum(one.num_steps * (1.0 - one.color**2) / (1.0 + one.color**2) for one in each)
    worth = min(sum(one.worth for one in each), scatter(kind, steps)[0])
    alike = 1.0 + (len(each) - 1) * max(share, 0.0) ** 2
    return replace(pooled, tails=kind, worth=max(worth / alike, 1.0))
