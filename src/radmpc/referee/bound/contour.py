r"""Gaussian probabilities as integrals along outlines, with a proven error.

In coordinates (s, t) that make a planar Gaussian standard, Green's theorem gives for a set inside a
closed outline, counter-clockwise,

.. math:: \Pr = \oint \varphi(s)\,Q(t)\,ds.

Outlines are straight lines and arcs of circles; s, t and the integrand f are entire functions of
the place along them. On a piece, mapped to [-1, 1], the N-point Gauss-Legendre rule errs by at most

.. math:: \frac{64}{15}\,\frac{M\,\varrho^{-2N}}{1 - \varrho^{-2}}, \qquad
    M = \max |f| \text{ inside the ellipse } E_\varrho

with foci ±1 and semi-axes (ϱ ± 1/ϱ)/2, for any ϱ > 1: the Chebyshev coefficients of f are at most
:math:`2 M \varrho^{-k}`, and the rule is exact for k < 2N and for odd k, and errs by at most
2 + 2/(k² - 1) for even ones (Rabinowitz 1969; Trefethen, Approximation Theory and Approximation
Practice, chapter 19). M is bounded by

.. math:: |\varphi(s)| = \varphi(\Re s)\,e^{(\Im s)^2 / 2}, \qquad
    |Q(t)| \le Q(\Re t)\,e^{(\Im t)^2 / 2}.

Pieces are halved until these bounds are small. Every stage is an upper bound of the probability.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Self

import numpy as np
import numpy.typing as npt
from scipy.special import log_ndtr, ndtr

from radmpc.arrays import Indices, Matrix, Vector, field_names

__all__ = ["Outlines", "enclosed"]

Truths = npt.NDArray[np.bool_]

_NUM_NODES = 20
"""Nodes of the Gauss-Legendre rule on a piece, for speed only: rules of 12 to 24 nodes, on ellipses
of 2 to 9, took up to 1.5 times as long on 300 discs, boxes and hulls."""

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(_NUM_NODES)

_ELLIPSES = (3.0, 6.0)
"""Sums of the half axes of the ellipses to bound the error on [-]: short pieces like large ones."""

_REL_TOL, _TINY = 1e-6, 1e-300
"""Sum of all error bounds at which a site is done [-]: relative to its probability, absolute."""

_ROUNDS, _MOST_PIECES = 40, 2000
"""Halvings (1e7 deviations of outline need 24) and pieces beyond which a site is left as it is."""

_PROMISE = 0.1
"""Error bound, over the tolerance and the integral's size [-], to integrate a piece at once."""

_ROUNDING = 5e-13
"""Relative error of a sum of tails [-]: 2e3 last places, most of them from 30 deviations out."""

_JUMP = 16.0 * float(np.finfo(float).eps)
"""Share of their coordinates [-] by which rounding can tear the ends of pieces apart. The outline
is closed by jumps across, which are charged at the largest integrand of the piece."""


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

    def expand(self, element: Indices, u: Vector) -> _Local:
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
        ahead = self.turn[self.site[element]]
        place = _turned(ahead, self.place[element] + u[:, None] * slope + bend)
        first = _turned(ahead, slope + cos * odd - sin * even)
        second = _turned(ahead, -bend)
        return _Local(*place, *first, *second, curved=self.curved[element])


@dataclass(frozen=True, slots=True, eq=False)
class _Local:
    """Middles of pieces: ``s + s1 sin(w) + s2 (1 - cos(w))`` at w from there, or ``s + s1 w``."""

    s: Vector
    t: Vector
    s1: Vector
    t1: Vector
    s2: Vector
    t2: Vector
    curved: Truths

    def largest(self, half: Vector) -> tuple[Vector, Vector]:
        """Return bounds on ``phi(s) Q(t)`` and on the size of its integral for ``|w| <= half``."""
        odd = np.where(self.curved, np.sin(np.minimum(half, 0.5 * np.pi)), half)
        even = 2.0 * np.square(np.sin(0.5 * half))
        low = self.s - np.abs(self.s1) * odd + np.minimum(self.s2, 0.0) * even
        high = self.s + np.abs(self.s1) * odd + np.maximum(self.s2, 0.0) * even
        nearest = np.maximum(np.maximum(low, -high), 0.0)
        lowest = self.t - np.abs(self.t1) * odd + np.minimum(self.t2, 0.0) * even
        length = 2.0 * half * (np.abs(self.s1) + np.abs(self.s2) * odd)
        peak = np.exp(-0.5 * np.square(nearest)) * ndtr(-lowest) / np.sqrt(2.0 * np.pi)
        return peak, length * peak

    def rule_error(self, half: Vector) -> Vector:
        """Return bounds on the error of the Gauss rule over ``|w| <= half``."""
        result = np.full(len(half), np.inf)
        s1, s2, t1, t2 = (np.abs(each) for each in (self.s1, self.s2, self.t1, self.t2))
        for size in _ELLIPSES:
            real, imaginary = 0.5 * half * (size + 1.0 / size), 0.5 * half * (size - 1.0 / size)
            # |sin w| <= sinh |w| and |1 - cos w| <= cosh |w| - 1; the imaginary parts of both are
            # at most sinh |Im w| times 1 and sin |Re w|. Of w itself, on lines, all the more.
            odd, even, aside = np.sinh(real), np.cosh(real) - 1.0, np.sinh(imaginary)
            bent = np.minimum(real, 1.0) * aside
            nearest = np.maximum(np.abs(self.s) - s1 * odd - s2 * even, 0.0)
            lowest = self.t - t1 * odd - t2 * even
            exponent = log_ndtr(-lowest) - 0.5 * np.square(nearest)
            exponent += 0.5 * np.square(s1 * aside + s2 * bent)
            exponent += 0.5 * np.square(t1 * aside + t2 * bent)
            speed = half * (s1 * (even + 1.0) + s2 * odd) / np.sqrt(2.0 * np.pi)
            factor = 64.0 / 15.0 * size ** (-2 * _NUM_NODES) / (1.0 - size**-2)
            result = np.minimum(result, factor * speed * np.exp(np.minimum(exponent, 600.0)))
        return result

    def integral(self, half: Vector) -> Vector:
        """Return the Gauss rule over ``|w| <= half``."""
        # Nodes are symmetric: sines and cosines of one half will do.
        w = half * _NODES[_NUM_NODES // 2 :, None]
        sin = np.sin(0.5 * w)
        even = np.where(self.curved, 2.0 * np.square(sin), 0.0)
        odd = np.where(self.curved, 2.0 * sin * np.sqrt((1.0 - sin) * (1.0 + sin)), w)
        odd = np.concatenate([-odd[::-1], odd])
        even = np.concatenate([even[::-1], even])
        s = self.s + self.s1 * odd + self.s2 * even
        t = self.t + self.t1 * odd + self.t2 * even
        heights = np.exp(-0.5 * np.square(s)) * ndtr(-t)
        heights *= self.s1 * (1.0 - even) + self.s2 * odd
        return np.asarray(half * (_WEIGHTS @ heights) / np.sqrt(2.0 * np.pi))


@dataclass(frozen=True, slots=True, eq=False)
class _Pieces:
    """Pieces of elements and what is known of their integrals: within ``value ± slack``."""

    element: Indices
    middle: Vector
    half: Vector
    value: Vector
    slack: Vector
    error: Vector
    peak: Vector
    size: Vector
    fresh: Truths

    @classmethod
    def cut(cls, outlines: Outlines, element: Indices, begin: Vector, end: Vector) -> Self:
        """Return pieces of elements, not integrated yet."""
        middle, half = 0.5 * (begin + end), 0.5 * (end - begin)
        local = outlines.expand(element, middle)
        peak, size = local.largest(half)
        return cls(
            element=element,
            middle=middle,
            half=half,
            value=np.zeros(len(half)),
            slack=size,
            error=local.rule_error(half),
            peak=peak,
            size=size,
            fresh=np.ones(len(half), dtype=bool),
        )

    def halved(self, outlines: Outlines) -> Self:
        """Return both halves of each, not integrated yet."""
        begin, end = self.middle - self.half, self.middle + self.half
        element = np.concatenate([self.element, self.element])
        begin, end = np.concatenate([begin, self.middle]), np.concatenate([self.middle, end])
        return type(self).cut(outlines, element, begin, end)

    def integrated(self, outlines: Outlines) -> Self:
        """Return the same with their integrals."""
        value = outlines.expand(self.element, self.middle).integral(self.half)
        fresh = np.zeros(len(value), dtype=bool)
        return replace(self, value=value, slack=self.error, fresh=fresh)

    def take(self, chosen: Truths) -> Self:
        """Return some of them."""
        # Masks are slower than places for nine short arrays.
        places = np.flatnonzero(chosen)
        return type(self)(*(getattr(self, name)[places] for name in field_names(type(self))))

    def joined(self, *others: Self) -> Self:
        """Return these and others."""
        parts, names = (self, *others), field_names(type(self))
        return type(self)(*(np.concatenate([getattr(p, name) for p in parts]) for name in names))


def enclosed(
    outlines: Outlines, element: Indices, begin: Vector, end: Vector, num_sites: int
) -> Vector:
    """Return upper bounds on the probability inside each site's outline.

    Parameters
    ----------
    outlines : Outlines
        Elements of the outlines, each counter-clockwise.
    element, begin, end : (P,) arrays
        First pieces, which together make up the outlines: any cut is valid, and a good one is fast.
    num_sites : int
        Number of sites.

    Returns
    -------
    (num_sites,) array
        Integrals plus all error bounds.
    """
    pieces = _Pieces.cut(outlines, element, begin, end)
    for _ in range(_ROUNDS):
        site = outlines.site[pieces.element]
        allowed = _allowed(pieces, site, num_sites)
        loose = pieces.slack > allowed[site]
        if not loose.any():
            break
        kept, poor = pieces.take(~loose), pieces.take(loose)
        ready = poor.fresh & _promising(poor, allowed[site[loose]])
        halves = poor.take(~ready).halved(outlines)
        limit = allowed[outlines.site[halves.element]]
        soon = (halves.slack > limit) & _promising(halves, limit)
        whole = poor.take(ready).joined(halves.take(soon)).integrated(outlines)
        pieces = kept.joined(halves.take(~soon), whole)
    site = outlines.site[pieces.element]
    jumps = _JUMP * outlines.reach()[pieces.element] * pieces.peak
    sums = pieces.value + pieces.slack + jumps + _ROUNDING * pieces.size
    return _total(site, sums, num_sites)


def _allowed(pieces: _Pieces, site: Indices, num_sites: int) -> Vector:
    """Return the slack that a piece may keep, per site; infinite where nothing need be done."""
    count = np.bincount(site, minlength=num_sites)
    size = _total(site, np.abs(pieces.value), num_sites)
    # Before anything is integrated the largest piece stands for the whole.
    guess = np.zeros(num_sites)
    np.maximum.at(guess, site, 1e-3 * pieces.slack)
    share = np.where(size > 0.0, np.maximum(_total(site, pieces.value, num_sites), 0.0), guess)
    goal = np.maximum(_REL_TOL * share, 1e-15 * size) + _TINY
    done = (_total(site, pieces.slack, num_sites) <= goal) | (count > _MOST_PIECES)
    return np.where(done, np.inf, 0.5 * goal / np.maximum(count, 1))


def _promising(pieces: _Pieces, allowed: Vector) -> Truths:
    """Return whether the rule would be good enough for what is known so far."""
    return pieces.error <= np.maximum(allowed, _PROMISE * _REL_TOL * pieces.slack)


def _total(site: Indices, values: Vector, num_sites: int) -> Vector:
    """Return sums per site."""
    return np.asarray(np.bincount(site, values, num_sites), dtype=float)


def _turned(ahead: Matrix, vectors: Matrix) -> tuple[Vector, Vector]:
    """Return the parts of vectors across and ahead, right-handed."""
    across = ahead[:, 1] * vectors[:, 0] - ahead[:, 0] * vectors[:, 1]
    return across, ahead[:, 0] * vectors[:, 0] + ahead[:, 1] * vectors[:, 1]
