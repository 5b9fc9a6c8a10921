r"""The Gaussian tail :math:`Q`, its slope and its inverse, and clearances in standard deviations.

Tails go through ``ndtr(-q)``: :math:`\tfrac12-\tfrac12\mathrm{erf}` is exactly 0 from q = 8.4.
"""

from __future__ import annotations

from functools import lru_cache
from typing import overload

import numpy as np
from scipy.special import gammaln, ndtr, ndtri, stdtr, stdtrit

from radmpc.arrays import Vector
from radmpc.errors import RiskError
from radmpc.records import dataclass

__all__ = [
    "CONTACT_TOL",
    "CONVEX_RISK",
    "GAUSSIAN",
    "Tail",
    "clearance",
    "clearance_for",
    "tail_probability",
    "tail_slope",
]

CONVEX_RISK = 0.5
"""Risk up to which the tail is convex in the clearance [-]: no chance row may run more."""

CONTACT_TOL = 1e-9
"""Slack down to which a row without noise holds, since touching is no collision [m]. Below it a
plan is rejected by the referee, far above it plans would hang on the last bit of a sum."""


_NOTHING = 1e-13
"""Risk of a pair or an obstacle that need not be looked at where tails fall slowly [-]."""

_DIVISOR = 1e-200
"""Deviation by which slacks of meters are divided without overflow [m]."""

_MOST_CLEARANCE = 1e8
"""Clearance up to which one is asked for [standard deviations]: tails of few degrees of freedom
would want 1e100 for no risk at all, and solvers refuse such numbers."""


def clearance(slack: Vector, deviation: Vector) -> Vector:
    """Return slacks in standard deviations, without noise +inf where they hold, else −inf.

    Parameters
    ----------
    slack : array
        How far a noisy sum is from its bound on average [m].
    deviation : array of the same shape
        Its standard deviation [m], 0 where there is no noise.

    Returns
    -------
    array
        ``slack / deviation``; without noise +inf down to a slack of ``-CONTACT_TOL``.
    """
    if deviation.size and deviation.min() > _DIVISOR:
        plain: Vector = slack / deviation
        return plain
    noisy = deviation > 0.0
    certain = np.where(slack >= -CONTACT_TOL, np.inf, -np.inf)
    with np.errstate(over="ignore"):  # a slack of meters over a deviation of 1e-300
        scaled: Vector = np.where(noisy, slack / np.where(noisy, deviation, 1.0), certain)
    return scaled


@overload
def tail_probability(clearance: float) -> float: ...
@overload
def tail_probability(clearance: Vector) -> Vector: ...
def tail_probability(clearance: float | Vector) -> float | Vector:
    r"""Probability that a standard normal exceeds the clearance.

    .. math:: Q(q) = \Pr[\xi > q]

    Parameters
    ----------
    clearance : float or array
        :math:`q`, in standard deviations; infinite where there is no noise.

    Returns
    -------
    float or array
        :math:`Q(q)`, accurate far into the tail (1e-300).
    """
    return ndtr(-clearance)


@overload
def tail_slope(clearance: float) -> float: ...
@overload
def tail_slope(clearance: Vector) -> Vector: ...
def tail_slope(clearance: float | Vector) -> float | Vector:
    r"""Return the derivative of `tail_probability`, :math:`-\varphi(q)`."""
    slope: float | Vector = -np.exp(-0.5 * np.square(clearance)) / np.sqrt(2.0 * np.pi)
    return slope


def clearance_for(risk: float | Vector) -> Vector:
    r"""Clearance that leaves exactly the given risk, :math:`Q^{-1}(\delta)`.

    Parameters
    ----------
    risk : float or array
        :math:`\delta`, ``0 < risk <= 0.5``.

    Returns
    -------
    array
        Clearance in standard deviations, never negative.

    Raises
    ------
    RiskError
        If a risk lies outside (0, 0.5]: beyond one half the back-off would turn negative.
    """
    risk = np.asarray(risk, dtype=np.float64)
    if not np.all((risk > 0.0) & (risk <= 0.5)):
        raise RiskError(f"risk must lie in (0, 0.5], got {risk.min()} to {risk.max()}")
    # -ndtri(risk), not ndtri(1 - risk): the latter is inf below 1e-16.
    return np.maximum(-ndtri(risk), 0.0)


@dataclass(frozen=True, slots=True)
class Tail:
    r"""The tail of what linear sums of noise deviate by, in standard deviations as stated.

    Covariances that were estimated from ν independent steps are known up to a common factor: the
    true ones are :math:`\nu / \chi^2_\nu` times those stated, and a sum deviates as Student's t
    with ν degrees of freedom does. Its tail is convex where the Gaussian one is.

    Attributes
    ----------
    samples : int or None
        ν; None is that covariances are known, and the tail Gaussian.
    """

    samples: int | None = None

    @property
    def is_gaussian(self) -> bool:
        """Whether covariances are known."""
        return self.samples is None

    @overload
    def probability(self, clearance: float) -> float: ...
    @overload
    def probability(self, clearance: Vector) -> Vector: ...
    def probability(self, clearance: float | Vector) -> float | Vector:
        """Return the probability that a deviation exceeds the clearance, see `tail_probability`."""
        if self.samples is None:
            return tail_probability(clearance)
        tails: Vector = np.asarray(stdtr(float(self.samples), -clearance), dtype=np.float64)
        return tails if tails.ndim else float(tails)

    def slope(self, clearance: Vector) -> Vector:
        """Return the derivative of `probability`, minus the density."""
        if self.samples is None:
            return tail_slope(clearance)
        n = float(self.samples)
        factor = np.exp(gammaln(0.5 * (n + 1.0)) - gammaln(0.5 * n)) / np.sqrt(n * np.pi)
        return np.asarray(-factor * (1.0 + np.square(clearance) / n) ** (-0.5 * (n + 1.0)))

    def beyond(self, deviations: float) -> float:
        """Return where the tail is as small as the Gaussian's so far out, or next to nothing."""
        if self.samples is None:
            return deviations
        return float(self.clearance_for(max(tail_probability(deviations), _NOTHING)))

    def clearance_for(self, risk: float | Vector) -> Vector:
        """Return the clearance that leaves exactly the given risk, see `clearance_for`.

        Raises
        ------
        RiskError
            If a risk lies outside (0, 0.5].
        """
        if isinstance(risk, float):
            return _clearance_of(self.samples, risk)
        return _clearances(self.samples, risk)


def _clearances(samples: int | None, risk: float | Vector) -> Vector:
    """Return what `Tail.clearance_for` does."""
    gaussian = clearance_for(risk)
    if samples is None:
        return gaussian
    wanted = -stdtrit(float(samples), np.asarray(risk, dtype=np.float64))
    return np.minimum(np.maximum(wanted, gaussian), _MOST_CLEARANCE)


@lru_cache(maxsize=256)
def _clearance_of(samples: int | None, risk: float) -> Vector:
    """Return the same of one risk: programs ask for few, for every hazard again."""
    return _clearances(samples, risk)


GAUSSIAN = Tail()
"""The tail where covariances are known."""
