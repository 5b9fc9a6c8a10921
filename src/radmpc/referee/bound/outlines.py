"""Outlines of sets in standard coordinates, and a Gaussian's integral along a piece of one.

What is summed, and why the errors are bounds, says `radmpc.referee.bound.contour`.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from scipy.special import log_ndtr, ndtr

from radmpc.arrays import Indices, Matrix, Vector
from radmpc.records import dataclass

__all__ = ["Local", "Outlines", "Truths"]

Truths = npt.NDArray[np.bool_]

_NUM_NODES = 20
"""Nodes of the Gauss-Legendre rule on a piece, for speed only: rules of 12 to 24 nodes, on ellipses
of 2 to 9, took up to 1.5 times as long on 300 discs, boxes and hulls."""

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(_NUM_NODES)

_ELLIPSES = np.array([[3.0], [6.0]])
"""Sums of the half axes of the ellipses to bound the error on [-]: short pieces like large ones."""

_AXES = 0.5 * (_ELLIPSES + 1.0 / _ELLIPSES), 0.5 * (_ELLIPSES - 1.0 / _ELLIPSES)
_FACTORS = 64.0 / 15.0 * _ELLIPSES ** (-2 * _NUM_NODES) / (1.0 - _ELLIPSES**-2)


@dataclass(frozen=True, slots=True, eq=False)
class Outlines:
    """Elements of closed outlines: ``z = place + u slope + cos(u) even + sin(u) odd``.

    Lines have no even and odd, arcs no slope; z are standard coordinates, which ``turn`` rotates
    to s across and t ahead.

    Attributes
    ----------
    site : (E,) array
        Whose outline it is.
    place, slope, even, odd : (E, 2) arrays
        Coefficients [deviations].
    curved : (E,) array
        Which are arcs.
    turn : (S, 2) array
        Unit vectors ahead, per site: ``t = turn . z``.
    """

    site: Indices
    place: Matrix
    slope: Matrix
    even: Matrix
    odd: Matrix
    curved: Truths
    turn: Matrix

    def reach(self) -> Vector:
        """Return what the sizes of all coefficients sum to, per element."""
        parts = np.abs(self.place) + np.abs(self.slope) + np.abs(self.even) + np.abs(self.odd)
        return np.asarray(parts.sum(axis=1))

    def expand(self, element: Indices, u: Vector) -> Local:
        """Return s and t and their derivatives at u.

        Parameters
        ----------
        element : (P,) int array
            Elements of the outline.
        u : (P,) array
            Parameter on each.
        """
        cos, sin = np.cos(u)[:, None], np.sin(u)[:, None]
        even, odd, slope = self.even[element], self.odd[element], self.slope[element]
        bend = cos * even + sin * odd
        vectors = np.empty((3, *bend.shape))
        vectors[0] = self.place[element] + u[:, None] * slope + bend
        vectors[1] = slope + cos * odd - sin * even
        vectors[2] = -bend
        ahead = self.turn[self.site[element]]
        parts = np.empty((3, 2, len(bend)))
        parts[:, 0] = ahead[:, 1] * vectors[..., 0] - ahead[:, 0] * vectors[..., 1]
        parts[:, 1] = ahead[:, 0] * vectors[..., 0] + ahead[:, 1] * vectors[..., 1]
        return Local(parts.reshape(6, -1), self.curved[element])


@dataclass(frozen=True, slots=True, eq=False)
class Local:
    """Middles of pieces: ``s + s1 sin(w) + s2 (1 - cos(w))`` at w from there, or ``s + s1 w``.

    Attributes
    ----------
    numbers : (6, P) array
        s, t, s1, t1, s2 and t2 [deviations].
    curved : (P,) array
        Which are on arcs.
    """

    numbers: Matrix
    curved: Truths

    def largest(self, half: Vector) -> tuple[Vector, Vector]:
        """Return bounds on ``phi(s) Q(t)`` and on the size of its integral for ``|w| <= half``.

        Parameters
        ----------
        half : (P,) array
            How far pieces reach to either side.
        """
        s, t, s1, t1, s2, t2 = self.numbers
        odd = np.where(self.curved, np.sin(np.minimum(half, 0.5 * np.pi)), half)
        even = 2.0 * np.square(np.sin(0.5 * half))
        low = s - np.abs(s1) * odd + np.minimum(s2, 0.0) * even
        high = s + np.abs(s1) * odd + np.maximum(s2, 0.0) * even
        nearest = np.maximum(np.maximum(low, -high), 0.0)
        lowest = t - np.abs(t1) * odd + np.minimum(t2, 0.0) * even
        length = 2.0 * half * (np.abs(s1) + np.abs(s2) * odd)
        peak = np.exp(-0.5 * np.square(nearest)) * ndtr(-lowest) / np.sqrt(2.0 * np.pi)
        return peak, length * peak

    def rule_error(self, half: Vector) -> Vector:
        """Return bounds on the error of the Gauss rule over ``|w| <= half``.

        Parameters
        ----------
        half : (P,) array
            How far pieces reach to either side.
        """
        s, t, s1, t1, s2, t2 = self.numbers
        s, s1, s2, t1, t2 = np.abs([s, s1, s2, t1, t2])
        real, imaginary = half * _AXES[0], half * _AXES[1]
        # |sin w| <= sinh |w| and |1 - cos w| <= cosh |w| - 1; the imaginary parts of both are
        # at most sinh |Im w| times 1 and sin |Re w|. Of w itself, on lines, all the more.
        odd, even, aside = np.sinh(real), np.cosh(real) - 1.0, np.sinh(imaginary)
        bent = np.minimum(real, 1.0) * aside
        nearest = np.maximum(s - s1 * odd - s2 * even, 0.0)
        lowest = t - t1 * odd - t2 * even
        exponent = log_ndtr(-lowest) - 0.5 * np.square(nearest)
        exponent += 0.5 * np.square(s1 * aside + s2 * bent)
        exponent += 0.5 * np.square(t1 * aside + t2 * bent)
        speed = half * (s1 * (even + 1.0) + s2 * odd) / np.sqrt(2.0 * np.pi)
        errors = _FACTORS * speed * np.exp(np.minimum(exponent, 600.0))
        return np.asarray(errors.min(axis=0))

    def integral(self, half: Vector) -> Vector:
        """Return the Gauss rule over ``|w| <= half``.

        Parameters
        ----------
        half : (P,) array
            How far pieces reach to either side.
        """
        s, t, s1, t1, s2, t2 = self.numbers
        # Nodes are symmetric: sines and cosines of one half will do.
        w = half * _NODES[_NUM_NODES // 2 :, None]
        sin = np.sin(0.5 * w)
        even = np.where(self.curved, 2.0 * np.square(sin), 0.0)
        odd = np.where(self.curved, 2.0 * sin * np.sqrt((1.0 - sin) * (1.0 + sin)), w)
        odd = np.concatenate([-odd[::-1], odd])
        even = np.concatenate([even[::-1], even])
        at_s = s + s1 * odd + s2 * even
        at_t = t + t1 * odd + t2 * even
        heights = np.exp(-0.5 * np.square(at_s)) * ndtr(-at_t)
        heights *= s1 * (1.0 - even) + s2 * odd
        return np.asarray(half * (_WEIGHTS @ heights) / np.sqrt(2.0 * np.pi))
