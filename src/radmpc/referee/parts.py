"""Intervals looked at in equal parts: shorter chords, smaller bows, and half-spaces that turn."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from radmpc.arrays import Tensor
from radmpc.referee.encounters import Encounters, around
from radmpc.referee.halfspace import Sites
from radmpc.referee.moments import Moments, moments_of
from radmpc.referee.motion import FleetMotion
from radmpc.referee.persistence import Crossed, path_charges
from radmpc.referee.search import closest_directions

__all__ = ["NUM_PARTS", "part_charges"]

NUM_PARTS = 4
"""Parts of an interval; more are hardly tighter (2: 3 %, 8: 0.5 % on the calibration set)."""


def part_charges(
    encounters: Encounters, motion: FleetMotion, guides: Sequence[Tensor]
) -> list[Tensor]:
    """Return what chains of half-spaces cost that are held over parts of intervals.

    Parameters
    ----------
    encounters : Encounters
        B of them.
    motion : FleetMotion
        What they were gathered from.
    guides : sequence of (B, K, d) array
        Half-spaces of whole intervals: the first to begin with, all to be held as they are.

    Returns
    -------
    list of (B, K+1) array
        Valid each; the first with directions of each part's own, then one per guide.
    """
    sites, crossed = part_sites(encounters, motion, NUM_PARTS)
    count, num_intervals, d = encounters.bows.shape
    held = [np.repeat(guide, NUM_PARTS, axis=1) for guide in guides]
    faces = np.repeat(encounters.directions, num_intervals * NUM_PARTS, axis=0)
    own = closest_directions(sites, faces, held[0].reshape(-1, d)).reshape(held[0].shape)
    return [path_charges(sites, chosen, crossed, NUM_PARTS) for chosen in (own, *held)]


def part_sites(encounters: Encounters, motion: FleetMotion, parts: int) -> tuple[Sites, Crossed]:
    """Return one site per encounter and part, with the covariances between its ends.

    Returns
    -------
    sites : Sites
        ``B K M`` of them, in order.
    crossed : Crossed
        Of each.
    """
    count, num_intervals, d = encounters.bows.shape
    width = num_intervals * parts
    moments = _relative(encounters, motion, parts)
    places = [moments.means[:, :-1], moments.means[:, 1:]]
    spreads = [moments.own[:, :-1], moments.own[:, 1:]]
    is_near = [True, False]
    if encounters.bent_covariances is not None:
        places.insert(1, moments.means[:, :-1])
        spreads.insert(1, moments.bent)
        is_near.insert(1, True)
    ends = len(places)
    shares = np.arange(width) % parts / parts
    blends = np.stack([shares if near else shares + 1.0 / parts for near in is_near], axis=1)
    sites = Sites(
        np.stack(places, axis=2).reshape(-1, ends, d),
        np.stack(spreads, axis=2).reshape(-1, ends, d, d),
        tuple(is_near),
        moments.bows.reshape(-1, d),
        np.repeat(encounters.radii, width),
        around(encounters.vertices, num_intervals, parts),
        np.tile(blends, (count, 1)),
        around(encounters.edges, num_intervals, parts),
    )
    crossed = Crossed(
        moments.near_with_bent.reshape(-1, d, d), moments.bent_with_far.reshape(-1, d, d)
    )
    return sites, crossed


def _relative(encounters: Encounters, motion: FleetMotion, parts: int) -> Moments:
    """Return the moments of the encounters' (relative) positions."""
    pairs = encounters.is_pair
    involved = [encounters.first, encounters.other] if pairs else [encounters.first]
    vehicles = np.unique(np.concatenate(involved))
    of_all = moments_of(motion, vehicles, parts)
    first = np.searchsorted(vehicles, encounters.first)
    if not pairs:
        return of_all.of(first)
    return of_all.of(first).minus(of_all.of(np.searchsorted(vehicles, encounters.other)))
