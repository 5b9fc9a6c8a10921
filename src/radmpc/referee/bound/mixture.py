r"""Student's t as a sum of few Gaussians, and one event without another under it.

Where covariances are known up to a factor :math:`1 / w`, with :math:`\nu w` of law
:math:`\chi^2_\nu`, noise is Gaussian once w is known. The density of d of its components, in units
of the stated covariances, is

.. math:: E\bigl[(w / 2\pi)^{d/2} e^{-w h}\bigr]

with h half the squared distance. As an integral over :math:`x = \log w` it is that of
:math:`e^{s x - (\nu/2 + h) e^x}`, :math:`s = (\nu + d) / 2`, up to a constant. The sum over points
of equal distance :math:`\Delta x`, times it, is off by Poisson's formula by at most the share

.. math:: \eta = 2 \sum_{m \ge 1} |\Gamma(s + 2 \pi i m / \Delta x)| / \Gamma(s),

whatever h is. Every event is then at most :math:`1 / (1 - \eta)` times as probable as under the sum
of Gaussians. Points of large w that are left out add a share, too, which is largest at h = 0; those
of small w are charged as if all that they stand for happened.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from scipy.special import gammaln, loggamma, ndtr

from radmpc.arrays import Vector, frozen
from radmpc.records import dataclass
from radmpc.referee.bound.bivariate import exceeds_alone
from radmpc.referee.tails import exceeding

__all__ = ["Mixture", "exceeds_alone_mixed", "exceeds_alone_under", "mixture_of"]

_ERROR = 1e-3
"""Share that the distance of points may add to a probability, and those of large w left out, each
[-]: half of it takes a ninth more points."""

_LOST = 1e-18
"""Probability of all points of small w that are left out [-]."""

_FAINT = 1e-4
"""Share of a probability that all points together may have that are charged whole [-]."""

_ROUNDING = 1e-8
"""Relative error of weights [-]: logarithms of their factors cancel, 6e6 at a million samples."""

_MOST_TERMS = 50_000
"""Gaussians times events that are summed in one go [-]: temporary arrays take 200 B for each."""


@dataclass(frozen=True, slots=True, eq=False)
class Mixture:
    """Gaussians whose weighted sum Student's t does not exceed by more than a share.

    Attributes
    ----------
    roots : (J,) array
        Square roots of w: deviations as stated times this are those in the units of each [-].
    weights : (J,) array
        Their sum is next to 1 [-].
    share : float
        What events may be more probable by, of what the sum says [-]; below it they are less
        probable by at most as much.
    lost : float
        What is to be added to the probability of an event besides [-].
    """

    roots: Vector
    weights: Vector
    share: float
    lost: float


@lru_cache(maxsize=64)
def mixture_of(samples: int) -> Mixture:
    """Return few Gaussians for two components of noise, or one.

    Parameters
    ----------
    samples : int
        Degrees of freedom ν, 3 or more.
    """
    shape = 0.5 * samples + 1.0
    distance = _distance(shape)
    # Nothing tells further out: e^±60 are factors of covariances.
    logs = distance * np.arange(-np.ceil(60.0 / distance), np.ceil(60.0 / distance) + 1.0)
    logs = logs[np.abs(logs) <= max(60.0 * np.sqrt(2.0 / samples), 1.0)]
    half = 0.5 * samples
    weights = distance * np.exp(half * (np.log(half) + logs - np.exp(logs)) - gammaln(half))
    below = np.cumsum(weights)
    densities = weights * np.exp(logs)
    above = np.cumsum(densities[::-1])[::-1]
    kept = (below > _LOST) & (above > _ERROR * above[0])
    cut = float(above[~kept & (below > _LOST)].max(initial=0.0) / above[0])
    share = (1.0 + _ROUNDING) / ((1.0 - _error(shape, distance)) * (1.0 - cut)) - 1.0
    lost = float(weights[below <= _LOST].sum())
    return Mixture(frozen(np.exp(0.5 * logs[kept])), frozen(weights[kept]), share, lost)


def exceeds_alone_under(samples: int | None, a: Vector, b: Vector, correlation: Vector) -> Vector:
    """Return an upper bound on ``P(Y > b and X <= a)``.

    Parameters
    ----------
    samples : int or None
        Degrees of freedom ν of deviations; None is that they are Gaussian.
    a, b, correlation : (E,) array
        As in `exceeds_alone`.
    """
    if samples is None:
        return exceeds_alone(a, b, correlation)
    return exceeds_alone_mixed(a, b, correlation, samples)[0]


def exceeds_alone_mixed(
    a: Vector, b: Vector, correlation: Vector, samples: int
) -> tuple[Vector, Vector]:
    """Return bounds on ``P(Y > b and X <= a)`` where deviations are Student's.

    Parameters
    ----------
    a, b : (E,) array
        Limits [standard deviations as stated], infinite ones allowed.
    correlation : (E,) array
        Of X and Y, as in `exceeds_alone`.
    samples : int
        Degrees of freedom ν.

    Returns
    -------
    above, below : (E,) array
        Not below the probability, and not further above it than `exceeds_alone` is above its own.
    """
    mixture, count = mixture_of(samples), len(b)
    above, below = np.empty(count), np.empty(count)
    size = max(1, _MOST_TERMS // len(mixture.roots))
    for start in range(0, count, size):
        part = slice(start, start + size)
        above[part], below[part] = _summed(mixture, a[part], b[part], correlation[part])
    above = (1.0 + mixture.share) * (above + mixture.lost)
    return np.minimum(above, exceeding(b, samples)), below / (1.0 + mixture.share)


def _summed(mixture: Mixture, a: Vector, b: Vector, correlation: Vector) -> tuple[Vector, Vector]:
    """Return sums over Gaussians of what bounds events, (E,), and of those not charged whole."""
    roots, weights = mixture.roots[:, None], mixture.weights[:, None]
    each = np.stack([limits * roots for limits in (a, b)])
    # Whatever the correlation.
    charged = weights * np.minimum(ndtr(each[0]), ndtr(-each[1]))
    faint = _FAINT / len(roots) * charged.sum(axis=0)
    point, event = np.nonzero(charged > faint)
    alone = np.zeros(charged.shape)
    alone[point, event] = mixture.weights[point] * exceeds_alone(
        each[0, point, event], each[1, point, event], correlation[event]
    )
    charged[point, event] = alone[point, event]
    return charged.sum(axis=0), alone.sum(axis=0)


def _distance(shape: float) -> float:
    """Return the largest distance of points that adds no more than `_ERROR` [-]."""
    low, high = 0.0, 4.0
    for _ in range(40):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if _error(shape, middle) <= _ERROR else (low, middle)
    return low


def _error(shape: float, distance: float) -> float:
    """Return what a distance of points adds at most, η [-]."""
    # From the fourth on they are less than rounding, and halve at least from one to the next.
    turns = 2.0 * np.pi * np.arange(1, 5) / distance
    sizes = np.exp(loggamma(shape + 1j * turns).real - gammaln(shape))
    return float(2.0 * sizes.sum() + 2.0 * sizes[-1])
