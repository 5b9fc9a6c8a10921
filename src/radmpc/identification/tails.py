"""Whether residuals are Gaussian, and how heavy their tails are if not."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache

import numpy as np
from scipy.special import chdtri, gammaln, ndtr

from radmpc.arrays import Matrix, Vector
from radmpc.identification.intervals import LEVEL, SIGMAS
from radmpc.records import dataclass

__all__ = ["Tails", "scatter", "tails", "variance_ratios"]

_AT_ONCE = 250_000
"""Numbers that likelihoods are computed of in one go [-]."""

_GRID = np.linspace(0.0, 0.45, 226)
"""Reciprocals of degrees of freedom [-] whose likelihoods are compared; 0 is Gaussian."""

_DOUBT = 0.01
"""Probability [-] of such residuals under Gaussian noise below which they are called another
kind."""

_DRAWS, _DRAWN_STEPS = 1000, 400
"""Simulated logs that tell how variances scatter, and the most steps of each: quantiles within 2 %
after 15 ms; those of longer logs follow by the law of their limit."""

_SMALLEST = 1e-300
"""Tail probability that stands for zero in a logarithm [-]."""


@dataclass(frozen=True, slots=True)
class Tails:
    """How residuals are distributed.

    Attributes
    ----------
    chance : float
        Probability that Gaussian residuals deviate as far by the Anderson-Darling statistic [-].
    excess_kurtosis : float
        Of the residuals, 0 for Gaussian ones [-].
    freedom, freedom_low, freedom_high : float
        Degrees of freedom of the Student-t distribution that fits best, and the ends of its 95 %
        interval; inf is Gaussian.
    """

    chance: float
    excess_kurtosis: float
    freedom: float
    freedom_low: float
    freedom_high: float

    @property
    def is_gaussian(self) -> bool:
        """Whether nothing speaks against it."""
        return self.chance >= _DOUBT and not np.isfinite(self.freedom_high)

    @property
    def are_heavy(self) -> bool:
        """Whether large deviations are more likely than Gaussian ones."""
        return bool(np.isfinite(self.freedom_high))


def tails(groups: Sequence[Matrix]) -> Tails:
    """Return what residuals say of their distribution.

    Parameters
    ----------
    groups : sequence of (N, p) array
        With mean zero, each whitened by its own covariance: residuals of Gaussian noise of several
        sizes would look heavy-tailed together.
    """
    numbers = [white.ravel() / max(float(white.std()), 1e-150) for white in groups]
    axes = np.concatenate([np.full(len(white), float(white.shape[1])) for white in groups])
    distances = np.concatenate([np.sum(white**2, axis=1) for white in groups])
    kurtosis = float(np.mean(distances**2 / np.maximum(axes * (axes + 2.0), 1e-300))) - 1.0
    best, low, high = _reciprocal_freedom(distances, axes)
    return Tails(
        chance=_anderson_darling(np.sort(np.concatenate(numbers))),
        excess_kurtosis=3.0 * kurtosis,
        freedom=1.0 / best if best > 0.0 else np.inf,
        freedom_low=1.0 / high if high > 0.0 else np.inf,
        freedom_high=1.0 / low if low > 0.0 else np.inf,
    )


def scatter(kind: Tails | None, steps: float) -> tuple[float, float, float]:
    """Return how many independent Gaussian steps tell a variance as well as these, and its ends.

    Parameters
    ----------
    kind : Tails or None
        Of the noise; None counts as Gaussian.
    steps : float
        Independent steps.

    Returns
    -------
    tuple of float
        Their number, and between what ratios to the true one a variance lies in 95 % beside what
        that number says: 1 and 1 unless tails are heavy.
    """
    # Fourth moments: squares of a variable with excess kurtosis k vary by (2 + k) instead of 2.
    excess = 0.0 if kind is None or kind.is_gaussian else max(kind.excess_kurtosis, 0.0)
    worth = max(steps / (1.0 + 0.5 * excess), 1.0)
    if kind is None or not kind.are_heavy:
        return worth, 1.0, 1.0
    # Logs seldom hold the largest deviations, so that their kurtosis is too small.
    least, most = variance_ratios(kind.freedom_low, steps)
    return max(min(worth, 2.0 * (SIGMAS / (1.0 - least)) ** 2), 1.0), least, most


@lru_cache(maxsize=256)
def variance_ratios(freedom: float, steps: float) -> tuple[float, float]:
    """Return between what ratios to the true one the variance of a log lies in 95 %.

    Parameters
    ----------
    freedom : float
        Degrees of freedom of Student-t noise, > 2.
    steps : float
        Independent steps of the log.
    """
    drawn = int(min(max(steps, 1.0), _DRAWN_STEPS))
    rng = np.random.default_rng(0)
    squares = rng.standard_normal((_DRAWS, drawn)) ** 2
    squares *= (freedom - 2.0) / rng.chisquare(freedom, (_DRAWS, drawn))
    tail = 0.5 - 0.5 * LEVEL
    ends = np.quantile(squares.mean(axis=1), [tail, 1.0 - tail])
    # Without fourth moments (freedom up to 4) sums of squares scatter like a stable law.
    shrink = (max(steps, drawn) / drawn) ** -(1.0 - max(2.0 / freedom, 0.5))
    low, high = 1.0 + (ends - 1.0) * shrink
    return float(low), float(high)


def _anderson_darling(ordered: Vector) -> float:
    """Return the chance of the statistic with mean and variance unknown (D'Agostino, Stephens)."""
    n = ordered.size
    below = np.log(np.maximum(ndtr(ordered), _SMALLEST))
    above = np.log(np.maximum(ndtr(-ordered[::-1]), _SMALLEST))
    weight = 2.0 * np.arange(1, n + 1) - 1.0
    statistic = -n - float(np.mean(weight * (below + above)))
    a = statistic * (1.0 + 0.75 / n + 2.25 / n**2)
    if a >= 10.0:
        return 0.0
    if a >= 0.6:
        return float(np.exp(1.2937 - 5.709 * a + 0.0186 * a**2))
    if a >= 0.34:
        return float(np.exp(0.9177 - 4.279 * a - 1.38 * a**2))
    if a >= 0.2:
        return float(1.0 - np.exp(-8.318 + 42.796 * a - 59.938 * a**2))
    return float(1.0 - np.exp(-13.436 + 101.14 * a - 223.73 * a**2))


def _reciprocal_freedom(distances: Vector, axes: Vector) -> tuple[float, float, float]:
    """Return the likeliest 1/ν of a multivariate Student-t and the ends of its interval.

    Its covariance is the one observed: only the shape is free.
    """
    loglikelihood = np.empty(_GRID.size)
    loglikelihood[0] = -0.5 * float(distances.sum() + axes.sum() * np.log(2 * np.pi))
    nu = 1.0 / _GRID[1:]
    loglikelihood[1:] = 0.0
    for number, count in zip(*np.unique(axes, return_counts=True), strict=True):
        each = gammaln(0.5 * (nu + number)) - gammaln(0.5 * nu)
        loglikelihood[1:] += count * (each - 0.5 * number * np.log(np.pi * (nu - 2.0)))
    # Many at once, but not all of a long log.
    size = max(1, _AT_ONCE // max(distances.size, 1))
    for begin in range(0, nu.size, size):
        some = nu[begin : begin + size, None]
        rest = (0.5 * (some + axes) * np.log1p(distances / (some - 2.0))).sum(axis=1)
        loglikelihood[1 + begin : 1 + begin + size] -= rest
    best = int(np.argmax(loglikelihood))
    is_likely = 2.0 * (loglikelihood[best] - loglikelihood) <= float(chdtri(1.0, 0.05))
    likely = np.flatnonzero(is_likely)
    return float(_GRID[best]), float(_GRID[likely[0]]), float(_GRID[likely[-1]])
