r"""The Gaussian tail :math:`Q`, its slope and its inverse, and clearances in standard deviations.

Tails go through ``ndtr(-q)``: :math:`\tfrac12-\tfrac12\mathrm{erf}` is exactly 0 from q = 8.4.
"""

from __future__ import annotations

from typing import overload

import numpy as np
from scipy.special import ndtr, ndtri

from radmpc.arrays import Vector
from radmpc.errors import RiskError

__all__ = [
    "CONTACT_TOL",
    "CONVEX_RISK",
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
