r"""Probability of leaving a half-space, and the direction that makes it small.

A convex set P grown by a radius r lies in ``n·y <= c(n) = max over P of n·y + r`` for every unit
n. A vehicle that keeps ``n·x >= c(n)`` does not touch it, so for a Gaussian x and *any* n

.. math:: \Pr[x \in P \oplus B_r] \le Q\left(
          \frac{n^\top \bar x - c(n)}{\sqrt{n^\top \Sigma n}}\right).

Search for n may therefore stop anywhere: it makes the bound tight, never wrong.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from radmpc.arrays import Indices, Matrix, Tensor, Vector
from radmpc.referee.reserve import held, in_deviations, reserves
from radmpc.referee.sites import Chords, Sites, chords, over_ends
from radmpc.referee.tails import exceeding

__all__ = [
    "clearances",
    "end_margins",
    "end_risks",
    "refine",
    "shared_risks",
    "unit",
]

_NEGLIGIBLE = 1e-15
"""Risk at equal shares of the reserve below which no other is tried [-]."""

_EXCESS = 1e-12
"""What a half-space that fails counts more per deviation that it does so by [-]. Beyond 8 of them
tails are 1 to the last bit, and of directions that are equally bad the first listed was taken:
turning a scene by a right angle changed single encounters by up to a third."""

_MOST_EXCESS = 1e3
"""Deviations up to which that is counted."""

_ROUNDS = 5
"""Rounds of the search over whole intervals: nine find less than 0.1 % better chains of parts."""

_FIRST_STEP = 0.4
"""Step of the first round, as a share of the direction's length [-]."""

_SHRINK = 0.4
"""Factor of the step from round to round [-]."""


def end_risks(sites: Sites, directions: Tensor, shares: Tensor | float = 0.5) -> Tensor:
    """Return the probability that each half-space fails at each end.

    Parameters
    ----------
    sites : Sites
        S sites with E ends.
    directions : (S, C, d) array
        Unit normals that point away from the set [-].
    shares : (S, C) array or float
        θ, see `end_margins`.

    Returns
    -------
    (S, C, E) array
        ``Q(q)``; without noise exactly 0 or 1.
    """
    return exceeding(clearances(sites, directions, shares), sites.samples)


def shared_risks(sites: Sites, directions: Tensor) -> Tensor:
    """Return `end_risks` at the share of the reserve that costs each direction least.

    Where a vehicle starts at contact, the one direction that holds does so at its own share only.
    Directions that fail for certain are told apart by how far they do: a search would take any.

    Parameters
    ----------
    sites : Sites
        S of E ends each.
    directions : (S, C, d) array
        Unit normals of half-spaces.
    """
    seen = chords(sites, directions)
    levels = in_deviations(seen.margins - seen.sagittas[:, :, None], seen.deviations)
    risks = exceeding(levels, sites.samples)
    bowed = (seen.sagittas > 0.0) & (over_ends(risks) > _NEGLIGIBLE)
    if bowed.any():
        ends = seen.margins[bowed], seen.deviations[bowed], seen.sagittas[bowed]
        levels[bowed], _ = held(sites.is_near, *ends, sites.samples)
        risks[bowed] = exceeding(levels[bowed], sites.samples)
    risks += _EXCESS * np.minimum(np.maximum(-levels, 0.0), _MOST_EXCESS)
    return risks


def clearances(sites: Sites, directions: Tensor, shares: Tensor | float = 0.5) -> Tensor:
    """Return the margins of `end_margins` in standard deviations, (S, C, E).

    Without noise ±inf: touching, up to rounding, is no collision.

    Parameters
    ----------
    sites : Sites
        S of E ends each.
    directions : (S, C, d) array
        Unit normals of half-spaces.
    shares : (S, C) array or float
        Share θ of the reserve that the near end keeps.
    """
    seen = chords(sites, directions)
    return in_deviations(_less_reserves(sites, seen, shares), seen.deviations)


def end_margins(sites: Sites, directions: Tensor, shares: Tensor | float = 0.5) -> Tensor:
    """Return how far the means are from failing each half-space at each end.

    The mean curve deviates from its chord by ``4 s (1 − s) b``, b at most ``max(0, n·sagitta)``.
    Margins m₀ and m₁ of the chord's ends are enough in between if, for some share θ in [0, 1],
    ``m₀`` is at least ``4 b θ²`` and ``m₁`` at least ``4 b (1 − θ)²``.

    Parameters
    ----------
    sites : Sites
        S sites with E ends.
    directions : (S, C, d) array
        Unit normals that point away from the set [-].
    shares : (S, C) array or float
        The near ends' share θ of the reserve for the sagitta; any is valid.

    Returns
    -------
    (S, C, E) array
        ``n·x̄ − max n·P − r − reserve``; a collision needs a deviation along −n that exceeds it at
        some end [m].
    """
    return _less_reserves(sites, chords(sites, directions), shares)


def _less_reserves(sites: Sites, seen: Chords, shares: Tensor | float) -> Tensor:
    """Return the margins of chords less the reserve for the sagitta, (S, C, E)."""
    if not seen.sagittas.any():
        return seen.margins
    return np.asarray(seen.margins - reserves(sites.is_near, seen.sagittas, shares))


def unit(vectors: Tensor) -> Tensor:
    """Return vectors scaled to length one; zero becomes the first axis."""
    lengths = np.sqrt(over_ends(np.square(vectors)))[..., None]
    good = np.isfinite(lengths) & (lengths > 1e-150)
    if good.all():
        return np.asarray(vectors / lengths)
    axis = np.zeros(vectors.shape[-1])
    axis[0] = 1.0
    return np.where(good, vectors / np.where(good, lengths, 1.0), axis)


def refine(
    sites: Sites,
    directions: Matrix,
    score: Callable[[Tensor], Tensor],
    leaders: Indices | None = None,
) -> tuple[Matrix, Vector]:
    """Turn each direction downhill: a pattern search over the sphere, all sites at once.

    At one end the clearance is a concave over a convex function of n, both homogeneous, so it has
    no local maximum but the global one while the mean is outside. In space it has ridges, where
    the set is touched along an edge: normals at right angles to the edge. They are followed by
    moves of their own.

    Parameters
    ----------
    sites : Sites
        S sites.
    directions : (S, d) array
        Where to start.
    score : callable
        From the risks of P directions at each site's ends, (S, P, E), to what is to be small,
        (S, P). Sites that turn together start alike and score alike.
    leaders : (S,) int array or None
        The site whose edges each follows: those that turn together must try the same directions.

    Returns
    -------
    directions : (S, d) array
        Where the search ended.
    scores : (S,) array
        Never above those at the start.
    """
    pattern = _pattern(directions.shape[1])
    edges = sites.edges[:, 0] if leaders is None else sites.edges[leaders, 0]
    ridges = unit(edges[:, :, 1] - edges[:, :, 0])
    best = directions.copy()
    lowest = score(shared_risks(sites, best[:, None]))[:, 0]
    rows = np.arange(len(best))
    step = _FIRST_STEP
    for _ in range(_ROUNDS):
        offsets = np.einsum("pt,std->spd", pattern, _tangents(best))
        trial = unit(best[:, None, :] + step * offsets)
        if ridges.shape[1]:
            trial = np.concatenate([trial, _along_ridges(best, ridges, step)], axis=1)
        found = score(shared_risks(sites, trial))
        choice = found.argmin(axis=1)
        better = found[rows, choice] < lowest
        best[better] = trial[rows, choice][better]
        lowest[better] = found[rows, choice][better]
        step *= _SHRINK
    return best, lowest


def _along_ridges(normals: Matrix, ridges: Tensor, step: float) -> Tensor:
    """Return normals moved onto each ridge and a little along it."""
    on_ridge = np.einsum("sd,srd->sr", normals, ridges)[:, :, None] * ridges
    feet = unit(normals[:, None, :] - on_ridge)
    onward = np.cross(ridges, feet)
    moves = [feet + step * share * onward for share in (-1.0, -0.5, 0.0, 0.5, 1.0)]
    return unit(np.concatenate(moves, axis=1))


def _pattern(dimension: int) -> Matrix:
    """Return the moves to try, in tangent coordinates."""
    if dimension == 2:
        return np.array([[-1.0], [-0.5], [-0.25], [0.25], [0.5], [1.0]])
    angles = np.arange(8) * np.pi / 4.0
    ring = np.column_stack([np.cos(angles), np.sin(angles)])
    return np.vstack([ring, 0.5 * ring])


def _tangents(normals: Matrix) -> Tensor:
    """Return an orthonormal basis of each tangent plane, (S, d-1, d)."""
    if normals.shape[1] == 2:
        return np.stack([-normals[:, 1], normals[:, 0]], axis=1)[:, None, :]
    helper = np.eye(3)[np.abs(normals).argmin(axis=1)]
    first = unit(np.cross(normals, helper))
    return np.stack([first, np.cross(normals, first)], axis=1)
