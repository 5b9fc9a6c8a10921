"""Upper bounds on the risk of encounters, step by step or window by window."""

from __future__ import annotations

import numpy as np

from radmpc.arrays import Matrix, Tensor, Vector
from radmpc.records import dataclass
from radmpc.referee.bound.halfspace import end_margins, end_risks
from radmpc.referee.bound.intervals import interval_risks
from radmpc.referee.bound.persistence import best_shares
from radmpc.referee.bound.search import NEGLIGIBLE, best_directions
from radmpc.referee.encounters import Encounters, blocks, instant_sites, interval_sites
from radmpc.referee.motion import FleetMotion

__all__ = ["WindowHalfspaces", "instant_risks", "step_risks", "window_halfspaces"]


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
        found = interval_risks(encounters, motion)
    else:
        found = np.concatenate([instant_risks(block) for block in blocks(encounters)])
    # What surely happens once need not be charged for more.
    return np.asarray(found / np.maximum(found.sum(axis=1, keepdims=True), 1.0))


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
