"""Upper bounds on the risk of encounters, step by step or window by window."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from radmpc.arrays import Indices, Matrix, Tensor, Vector
from radmpc.records import dataclass
from radmpc.referee.bound.halfspace import end_margins, end_risks
from radmpc.referee.bound.intervals import interval_risks
from radmpc.referee.bound.persistence import best_shares
from radmpc.referee.bound.search import NEGLIGIBLE, best_directions
from radmpc.referee.encounters import Encounters, blocks, instant_sites, interval_sites
from radmpc.referee.motion import FleetMotion
from radmpc.referee.sites import Sites

__all__ = ["WindowHalfspaces", "instant_risks", "step_risks", "window_halfspaces"]

_INTEGRATED = 4096
"""Sites that are integrated at once [-]: memory, some 4 kB each, against the calls per block."""


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
        found = instant_risks(encounters)
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

    Parameters
    ----------
    encounters : Encounters
        B of them, at steps.
    """
    count, steps, d = encounters.means.shape
    risks = np.empty((count, steps))
    close: list[tuple[Sites, Matrix]] = []
    which: list[Indices] = []
    start = 0
    for block in blocks(encounters):
        sites = instant_sites(block)
        best, found = best_directions(sites, block.directions, steps)
        # The search tells apart what fails for certain: that is no probability.
        risks[start : start + len(block.means)] = np.minimum(found, 1.0).reshape(-1, steps)
        worth = np.flatnonzero(found > NEGLIGIBLE)
        close.append((sites.take(worth), best[worth]))
        which.append(start * steps + worth)
        start += len(block.means)
    # Integrals are of Gaussians.
    if d == 2 and encounters.samples is None:
        _integrate(risks.reshape(-1), close, np.concatenate(which))
    return risks


def _integrate(risks: Vector, close: Sequence[tuple[Sites, Matrix]], which: Indices) -> None:
    """Put probabilities in the place of half-spaces where these tell, all blocks' together."""
    if not which.size:
        # Who meets nobody is not integrated.
        return
    from radmpc.referee.bound.planar import grown_polygon_risks  # noqa: PLC0415 - near pairs alone

    means, covariances, vertices, radii = (
        np.concatenate(each)
        for each in zip(
            *((s.means[:, 0], s.covariances[:, 0], s.vertices[:, 0], s.radii) for s, _ in close),
            strict=True,
        )
    )
    normals = np.concatenate([best for _, best in close])
    for begin in range(0, which.size, _INTEGRATED):
        part = slice(begin, begin + _INTEGRATED)
        risks[which[part]] = grown_polygon_risks(
            means[part],
            covariances[part],
            vertices[part],
            radii[part],
            normals[part],
            risks[which[part]],
        )
