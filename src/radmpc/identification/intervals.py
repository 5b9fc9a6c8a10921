"""Values with their 95 % confidence intervals."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt
from scipy.special import chdtri, ndtri

from radmpc.arrays import Frozen, Indices, Matrix, Vector, frozen
from radmpc.records import dataclass

__all__ = [
    "LEVEL",
    "SIGMAS",
    "Interval",
    "bound_alone",
    "covariance_interval",
    "normal_interval",
    "placed",
    "spanning",
    "widened",
    "worth_of",
]

LEVEL = 0.95
"""Confidence of every interval [-]."""

SIGMAS = float(ndtri(0.5 + 0.5 * LEVEL))
"""Half of an interval's width in standard deviations of a normal estimate [-]."""


@dataclass(frozen=True, slots=True, eq=False)
class Interval(Frozen):
    """A number, vector or matrix with the ends of its intervals, entry by entry.

    Attributes
    ----------
    value, low, high : array
        NaN where the log does not tell.
    """

    value: npt.NDArray[np.float64]
    low: npt.NDArray[np.float64]
    high: npt.NDArray[np.float64]

    def __post_init__(self) -> None:
        """Copy and freeze the arrays."""
        for name in ("value", "low", "high"):
            array = np.array(getattr(self, name), dtype=np.float64)
            object.__setattr__(self, name, frozen(array))

    @property
    def excludes_zero(self) -> bool:
        """Whether any entry's interval lies beside zero."""
        return bool(np.any((self.low > 0.0) | (self.high < 0.0)))


def normal_interval(value: npt.ArrayLike, deviation: npt.ArrayLike) -> Interval:
    """Return the interval of estimates that are nearly normal.

    Parameters
    ----------
    value : array
        Estimates.
    deviation : array
        Their standard deviations.
    """
    middle, width = np.asarray(value, dtype=float), SIGMAS * np.asarray(deviation, dtype=float)
    return Interval(middle, middle - width, middle + width)


def covariance_interval(covariance: Matrix, steps: float) -> Interval:
    """Return the interval of a covariance: of variances by chi-square, of the rest nearly normal.

    Parameters
    ----------
    covariance : (n, n) array
        The estimate.
    steps : float
        Number of independent steps that it is worth, > 0.
    """
    variances: Vector = np.diag(covariance)
    deviation = np.sqrt((np.outer(variances, variances) + covariance**2) / steps)
    middle = normal_interval(covariance, deviation)
    low, high = np.array(middle.low), np.array(middle.high)
    tail = 0.5 - 0.5 * LEVEL
    np.fill_diagonal(low, variances * steps / chdtri(steps, tail))
    np.fill_diagonal(high, variances * steps / chdtri(steps, 1.0 - tail))
    return Interval(covariance, low, high)


def widened(covariance: Interval, least: float, most: float) -> Interval:
    """Return the interval of a covariance whose variances scatter by more than chi-square.

    Parameters
    ----------
    covariance : Interval
        As by chi-square, (n, n).
    least, most : float
        Ends of the ratios of observed to true variances.
    """
    low, high = np.array(covariance.low), np.array(covariance.high)
    variances: Vector = np.diag(covariance.value)
    np.fill_diagonal(low, np.minimum(np.diag(low), variances / most))
    np.fill_diagonal(high, np.maximum(np.diag(high), variances / least))
    return Interval(covariance.value, low, high)


def placed(part: Interval, around: Interval, places: tuple[Indices, ...]) -> Interval:
    """Return an interval of which some entries are those of another.

    Parameters
    ----------
    part : Interval
        The entries.
    around : Interval
        What the others stay.
    places : tuple of arrays
        Indices of the entries, as NumPy takes them.
    """
    ends = [np.array(getattr(around, name)) for name in ("value", "low", "high")]
    for end, name in zip(ends, ("value", "low", "high"), strict=True):
        end[places] = getattr(part, name)
    return Interval(*ends)


def spanning(intervals: Sequence[Interval]) -> Interval:
    """Return the first interval's values with ends that hold all intervals.

    Parameters
    ----------
    intervals : sequence of Interval
        Of the same entries, at least one.
    """
    low = np.min([one.low for one in intervals], axis=0)
    high = np.max([one.high for one in intervals], axis=0)
    return Interval(intervals[0].value, low, high)


def bound_alone(covariance: Interval) -> Interval:
    """Return the interval of a covariance of which no more is known than what it is at most.

    Parameters
    ----------
    covariance : Interval
        As if it were known, (n, n).
    """
    low = np.array(covariance.low)
    np.fill_diagonal(low, 0.0)
    size = np.sqrt(np.outer(*2 * (np.diag(covariance.high),)))
    off = ~np.eye(len(low), dtype=bool)
    high = np.where(off, size, covariance.high)
    return Interval(covariance.value, np.where(off, -size, low), high)


def worth_of(covariance: Interval) -> float:
    """Return how many independent steps would tell the variances as well, on average.

    Parameters
    ----------
    covariance : Interval
        With its interval, (n, n).
    """
    variances = np.maximum(np.diag(covariance.value), 1e-300)
    deviations = np.maximum(np.diag(covariance.high - covariance.low) / 3.92, 1e-300)
    return max(float(np.median(2.0 * (variances / deviations) ** 2)), 1.0)
