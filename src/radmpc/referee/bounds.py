"""Upper bounds on the risk of encounters, step by step or window by window."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial

import numpy as np

from radmpc.arrays import Tensor, Vector
from radmpc.referee.chain import chain_charges, cheapest_chain, run_scores
from radmpc.referee.encounters import Encounters, blocks, instant_sites, interval_sites
from radmpc.referee.halfspace import Sites, end_margins, end_risks, refine
from radmpc.referee.planar import grown_polygon_risks
from radmpc.referee.search import NEGLIGIBLE, best_directions

__all__ = ["WindowHalfspaces", "step_risks", "window_halfspaces"]


def step_risks(encounters: Encounters, *, intervals: bool) -> Vector:
    """Return an upper bound on the probability of each encounter's collision, step by step.

    Parameters
    ----------
    encounters : Encounters
        B of them.
    intervals : bool
        Whether the path between the steps counts.

    Returns
    -------
    (B, T+1) array
        Sums over steps bound the probability that the encounter collides at all.
    """
    parts = [
        _interval_risks(block) if intervals else _instant_risks(block)
        for block in blocks(encounters)
    ]
    return np.concatenate(parts)


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
    risks: Vector


def window_halfspaces(encounters: Encounters, *, intervals: bool) -> WindowHalfspaces:
    """Return the best half-spaces of all windows: the T intervals, or the T+1 steps."""
    parts: list[tuple[Tensor, Tensor, Vector]] = []
    for block in blocks(encounters):
        sites = interval_sites(block) if intervals else instant_sites(block)
        count, d = len(block.means), block.means.shape[2]
        num_windows = len(sites.means) // count
        best, risks = best_directions(sites, block.directions, num_windows)
        margins = end_margins(sites, best[:, None])
        parts.append(
            (
                best.reshape(count, num_windows, d),
                margins.reshape(count, num_windows, -1),
                risks.reshape(count, num_windows),
            )
        )
    normals, bounds, chances = (np.concatenate(p) for p in zip(*parts, strict=True))
    return WindowHalfspaces(normals, bounds, chances)


def _instant_risks(encounters: Encounters) -> Vector:
    """Return the smaller of the best half-space and, in the plane, the exact probability."""
    count, steps, d = encounters.means.shape
    sites = instant_sites(encounters)
    best, risks = best_directions(sites, encounters.directions, steps)
    worth = np.flatnonzero(risks > NEGLIGIBLE)
    if d == 2 and worth.size:
        risks[worth] = grown_polygon_risks(
            sites.means[worth, 0],
            sites.covariances[worth, 0],
            sites.vertices[worth, 0],
            sites.radii[worth],
            best[worth],
            risks[worth],
        )
    return risks.reshape(count, steps)


def _interval_risks(encounters: Encounters) -> Vector:
    """Return the best chain of half-spaces, each held over a whole interval."""
    sites = interval_sites(encounters)
    count, num_intervals, d = encounters.bows.shape
    best, risks = best_directions(sites, encounters.directions, num_intervals)
    ends = end_risks(sites, best[:, None]).reshape(count, num_intervals, 2)
    alone = np.ones((count, num_intervals), dtype=bool)
    charged = chain_charges(ends[:, :, 0], ends[:, :, 1], alone)
    # Sharing at most halves the sum: not worth a look where there is nothing to halve.
    worth = np.flatnonzero(risks.reshape(count, -1).sum(axis=1) > NEGLIGIBLE)
    if worth.size:
        own = best.reshape(count, num_intervals, d)[worth]
        tried = np.concatenate([encounters.directions[worth], own], axis=1)
        chosen = (worth[:, None] * num_intervals + np.arange(num_intervals)).ravel()
        charged[worth] = _chained(sites.take(chosen), tried)
    return charged


def _chained(sites: Sites, tried: Tensor) -> Vector:
    """Return what the best chain over some directions costs, its runs turned to their best.

    Parameters
    ----------
    sites : Sites
        B encounters of K intervals each, in order.
    tried : (B, C, d) array
        Candidates.

    Returns
    -------
    (B, K+1) array
        Risk per step.
    """
    count, num_intervals = len(tried), len(sites.means) // len(tried)
    found = end_risks(sites, np.repeat(tried, num_intervals, axis=0))
    found = found.reshape(count, num_intervals, -1, 2)
    choices = cheapest_chain(found[..., 0], found[..., 1])
    begins = np.ones(choices.shape, dtype=bool)
    begins[:, 1:] = choices[:, 1:] != choices[:, :-1]
    chosen = np.take_along_axis(tried, choices[:, :, None], axis=1)
    flat = chosen.reshape(-1, tried.shape[2])
    turned, _ = refine(sites, flat, partial(run_scores, begins=begins.ravel()))
    ends = end_risks(sites, turned[:, None]).reshape(count, num_intervals, 2)
    return chain_charges(ends[:, :, 0], ends[:, :, 1], begins)
