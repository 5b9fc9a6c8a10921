"""Which half-spaces the certificate charges along intervals: the same choices, kept this time."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from radmpc.arrays import Indices, Tensor, Vector
from radmpc.records import dataclass, replace
from radmpc.referee.bound.chain import chain_charges
from radmpc.referee.bound.intervals import (
    LARGE,
    LARGE_IN_SPANS,
    TELLING,
    WORTH,
    alone_risks,
    chained,
    is_curved,
    spans_that_tell,
)
from radmpc.referee.bound.parts import (
    MANY_PARTS,
    NUM_PARTS,
    REACHES,
    averaged,
    part_sites,
)
from radmpc.referee.bound.parts import TELLING as WORTH_MORE
from radmpc.referee.bound.persistence import Crossed, least_risks, path_charges
from radmpc.referee.bound.search import best_directions, closest_directions
from radmpc.referee.conditional.rows import Flags
from radmpc.referee.encounters import Encounters, blocks, interval_sites
from radmpc.referee.motion import FleetMotion
from radmpc.referee.sites import Sites

__all__ = ["Choice", "during", "interval_choices", "span_choices"]


@dataclass(frozen=True, slots=True, eq=False)
class Choice:
    """Half-spaces of some encounters, all held over whole intervals or all over parts of them.

    Attributes
    ----------
    chosen : (b,) int array
        Which encounters of the block.
    parts : int
        Parts of each interval; 0 stands for whole intervals, whose ends are charged one by one.
    directions : (b, K max(parts, 1), d) array
        Their normals [-].
    begins : (b, K) bool array
        Where whole intervals begin to hold another half-space than the one before.
    first : (b,) int array or None
        The interval of each that is the first of these K; None is the flight's own first.
    left_out : (b, K) bool array or None
        Intervals that another choice speaks of; None is none. Then no interval goes on from the
        one before.
    """

    chosen: Indices
    parts: int
    directions: Tensor
    begins: Flags
    first: Indices | None = None
    left_out: Flags | None = None


def interval_choices(encounters: Encounters, motion: FleetMotion) -> Iterator[Choice]:
    """Yield what the certificate holds along intervals, for every encounter of a block once.

    Parameters
    ----------
    encounters : Encounters
        A block of one kind.
    motion : FleetMotion
        What they were gathered from.
    """
    sites = interval_sites(encounters)
    count, num_intervals, d = encounters.sagittas.shape
    best, _ = best_directions(sites, encounters.directions, num_intervals)
    own = best.reshape(count, num_intervals, d)
    alone = np.ones((count, num_intervals), dtype=bool)
    found = least_risks(sites, best).reshape(count, num_intervals, -1)
    sums = chain_charges(found[..., :-1], found[..., -1], alone).sum(axis=1)
    worth = np.flatnonzero((sums > WORTH) & (sums > TELLING * sums.sum()))
    rest = np.setdiff1d(np.arange(count), worth)
    if rest.size:
        yield Choice(rest, 0, own[rest], alone[rest])
    if worth.size:
        rows = (worth[:, None] * num_intervals + np.arange(num_intervals)).ravel()
        for choice in _closer(encounters.take(worth), motion, sites.take(rows), own[worth]):
            yield Choice(worth[choice.chosen], choice.parts, choice.directions, choice.begins)


def span_choices(encounters: Encounters, motion: FleetMotion) -> Iterator[Choice]:
    """Yield what the certificate of a long flight holds: chains where they tell, then the rest.

    Parameters
    ----------
    encounters : Encounters
        All of one kind.
    motion : FleetMotion
        What they were gathered from.
    """
    own, near, far = alone_risks(encounters)
    count, num_intervals, _ = own.shape
    alone = np.ones((count, num_intervals), dtype=bool)
    sums = chain_charges(near, far, alone).sum(axis=1)
    worth = np.flatnonzero((sums > WORTH) & (sums > TELLING * sums.sum()))
    left_out = np.zeros((count, num_intervals), dtype=bool)
    for which, first, length in spans_that_tell((near.sum(axis=2) + far)[worth]):
        chosen, intervals = worth[which], first[:, None] + np.arange(length)
        left_out[chosen[:, None], intervals] = True
        held, at = own[chosen[:, None], intervals], 0
        for block in blocks(during(encounters.take(chosen), first, length)):
            part = slice(at, at + len(block.means))
            at = part.stop
            for choice in _closer(block, motion, interval_sites(block), held[part], LARGE_IN_SPANS):
                yield replace(
                    choice, chosen=chosen[part][choice.chosen], first=first[part][choice.chosen]
                )
    yield Choice(np.arange(count), 0, own, alone, None, left_out)


def during(encounters: Encounters, first: Indices, length: int) -> Encounters:
    """Return encounters during some intervals of each, as they are where those are all.

    Parameters
    ----------
    encounters : Encounters
        B of them.
    first : (B,) int array
        The first interval of each.
    length : int
        How many.
    """
    is_all = length == encounters.sagittas.shape[1]
    return encounters if is_all else encounters.during(first, length)


def _closer(
    close: Encounters, motion: FleetMotion, sites: Sites, own: Tensor, share: float = LARGE
) -> Iterator[Choice]:
    """Yield the choices of encounters that are worth a closer look."""
    in_runs, turned = chained(sites, np.concatenate([close.directions, own], axis=1))
    begins = np.ones(turned.shape[:2], dtype=bool)
    begins[:, 1:] = (turned[:, 1:] != turned[:, :-1]).any(axis=2)
    held, parted = _parted(close, motion, (own, turned), NUM_PARTS)
    in_parts = parted < in_runs.sum(axis=1)
    sums = np.where(in_parts, parted, in_runs.sum(axis=1))
    large = np.flatnonzero((sums > share * sums.sum()) & is_curved(close))
    finer = np.zeros(len(sums), dtype=bool)
    if large.size:
        fine, fine_sums = _parted(
            close.take(large), motion, (own[large], turned[large]), MANY_PARTS
        )
        better = fine_sums < sums[large]
        finer[large[better]] = True
        if better.any():
            yield Choice(large[better], MANY_PARTS, fine[better], begins[large[better]])
    for chosen, parts, directions in (
        (np.flatnonzero(in_parts & ~finer), NUM_PARTS, held),
        (np.flatnonzero(~in_parts & ~finer), 0, turned),
    ):
        if chosen.size:
            yield Choice(chosen, parts, directions[chosen], begins[chosen])


def _parted(
    encounters: Encounters, motion: FleetMotion, guides: Sequence[Tensor], parts: int
) -> tuple[Tensor, Vector]:
    """Return the cheapest half-spaces found over parts, (B, K M, d), and what they cost, (B,)."""
    sites, crossed = part_sites(encounters, motion, parts)
    num_intervals, d = encounters.sagittas.shape[1:]
    width = num_intervals * parts
    held = [np.repeat(guide, parts, axis=1) for guide in guides]
    faces = np.repeat(encounters.directions, width, axis=0)
    own = closest_directions(sites, faces, held[0].reshape(-1, d)).reshape(held[0].shape)
    directions, sums = _cheapest(sites, crossed, (own, *held), parts)
    telling = np.flatnonzero(sums > WORTH_MORE * sums.sum())
    if telling.size:
        rows = (telling[:, None] * width + np.arange(width)).ravel()
        reaches = [reach * parts // NUM_PARTS for reach in REACHES]
        tried = [averaged(own[telling], reach) for reach in reaches]
        tried += [averaged(guide[telling], reaches[0]) for guide in held]
        turned, found = _cheapest(sites.take(rows), crossed.take(rows), tried, parts)
        better = found < sums[telling]
        directions[telling[better]] = turned[better]
        sums[telling[better]] = found[better]
    return directions, sums


def _cheapest(
    sites: Sites, crossed: Crossed, tried: Sequence[Tensor], parts: int
) -> tuple[Tensor, Vector]:
    """Return each encounter's cheapest choice of directions, and what it costs."""
    choices = np.stack(tried, axis=2)
    found = path_charges(sites, choices, crossed, parts).sum(axis=2)
    best, rows = found.argmin(axis=1), np.arange(len(found))
    return choices[rows, :, best], found[rows, best]
