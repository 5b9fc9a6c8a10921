"""Upper bounds on the risk of encounters along intervals: chains of half-spaces, where they tell.

Of a long flight few intervals bring two vehicles near each other. Each interval is first charged by
itself; then a chain of half-spaces, over whole intervals or parts of them, is sought for those that
make up the risk, and the others stay charged as they are (Boole's inequality).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial

import numpy as np
import numpy.typing as npt

from radmpc.arrays import Indices, Matrix, Tensor, Vector
from radmpc.referee.bound.chain import chain_charges, cheapest_chain, run_scores
from radmpc.referee.bound.halfspace import refine, shared_risks
from radmpc.referee.bound.persistence import least_risks
from radmpc.referee.bound.search import away, best_directions, cheapest
from radmpc.referee.encounters import Encounters, blocks, interval_sites
from radmpc.referee.motion import FleetMotion
from radmpc.referee.sites import Sites

__all__ = [
    "LARGE",
    "LARGE_IN_SPANS",
    "TELLING",
    "WORTH",
    "alone_risks",
    "chained",
    "has_spans",
    "interval_risks",
    "is_curved",
    "spans_that_tell",
]

WORTH = 1e-13
"""Sum of an encounter below which its intervals are not looked at in parts [-]."""

TELLING = 1e-8
"""Share of the sum of all encounters of its kind below which one is charged as it is [-]."""

_APART = 1e-24
"""Risk across the line to the middle of a set below which no other half-space is tried in an
interval [-]: all such of a thousand vehicles among a hundred obstacles add up to nothing."""

_MANY = 100
"""Encounters from which on that is looked for [-]: with the 28 pairs of `paper(8)` it takes 3 %
longer, with those of `fleet(64)` a fifth less."""

_SPAN = 8
"""Intervals of an encounter that are looked at are a multiple of so many [-]; horizons shorter than
twice that are looked at as a whole."""

LARGE_IN_SPANS = 0.01
"""The same share as `LARGE` where only intervals are looked at that tell: they are few."""

_FAINT = 1e-3
"""Share of an encounter's sum that all intervals at its ends may have that are charged as they
are [-]."""

LARGE = 0.1
"""Share of the sum of all encounters of its kind from which on one is looked at in many parts."""

Flags = npt.NDArray[np.bool_]

Span = tuple[Indices, Indices, int]
"""Some encounters, the first interval of each that is looked at, and how many."""

Spans = Callable[[Matrix], Iterator[Span]]
"""Chooses them by the risk of each interval alone, (B, K)."""


def interval_risks(
    encounters: Encounters, motion: FleetMotion, *, is_rough: bool = False
) -> Matrix:
    """Return an upper bound on the probability of each encounter's collision, by step, (B, T+1).

    Parameters
    ----------
    encounters : Encounters
        B of them.
    motion : FleetMotion
        What they were gathered from.
    is_rough : bool
        Whether each interval is charged by itself, in a fraction of the time.
    """
    if is_rough:
        return _each_alone(encounters)[-1]
    if has_spans(encounters, motion):
        return _charged(encounters, motion, spans_that_tell)
    return np.concatenate([_charged(block, motion, _whole) for block in blocks(encounters)])


def has_spans(encounters: Encounters, motion: FleetMotion) -> bool:
    """Return whether only those intervals are looked at closely that tell.

    Parameters
    ----------
    encounters : Encounters
        Along intervals.
    motion : FleetMotion
        What they were gathered from.
    """
    # What several vehicles, or moving obstacles, have in common is known for all steps at once.
    is_whole = motion.common is not None or motion.tracks is not None
    return not is_whole and encounters.sagittas.shape[1] >= 2 * _SPAN


def _charged(encounters: Encounters, motion: FleetMotion, spans: Spans) -> Vector:
    """Return what encounters cost per step, those intervals looked at that tell, (B, T+1)."""
    own, near, far, is_apart, charged = _each_alone(encounters)
    alone = np.ones(far.shape, dtype=bool)
    sums = charged.sum(axis=1)
    # Steps have no parts, and what is far away is not looked at in parts: nor is when it is.
    worth = np.flatnonzero((sums > WORTH) & (sums > TELLING * encounters.summed(sums)))
    for which, first, length in spans((near.sum(axis=2) + far)[worth]):
        chosen, intervals = worth[which], first[:, None] + np.arange(length)
        rows, held = np.arange(chosen.size)[:, None], own[chosen[:, None], intervals]
        rough = is_apart[chosen[:, None], intervals]
        close = encounters.take(chosen)
        if length < far.shape[1]:
            close = close.during(first, length)
        left = near[chosen], far[chosen]
        for end in left:
            end[rows, intervals] = 0.0
        found = chain_charges(*left, alone[chosen])
        at, steps = 0, first[:, None] + np.arange(length + 1)
        large = LARGE if spans is _whole else LARGE_IN_SPANS
        for block in blocks(close):
            part = slice(at, at + len(block.means))
            turned = _turned_to_faces(block, held[part], rough[part])
            found[rows[part], steps[part]] += _chained_risks(block, motion, turned, large)
            at = part.stop
        charged[chosen] = found
    return charged


def _each_alone(encounters: Encounters) -> tuple[Tensor, Tensor, Matrix, Flags, Matrix]:
    """Return what `_told_apart` does, and what encounters cost by step without any chain."""
    if len(encounters.means) < _MANY:
        own, near, far = alone_risks(encounters)
        is_apart = np.zeros(far.shape, dtype=bool)
    else:
        own, near, far, is_apart = _told_apart(encounters)
    alone = np.ones(far.shape, dtype=bool)
    return own, near, far, is_apart, chain_charges(near, far, alone)


def _told_apart(encounters: Encounters) -> tuple[Tensor, Tensor, Matrix, Flags]:
    """Return what `alone_risks` does, but where the line to the set tells, and where it does.

    In most intervals no vehicle is near: the half-space across that line risks next to nothing.
    """
    parts = []
    for block in blocks(encounters):
        sites, shape = interval_sites(block), block.sagittas.shape[:2]
        best, risks = cheapest(sites, away(sites))
        close = np.flatnonzero(risks > _APART)
        if close.size:
            tried = block.directions[close // shape[1]]
            best[close], _ = best_directions(sites.take(close), tried, 1)
        near, far = _ends(sites, best)
        ends = near.reshape(*shape, -1), far.reshape(shape)
        parts.append((best.reshape(*shape, -1), *ends, (risks <= _APART).reshape(shape)))
    own, near, far, is_apart = (np.concatenate(each) for each in zip(*parts, strict=True))
    return own, near, far, is_apart


def _turned_to_faces(encounters: Encounters, held: Tensor, rough: Flags) -> Tensor:
    """Return directions of intervals, the rough ones as `alone_risks` would choose them."""
    rest = np.flatnonzero(rough)
    if not rest.size:
        return held
    sites = interval_sites(encounters).take(rest)
    faces = encounters.directions[rest // rough.shape[1]]
    best, _ = cheapest(sites, np.concatenate([faces, away(sites)], axis=1))
    turned = held.copy()
    turned.reshape(-1, held.shape[2])[rest] = best
    return turned


def alone_risks(encounters: Encounters) -> tuple[Tensor, Tensor, Matrix]:
    """Return the best half-space of each interval, and the risks at its near and far ends.

    Parameters
    ----------
    encounters : Encounters
        B along K intervals.

    Returns
    -------
    (B, K, d), (B, K, 1 or 2) and (B, K) array
        Each interval by itself.
    """
    parts = []
    for block in blocks(encounters):
        sites, shape = interval_sites(block), block.sagittas.shape[:2]
        best, _ = best_directions(sites, block.directions, shape[1])
        near, far = _ends(sites, best)
        parts.append((best.reshape(*shape, -1), near.reshape(*shape, -1), far.reshape(shape)))
    own, near, far = (np.concatenate(each) for each in zip(*parts, strict=True))
    return own, near, far


def _whole(each: Matrix) -> Iterator[Span]:
    """Yield all encounters with all intervals."""
    count, num_intervals = each.shape
    if count:
        yield np.arange(count), np.zeros(count, dtype=np.int64), num_intervals


def spans_that_tell(each: Matrix) -> Iterator[Span]:
    """Yield encounters with the intervals that tell, as many for all of a group.

    Parameters
    ----------
    each : (B, K) array
        Risk of each interval alone.
    """
    num_intervals = each.shape[1]
    tells = each > _FAINT / num_intervals * each.sum(axis=1, keepdims=True)
    first = tells.argmax(axis=1)
    lengths = num_intervals - tells[:, ::-1].argmax(axis=1) - first
    spans = np.minimum(_SPAN * -(-(lengths + 2) // _SPAN), num_intervals)
    for length in np.unique(spans).tolist():
        which = np.flatnonzero(spans == length)
        yield which, np.clip(first[which] - 1, 0, num_intervals - length), length


def _chained_risks(
    encounters: Encounters, motion: FleetMotion, own: Tensor, share: float
) -> Tensor:
    """Return what the best chain found costs per step, from the best half-spaces of intervals."""
    from radmpc.referee.bound.parts import MANY_PARTS, NUM_PARTS, part_charges  # noqa: PLC0415 - few need it

    tried = np.concatenate([encounters.directions, own], axis=1)
    in_runs, turned = chained(interval_sites(encounters), tried)
    parted = part_charges(encounters, motion, (own, turned), NUM_PARTS)
    is_better = parted.sum(axis=1) < in_runs.sum(axis=1)
    found: Tensor = np.where(is_better[:, None], parted, in_runs)
    sums = found.sum(axis=1)
    large = np.flatnonzero((sums > share * encounters.summed(sums)) & is_curved(encounters))
    if large.size:
        guides = own[large], turned[large]
        finer = part_charges(encounters.take(large), motion, guides, MANY_PARTS)
        is_better = finer.sum(axis=1) < sums[large]
        found[large[is_better]] = finer[is_better]
    return found


def is_curved(encounters: Encounters) -> Flags:
    """Return which paths are curved by more than their noise hides, or bent by feedback, (B,)."""
    sagitta = np.linalg.norm(encounters.sagittas, axis=2).max(axis=1)
    variances = np.einsum("btii->bt", encounters.covariances).max(axis=1)
    return np.asarray((sagitta > np.sqrt(variances)) | (encounters.bent_covariances is not None))


def _ends(sites: Sites, directions: Tensor) -> tuple[Tensor, Vector]:
    """Return the risks at the near ends, (S, 1 or 2), and at the far ones, (S,)."""
    found = least_risks(sites, directions)
    return found[:, :-1], found[:, -1]


def chained(sites: Sites, tried: Tensor) -> tuple[Vector, Tensor]:
    """Return what the best chain over some directions costs, its runs turned to their best.

    Parameters
    ----------
    sites : Sites
        B encounters of K intervals each, in order.
    tried : (B, C, d) array
        Candidates.

    Returns
    -------
    charged : (B, K+1) array
        Risk per step.
    directions : (B, K, d) array
        Of each interval.
    """
    count, num_intervals = len(tried), len(sites.means) // len(tried)
    found = shared_risks(sites, np.repeat(tried, num_intervals, axis=0))
    found = found.reshape(count, num_intervals, -1, found.shape[2])
    choices = cheapest_chain(found[..., :-1], found[..., -1])
    begins = np.ones(choices.shape, dtype=bool)
    begins[:, 1:] = choices[:, 1:] != choices[:, :-1]
    chosen = np.take_along_axis(tried, choices[:, :, None], axis=1)
    flat = chosen.reshape(-1, tried.shape[2])
    # A run holds one direction: all of it tries the same, also along the edges of its solid.
    leaders = np.maximum.accumulate(np.where(begins.ravel(), np.arange(begins.size), 0))
    turned, _ = refine(sites, flat, partial(run_scores, begins=begins.ravel()), leaders)
    near, far = _ends(sites, turned)
    shape = (count, num_intervals)
    charged = chain_charges(near.reshape(*shape, -1), far.reshape(shape), begins)
    return charged, turned.reshape(count, num_intervals, -1)
