"""Upper bounds on the risk of encounters, step by step or window by window."""

from __future__ import annotations

from functools import partial

import numpy as np
import numpy.typing as npt

from radmpc.arrays import Matrix, Tensor, Vector
from radmpc.records import dataclass
from radmpc.referee.bound.chain import chain_charges, cheapest_chain, run_scores
from radmpc.referee.bound.halfspace import end_margins, end_risks, refine, shared_risks
from radmpc.referee.bound.persistence import best_shares, least_risks
from radmpc.referee.bound.search import NEGLIGIBLE, best_directions
from radmpc.referee.encounters import Encounters, blocks, instant_sites, interval_sites
from radmpc.referee.motion import FleetMotion
from radmpc.referee.sites import Sites

__all__ = [
    "LARGE",
    "TELLING",
    "WORTH",
    "WindowHalfspaces",
    "chained",
    "instant_risks",
    "is_curved",
    "step_risks",
    "window_halfspaces",
]

WORTH = 1e-13
"""Sum of an encounter below which its intervals are not looked at in parts [-]."""

TELLING = 1e-8
"""Share of all encounters' sum below which one is charged as it is [-]."""


def step_risks(encounters: Encounters, motion: FleetMotion, *, intervals: bool) -> Vector:
    """Return an upper bound on the probability of each encounter's collision, step by step.

    Parameters
    ----------
    encounters : Encounters
        B of them.
    motion : FleetMotion
        What they were gathered from.
    intervals : bool
        Whether the path between the steps counts.

    Returns
    -------
    (B, T+1) array
        Sums over steps bound the probability that the encounter collides at all.
    """
    if intervals:
        found = np.concatenate([_interval_risks(block, motion) for block in blocks(encounters)])
    else:
        found = np.concatenate([instant_risks(block) for block in blocks(encounters)])
    # What surely happens once need not be charged for more.
    return np.asarray(found / np.maximum(found.sum(axis=1, keepdims=True), 1.0))


Flags = npt.NDArray[np.bool_]

LARGE = 0.1
"""Share of all encounters' sum from which on one is looked at in many parts."""


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


def instant_risks(encounters: Encounters) -> Vector:
    """Return the risk of every encounter at every step, (B, T+1).

    The smaller of the best half-space and, in the plane, the exact probability.
    """
    count, steps, d = encounters.means.shape
    sites = instant_sites(encounters)
    best, risks = best_directions(sites, encounters.directions, steps)
    # The search tells apart what fails for certain: that is no probability.
    risks = np.minimum(risks, 1.0)
    worth = np.flatnonzero(risks > NEGLIGIBLE)
    # Integrals are of Gaussians.
    if d == 2 and worth.size and sites.samples is None:
        # Who meets nobody is not integrated.
        from radmpc.referee.bound.planar import grown_polygon_risks  # noqa: PLC0415 - near pairs alone

        risks[worth] = grown_polygon_risks(
            sites.means[worth, 0],
            sites.covariances[worth, 0],
            sites.vertices[worth, 0],
            sites.radii[worth],
            best[worth],
            risks[worth],
        )
    return risks.reshape(count, steps)


def _interval_risks(encounters: Encounters, motion: FleetMotion) -> Vector:
    """Return the best chain of half-spaces, over whole intervals or parts of them."""
    sites = interval_sites(encounters)
    count, num_intervals, d = encounters.sagittas.shape
    best, _ = best_directions(sites, encounters.directions, num_intervals)
    own = best.reshape(count, num_intervals, d)
    near, far = _ends(sites, best)
    alone = np.ones((count, num_intervals), dtype=bool)
    shape = (count, num_intervals)
    charged = chain_charges(near.reshape(*shape, -1), far.reshape(shape), alone)
    sums = charged.sum(axis=1)
    worth = np.flatnonzero((sums > WORTH) & (sums > TELLING * sums.sum()))
    if not worth.size:
        return charged
    # Steps have no parts, and what is far away is not looked at in parts.
    from radmpc.referee.bound.parts import MANY_PARTS, NUM_PARTS, part_charges  # noqa: PLC0415 - few need it

    tried = np.concatenate([encounters.directions[worth], own[worth]], axis=1)
    chosen = (worth[:, None] * num_intervals + np.arange(num_intervals)).ravel()
    in_runs, turned = chained(sites.take(chosen), tried)
    close = encounters.take(worth)
    parted = part_charges(close, motion, (own[worth], turned), NUM_PARTS)
    is_better = parted.sum(axis=1) < in_runs.sum(axis=1)
    found = np.where(is_better[:, None], parted, in_runs)
    sums = found.sum(axis=1)
    large = np.flatnonzero((sums > LARGE * sums.sum()) & is_curved(close))
    if large.size:
        guides = own[worth[large]], turned[large]
        finer = part_charges(close.take(large), motion, guides, MANY_PARTS)
        is_better = finer.sum(axis=1) < sums[large]
        found[large[is_better]] = finer[is_better]
    charged[worth] = found
    return charged


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
