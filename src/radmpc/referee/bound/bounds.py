"""Upper bounds on the risk of encounters, step by step or window by window."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from radmpc.arrays import Matrix, Tensor, Vector
from radmpc.records import dataclass
from radmpc.referee.bound.halfspace import end_margins, end_risks
from radmpc.referee.bound.intervals import interval_risks
from radmpc.referee.bound.persistence import best_shares
from radmpc.referee.bound.search import NEGLIGIBLE, best_directions
from radmpc.referee.encounters import (
    Encounters,
    blocks,
    instant_sites,
    interval_sites,
    sites_at,
    together,
)
from radmpc.referee.motion import FleetMotion
from radmpc.referee.reserve import in_deviations
from radmpc.referee.sites import Sites, joined, joined_rows
from radmpc.referee.tails import exceeding

__all__ = ["WindowHalfspaces", "instant_risks", "site_risks", "step_risks", "window_halfspaces"]

_FAR = 1e-24
"""Risk across the line to a box around a set below which no other half-space is tried [-]: all such
of a thousand vehicles among a hundred obstacles add up to less than anybody asks for."""

_FEW = 400
"""Sites of all batches together up to which they are looked at in one go [-]."""

_FEW_ENCOUNTERS = 300
"""Encounters of all batches together up to which they are looked at in one go along intervals [-]:
`paper(8)`, `paper(12)` and `fleet(16)` are judged in 0.72 of the time, `fleet(24)` in 1.07."""

_BLOCK = 1_000_000
"""Numbers in the largest array of one block of sites: memory against the calls per block."""


def step_risks(
    batches: Sequence[Encounters],
    motion: FleetMotion,
    *,
    intervals: bool,
    is_rough: bool = False,
) -> list[Matrix]:
    """Return an upper bound on the probability of each encounter's collision, step by step.

    Parameters
    ----------
    batches : sequence of Encounters
        B of them each.
    motion : FleetMotion
        What they were gathered from.
    intervals : bool
        Whether the path between the steps counts.
    is_rough : bool
        Whether intervals are charged one by one, which is quick; steps always are.

    Returns
    -------
    list of (B, T+1) array
        Sums over steps bound the probability that the encounter collides at all.
    """
    every = (
        _interval_risks(batches, motion, is_rough=is_rough) if intervals else instant_risks(batches)
    )
    # What surely happens once need not be charged for more.
    return [found / np.maximum(found.sum(axis=1, keepdims=True), 1.0) for found in every]


def _interval_risks(
    batches: Sequence[Encounters], motion: FleetMotion, *, is_rough: bool
) -> list[Matrix]:
    """Return the risks along intervals of all batches.

    Few encounters take as long as one: those with what stands still, and those with what moves,
    are looked at in one go each.
    """
    alike: dict[int, list[int]] = {}
    is_few = sum(len(one.first) for one in batches) <= _FEW_ENCOUNTERS
    for number, one in enumerate(batches):
        # Edges in space are not padded.
        joins = is_few and one.means.shape[2] == 2
        alike.setdefault(one.vertices.shape[1] if joins else -number, []).append(number)
    found: dict[int, Matrix] = {}
    for numbers in alike.values():
        some = [batches[number] for number in numbers]
        ends = np.cumsum([len(one.first) for one in some])[:-1]
        risks = interval_risks(together(some), motion, is_rough=is_rough)
        found |= zip(numbers, np.split(risks, ends), strict=True)
    return [found[number] for number in range(len(batches))]


@dataclass(frozen=True, slots=True, eq=False)
class WindowHalfspaces:
    """The best half-space of each encounter in each window, on its own.

    Attributes
    ----------
    normals : (B, K, d) array
        Away from what is avoided [-].
    margins : (B, K, E) array
        A collision needs a deviation along −normal that exceeds this at one of the ends [m].
    risks : (B, K) array
        Upper bound on the probability of a collision in the window [-].
    """

    normals: Tensor
    margins: Tensor
    risks: Matrix


def window_halfspaces(encounters: Encounters, *, intervals: bool) -> WindowHalfspaces:
    """Return the best half-spaces of all windows: the T intervals, or the T+1 steps.

    Parameters
    ----------
    encounters : Encounters
        B of one kind.
    intervals : bool
        Whether windows are the T intervals, or the T+1 steps.
    """
    parts: list[tuple[Tensor, Tensor, Vector]] = []
    for block in blocks(encounters):
        sites = interval_sites(block) if intervals else instant_sites(block)
        count, d = len(block.means), block.means.shape[2]
        num_windows = len(sites.means) // count
        best, _ = best_directions(sites, block.directions, num_windows)
        shares = best_shares(sites, best)[:, None]
        margins = end_margins(sites, best[:, None], shares)
        risks = end_risks(sites, best[:, None], shares).sum(axis=2)
        parts.append(
            (
                best.reshape(count, num_windows, d),
                margins.reshape(count, num_windows, -1),
                risks.reshape(count, num_windows),
            )
        )
    normals, bounds, chances = (np.concatenate(p) for p in zip(*parts, strict=True))
    return WindowHalfspaces(normals, bounds, chances)


def instant_risks(batches: Sequence[Encounters]) -> list[Matrix]:
    """Return the risk of every encounter at every step, (B, T+1) for each batch.

    The smaller of the best half-space and, in the plane, the exact probability; of what is far away
    that of the half-space across the line to the box around it.

    Parameters
    ----------
    batches : sequence of Encounters
        B of them each, at steps.
    """
    risks = [_box_risks(encounters) for encounters in batches]
    near = [np.argwhere(found > _FAR) for found in risks]
    if len(batches) > 1 and 0 < sum(map(len, near)) <= _FEW and batches[0].means.shape[2] == 2:
        # Few sites take as long as one: that goes into calls.
        looks = zip(batches, near, strict=True)
        sites = joined([sites_at(one, *places.T) for one, places in looks])
        looks = zip(batches, near, strict=True)
        tried = joined_rows([one.directions[places[:, 0]] for one, places in looks])
        found = np.split(site_risks(sites, tried)[0], np.cumsum([len(n) for n in near])[:-1])
        for one, places, best in zip(risks, near, found, strict=True):
            rows, steps = places.T
            one[rows, steps] = np.minimum(best, one[rows, steps])
        return risks
    for encounters, one, places in zip(batches, risks, near, strict=True):
        corners, directions = encounters.vertices.shape[2], encounters.directions.shape[1]
        size = max(1, _BLOCK // ((directions + 2 * corners) * (corners + 4)))
        for begin in range(0, len(places), size):
            rows, steps = places[begin : begin + size].T
            sites = sites_at(encounters, rows, steps)
            best, _ = site_risks(sites, encounters.directions[rows])
            one[rows, steps] = np.minimum(best, one[rows, steps])
    return risks


def site_risks(sites: Sites, directions: Tensor) -> tuple[Vector, Vector]:
    """Return the risk at each site, (S,), and what the search says of its best half-space, (S,).

    Parameters
    ----------
    sites : Sites
        S of one end each.
    directions : (S, C, d) array
        That are tried.

    Returns
    -------
    tuple of array
        The smaller of the best half-space and, of a Gaussian in the plane, the exact probability;
        the search tells apart what fails for certain, which is no probability.
    """
    best, risks = best_directions(sites, directions, 1)
    found = np.minimum(risks, 1.0)
    worth = np.flatnonzero(found > NEGLIGIBLE)
    if worth.size and sites.samples is None and sites.means.shape[2] == 2:
        # Vehicles without encounters are not integrated.
        from radmpc.referee.bound.planar import grown_polygon_risks  # noqa: PLC0415 - near pairs alone

        close = sites.take(worth)
        found[worth] = grown_polygon_risks(
            close.means[:, 0],
            close.covariances[:, 0],
            close.vertices[:, 0],
            close.radii,
            best[worth],
            found[worth],
        )
    return found, risks


def _box_risks(encounters: Encounters) -> Matrix:
    """Return the risk of half-spaces across the lines to the boxes around the sets, (B, T+1).

    1 where means are within the radius of a box: a closer look tells.
    """
    lower, upper = encounters.vertices.min(axis=2), encounters.vertices.max(axis=2)
    beside = np.maximum(lower - encounters.means, encounters.means - upper)
    distances = np.linalg.norm(np.maximum(beside, 0.0), axis=2) - encounters.radii[:, None]
    # The trace is no less than the largest variance, which bounds risks of half-spaces that hold.
    variances = np.trace(encounters.covariances, axis1=2, axis2=3)
    deviations = np.sqrt(variances.clip(min=0.0))  # noise that cancels, up to rounding
    held = exceeding(in_deviations(distances, deviations), encounters.samples)
    return np.where(distances > 0.0, held, 1.0)
