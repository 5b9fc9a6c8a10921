"""Which half-space to hold over each interval, when neighbours may share one.

Interval j holds a direction at its ends: ``near`` is the risk at step j, ``far`` at step j+1. If
j and j+1 hold the same direction n, their events at step j+1 are ``n·δ < −margin`` with one n and
so nested: the union has the larger of the two probabilities. Otherwise both are charged. A *run*
is a stretch of intervals that hold the same direction.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from radmpc.arrays import Indices, Matrix, Tensor, Vector

__all__ = ["chain_charges", "cheapest_chain", "run_scores"]

Flags = npt.NDArray[np.bool_]


def cheapest_chain(near: Tensor, far: Tensor) -> Indices:
    """Return the best choice of one direction per interval: a shortest path.

    Parameters
    ----------
    near, far : (B, K, C) array
        Risk of each candidate at the start and the end of each interval.

    Returns
    -------
    (B, K) int array
        Candidates.
    """
    count, num_intervals, _ = near.shape
    value = near[:, 0]
    came_from: list[Indices] = []
    own = np.arange(near.shape[2])
    for j in range(1, num_intervals):
        left = value + far[:, j - 1]
        switch = left.argmin(axis=1)
        moved = np.take_along_axis(left, switch[:, None], axis=1) + near[:, j]
        stayed = value + np.maximum(far[:, j - 1], near[:, j])
        came_from.append(np.where(stayed <= moved, own, switch[:, None]))
        value = np.minimum(stayed, moved)
    choices = np.empty((count, num_intervals), dtype=np.int64)
    choices[:, -1] = (value + far[:, -1]).argmin(axis=1)
    for j in range(num_intervals - 1, 0, -1):
        choices[:, j - 1] = came_from[j - 1][np.arange(count), choices[:, j]]
    return choices


def chain_charges(near: Matrix, far: Matrix, begins: Flags) -> Vector:
    """Return what a chain costs at every step.

    Parameters
    ----------
    near, far : (B, K) array
        Risks of the chosen directions.
    begins : (B, K) bool array
        Where a run begins; always at the first interval.

    Returns
    -------
    (B, K+1) array
        Risk per step.
    """
    left, right = far[:, :-1], near[:, 1:]
    inner = np.where(begins[:, 1:], left + right, np.maximum(left, right))
    return np.concatenate([near[:, :1], inner, far[:, -1:]], axis=1)


def run_scores(risks: Tensor, begins: Flags) -> Tensor:
    """Return what the whole run of each interval costs, for several directions.

    Parameters
    ----------
    risks : (S, P, 2) array
        Risks at both ends of consecutive intervals.
    begins : (S,) bool array
        Where a run begins.

    Returns
    -------
    (S, P) array
        Equal for all intervals of a run.
    """
    near, far = risks[:, :, 0], risks[:, :, 1]
    before = np.concatenate([np.zeros_like(far[:1]), far[:-1]])
    cost = np.where(begins[:, None], near, np.maximum(before, near))
    ends = np.append(begins[1:], True)
    cost += np.where(ends[:, None], far, 0.0)
    totals = np.add.reduceat(cost, np.flatnonzero(begins), axis=0)
    return np.asarray(totals[np.cumsum(begins) - 1])
