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

Pieces are parted until these bounds are small. Every stage is an upper bound of the probability.
"""

from __future__ import annotations

from typing import Self

import numpy as np

from radmpc.arrays import Indices, Matrix, Vector
from radmpc.records import dataclass
from radmpc.referee.bound.outlines import Local, Outlines, Truths

__all__ = ["enclosed"]

_REL_TOL, _TINY = 1e-6, 1e-300
"""Sum of all error bounds at which a site is done [-]: relative to its probability, absolute."""

_HALVINGS, _MOST_PIECES = 40, 2000
"""Halvings of a piece (1e7 deviations of outline need 24), and pieces of a site, beyond which it is
left as it is."""

_FEW_PIECES, _MANY_PARTS = 32, 8
"""Pieces up to which each is cut into eight at once instead of two, as by three halvings [-]: few
take as long as one, and mostly need as many."""

_PROMISE = 0.1
"""Error bound, over the tolerance and the integral's size [-], to integrate a piece at once."""

_ROUNDING = 5e-13
"""Relative error of a sum of tails [-]: 2e3 last places, most of them from 30 deviations out."""

_JUMP = 16.0 * float(np.finfo(float).eps)
"""Share of their coordinates [-] by which rounding can tear the ends of pieces apart. The outline
is closed by jumps across, which are charged at the largest integrand of the piece."""


_MIDDLE, _HALF, _VALUE, _SLACK, _ERROR, _PEAK, _SIZE = range(7)
"""Rows of what is known of pieces."""


@dataclass(frozen=True, slots=True, eq=False)
class _Pieces:
    """Pieces of elements and what is known of their integrals: within value ± slack.

    Those that slack leaves loose are rated before they are integrated.

    The rows of `numbers` are `_MIDDLE`, `_HALF`, `_VALUE`, `_SLACK`, `_ERROR`, `_PEAK`, `_SIZE`,
    then those of `Local` at the middle: one array is chosen from and joined at once.
    """

    element: Indices
    curved: Truths
    fresh: Truths
    numbers: Matrix

    @classmethod
    def cut(cls, outlines: Outlines, element: Indices, begin: Vector, end: Vector) -> Self:
        """Return pieces of elements, not integrated yet, nor with the error of the rule."""
        middle, half = 0.5 * (begin + end), 0.5 * (end - begin)
        local = outlines.expand(element, middle)
        peak, size = local.largest(half)
        nothing = np.zeros_like(half)
        own = [middle, half, nothing, size, nothing, peak, size]
        numbers = np.concatenate([own, local.numbers])
        return cls(element, local.curved, np.ones(len(half), dtype=bool), numbers)

    def parted(self, outlines: Outlines, count: int) -> Self:
        """Return so many equal parts of each, not integrated yet."""
        middle, half = self.numbers[:2]
        ends = middle + half * np.linspace(-1.0, 1.0, count + 1)[:, None]
        element = np.tile(self.element, count)
        return type(self).cut(outlines, element, ends[:-1].ravel(), ends[1:].ravel())

    def rated(self) -> Self:
        """Return the same with bounds on the error of the rule.

        Four of five pieces are so small that none is asked for, and they take as long as the rest.
        """
        numbers = self.numbers.copy()
        local = Local(numbers[_SIZE + 1 :], self.curved)
        numbers[_ERROR] = local.rule_error(numbers[_HALF])
        return type(self)(self.element, self.curved, self.fresh, numbers)

    def integrated(self) -> Self:
        """Return the same with their integrals."""
        numbers = self.numbers.copy()
        local = Local(numbers[_SIZE + 1 :], self.curved)
        numbers[_VALUE] = local.integral(numbers[_HALF])
        numbers[_SLACK] = numbers[_ERROR]
        return type(self)(self.element, self.curved, np.zeros_like(self.fresh), numbers)

    def take(self, chosen: Truths) -> Self:
        """Return some of them."""
        places = chosen.nonzero()[0]
        kinds = self.element[places], self.curved[places], self.fresh[places]
        return type(self)(*kinds, self.numbers[:, places])

    def joined(self, *others: Self) -> Self:
        """Return these and others."""
        parts = (self, *others)
        return type(self)(
            np.concatenate([part.element for part in parts]),
            np.concatenate([part.curved for part in parts]),
            np.concatenate([part.fresh for part in parts]),
            np.concatenate([part.numbers for part in parts], axis=1),
        )


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
    # Pieces parted more often than numbers have digits would have no length, and nothing inside.
    halvings = _HALVINGS
    while halvings > 0:
        site = outlines.site[pieces.element]
        allowed = _allowed(pieces, site, num_sites)
        loose = pieces.numbers[_SLACK] > allowed[site]
        if not loose.any():
            break
        kept, poor = pieces.take(~loose), pieces.take(loose).rated()
        ready = poor.fresh & _promising(poor, allowed[site[loose]])
        is_quick = halvings >= 3 and np.sum(~ready) <= _FEW_PIECES
        count, taken = (_MANY_PARTS, 3) if is_quick else (2, 1)
        parts, halvings = poor.take(~ready).parted(outlines, count), halvings - taken
        parts, limit = parts.rated(), allowed[outlines.site[parts.element]]
        soon = (parts.numbers[_SLACK] > limit) & _promising(parts, limit)
        whole = poor.take(ready).joined(parts.take(soon)).integrated()
        pieces = kept.joined(parts.take(~soon), whole)
    site = outlines.site[pieces.element]
    jumps = _JUMP * outlines.reach()[pieces.element] * pieces.numbers[_PEAK]
    sums = (
        pieces.numbers[_VALUE] + pieces.numbers[_SLACK] + jumps + _ROUNDING * pieces.numbers[_SIZE]
    )
    return _total(site, sums, num_sites)


def _allowed(pieces: _Pieces, site: Indices, num_sites: int) -> Vector:
    """Return the slack that a piece may keep, per site; infinite where nothing need be done."""
    count = np.bincount(site, minlength=num_sites)
    size = _total(site, np.abs(pieces.numbers[_VALUE]), num_sites)
    # Before anything is integrated the largest piece stands for the whole.
    guess = np.zeros(num_sites)
    np.maximum.at(guess, site, 1e-3 * pieces.numbers[_SLACK])
    share = np.where(
        size > 0.0, np.maximum(_total(site, pieces.numbers[_VALUE], num_sites), 0.0), guess
    )
    goal = np.maximum(_REL_TOL * share, 1e-15 * size) + _TINY
    done = (_total(site, pieces.numbers[_SLACK], num_sites) <= goal) | (count > _MOST_PIECES)
    return np.where(done, np.inf, 0.5 * goal / np.maximum(count, 1))


def _promising(pieces: _Pieces, allowed: Vector) -> Truths:
    """Return whether the rule would be good enough for what is known so far."""
    error, slack = pieces.numbers[_ERROR], pieces.numbers[_SLACK]
    return np.asarray(error <= np.maximum(allowed, _PROMISE * _REL_TOL * slack))


def _total(site: Indices, values: Vector, num_sites: int) -> Vector:
    """Return sums per site."""
    return np.asarray(np.bincount(site, values, num_sites), dtype=float)
