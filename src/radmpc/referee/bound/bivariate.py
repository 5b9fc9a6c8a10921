r"""Upper bounds on the probability that one Gaussian event happens without another.

For standard normals X and Y of correlation ρ (Plackett 1954)
:math:`\partial_\rho \Pr[X > a, Y > b] = \varphi_2(a, b; \rho)`, so

.. math::

    \Pr[X \le a, Y > b] = \max(0,\ Q(b) - Q(a)) + \int_\rho^1 \varphi_2(a, b; r)\,dr,

and for ρ < 0 it is :math:`\Phi(a)\,Q(b) + \int_0^{-\rho} \varphi_2(-a, b; r)\,dr`. No term is
negative: nothing cancels. With :math:`t^2 = (1 - r) / (1 + r)` the integral is

.. math::

    \frac{1}{\pi}\,e^{-(a^2 + b^2) / 4} \int \frac{1}{1 + t^2}\,
    \exp\Bigl(-\frac{(a + b)^2}{8}\,t^2 - \frac{(a - b)^2}{8\,t^2}\Bigr)\,dt.

As a function of t² the logarithm of 1/(1 + t²) is convex, hence below its chord on any piece; with
the chord in its place the integral has a closed form. Two pieces cost at most 1.6 % of the
integral, and 0.3 % where ρ is at least a half.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike
from scipy.special import erfc, erfcx, ndtr

from radmpc.arrays import Matrix, Tensor, Vector

__all__ = ["exceeds_alone"]

_FURTHEST = 40.0
"""Limits further out are taken as this [standard deviations]: Q(40) is 4e-350, no number any
more."""

_NARROW = 1e-3
"""Half widths below which a difference of erfcx is taken as its Taylor series [-]. The series then
lacks 1e-12 of it; above, the difference loses four of its sixteen digits at most."""

_ROUNDING = 2e-11
"""Relative error that all roundings together can cause [-]: added to what is computed."""


def exceeds_alone(a: ArrayLike, b: ArrayLike, correlation: ArrayLike) -> Tensor:
    """Return an upper bound on ``P(Y > b and X <= a)`` of standard normals.

    Parameters
    ----------
    a, b : array_like
        Limits [-], of any sign, infinite ones allowed; broadcast.
    correlation : array_like
        Correlation of X and Y [-]; clipped to [-1, 1]. The probability falls with it: who knows it
        up to an error should pass it rounded down. NaN stands for a correlation not known.

    Returns
    -------
    ndarray
        At most 1.6 % above the true value and not below it, in the shape of the arguments; exact
        up to rounding at correlations of -1, 0 and 1. Values below 1e-300 underflow.
    """
    a, b, correlation = np.broadcast_arrays(
        np.clip(np.asarray(a, dtype=float), -_FURTHEST, _FURTHEST),
        np.clip(np.asarray(b, dtype=float), -_FURTHEST, _FURTHEST),
        np.clip(np.asarray(correlation, dtype=float), -1.0, 1.0),
    )
    shape, a, b, correlation = a.shape, a.ravel(), b.ravel(), correlation.ravel()
    # Whatever the correlation; and (Slepian 1962) the product, where it is not negative.
    below, beyond = ndtr(a), ndtr(-b)
    result, product = np.minimum(below, beyond), below * beyond
    alike, against = correlation > 0.0, correlation < 0.0
    if alike.any():
        integral = _alike(a[alike], b[alike], correlation[alike])
        result[alike] = np.minimum(product[alike], integral)
    result[correlation == 0.0] = product[correlation == 0.0]
    if against.any():
        integral = _against(-a[against], b[against], -correlation[against])
        result[against] = np.minimum(result[against], product[against] + integral)
    return result.reshape(shape)


def _alike(a: Vector, b: Vector, correlation: Vector) -> Vector:
    """Return the bound for correlations above zero: the integral from t = 0."""
    end = (1.0 - correlation) / (1.0 + correlation)
    middle = np.expm1(0.5 * np.log1p(end))
    steepness, scale = _chord(np.array([np.zeros_like(end), middle]), np.array([middle, end]))
    p, q = np.sqrt(np.square(a + b) / 8.0 + steepness), np.abs(a - b) / np.sqrt(8.0)
    first, second, before = _up_to(p[[0, 1, 1]], q, np.sqrt(np.array([middle, end, middle])))
    # The chord is below the weight outside of its piece: what is taken off here is less than what
    # the piece before has added, and no digits of the sum are lost.
    total = scale[0] * first + scale[1] * np.maximum(second - before, 0.0)
    total *= np.exp(-0.25 * (np.square(a) + np.square(b))) / np.pi
    return np.asarray((_between(b, a) + total) * (1.0 + _ROUNDING))


def _against(a: Vector, b: Vector, correlation: Vector) -> Vector:
    """Return bounds on the integral of the density over correlations from zero."""
    begin = (1.0 - correlation) / (1.0 + correlation)
    one = np.ones_like(begin)
    middle = np.expm1(0.5 * (np.log1p(begin) + np.log1p(one)))
    since, until = np.array([begin, middle]), np.array([middle, one])
    steepness, scale = _chord(since, until)
    p, q = np.sqrt(np.square(a + b) / 8.0 + steepness), np.abs(a - b) / np.sqrt(8.0)
    # From infinity: what lies beyond t = 1 is at most the product added in the end.
    pieces = _from(p, q, np.sqrt(since)) - _from(p, q, np.sqrt(until))
    total = (scale * np.maximum(pieces, 0.0)).sum(axis=0)
    total *= np.exp(-0.25 * (np.square(a) + np.square(b))) / np.pi
    return np.asarray(total * (1.0 + _ROUNDING) + _ROUNDING * ndtr(-a) * ndtr(-b))


def _chord(begin: Matrix, end: Matrix) -> tuple[Matrix, Matrix]:
    """Return m and c with ``1 / (1 + u) <= c exp(-m u)`` between two u in [0, 1]."""
    width = end - begin
    rise = np.log1p(end) - np.log1p(begin)
    # Any slope that is not steeper than the chord will do where there is no width. Those of chords
    # lie between these limits; where there is next to no width, rounding leaves others, also 0.
    steepness = np.where(width > 0.0, rise / np.where(width > 0.0, width, 1.0), 0.5)
    steepness = np.clip(steepness, 0.5, 1.0)
    return steepness, np.exp(steepness * begin - np.log1p(begin))


def _up_to(p: Matrix, q: Vector, t: Matrix) -> Matrix:
    """Return the integral of ``exp(-(p x)^2 - (q / x)^2)`` over x from 0 to t."""
    # At t = 0 any small t is as good: the factor t of the result is what vanishes.
    near, far = p * t, q / np.maximum(t, 1e-12)
    outside = np.exp(-np.square(far) - np.square(near))
    ahead = far - near
    # erfcx overflows far left of zero, where erfc does very well.
    large = np.where(
        ahead > 0.0,
        outside * erfcx(np.maximum(ahead, 0.0)),
        np.exp(-2.0 * p * q) * erfc(ahead),
    )
    result = large - outside * erfcx(far + near)
    narrow = near < _NARROW
    if narrow.any():
        result[narrow] = outside[narrow] * _narrow_fall(far[narrow], near[narrow])
    return np.asarray(0.25 * np.sqrt(np.pi) * result / p)


def _from(p: Matrix, q: Vector, t: Matrix) -> Matrix:
    """Return the integral of ``exp(-(p x)^2 - (q / x)^2)`` over x from t to infinity."""
    near, far = p * t, q / np.maximum(t, 1e-12)
    outside = np.exp(-np.square(far) - np.square(near))
    ahead = near - far
    large = np.where(
        ahead > 0.0,
        outside * erfcx(np.maximum(ahead, 0.0)),
        np.exp(-2.0 * p * q) * erfc(ahead),
    )
    return np.asarray(0.25 * np.sqrt(np.pi) * (large + outside * erfcx(near + far)) / p)


def _between(low: Vector, high: Vector) -> Vector:
    """Return the probability between two limits, 0 where they are not in order."""
    flip = low + high < 0.0
    low, high = np.where(flip, -high, low), np.where(flip, -low, high)
    result = np.maximum(ndtr(-low) - ndtr(-high), 0.0)
    half = (high - low) / np.sqrt(8.0)
    narrow = (half > 0.0) & (half < _NARROW)
    if not narrow.any():
        return result
    low, high, half = low[narrow], high[narrow], half[narrow]
    fall = _narrow_fall((low + high) / np.sqrt(8.0), half)
    slope = -np.expm1(-0.5 * (high - low) * (high + low))
    tail = erfcx(high / np.sqrt(2.0))
    result[narrow] = 0.5 * np.exp(-0.5 * np.square(low)) * (fall + tail * slope)
    return result


def _narrow_fall(x: Vector, half: Vector) -> Vector:
    """Return ``erfcx(x - half) - erfcx(x + half)`` for small half widths, without cancellation."""
    # Further out the callers' factor exp(-x^2) is zero.
    x = np.minimum(x, 50.0)
    value = erfcx(x)
    first = 2.0 * x * value - 2.0 / np.sqrt(np.pi)
    second = 2.0 * value + 2.0 * x * first
    third = 4.0 * first + 2.0 * x * second
    return np.asarray(-2.0 * half * (first + np.square(half) / 6.0 * third))
