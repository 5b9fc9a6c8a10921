"""Which half-space to hold over each interval, when consecutive ones may share it.

Interval j holds a direction at its ends: ``near`` are the risks at step j, ``far`` is that at step
j+1. The first of ``near`` is that of the position, a second one that of what feedback makes of it
during the interval, charged on its own. If j and j+1 hold the same direction n, their events at
step j+1 are ``n·δ < −margin`` with one n and so nested: the union has the larger of the two
probabilities. Otherwise both are charged. A *run* is a stretch of intervals that hold the same
direction.
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
    near : (B, K, C, 1 or 2) array
        Risks of each candidate at the start of each interval.
    far : (B, K, C) array
        Risk at its end.

    Returns
    -------
    (B, K) int array
        Candidates.
    """
    count, num_intervals, num, _ = near.shape
    bent = near[..., 1:].sum(axis=3)
    near = near[..., 0]
    value = near[:, 0] + bent[:, 0]
    came_from: list[Indices] = []
    own = np.arange(num)
    for j in range(1, num_intervals):
        left = value + far[:, j - 1]
        switch = left.argmin(axis=1)
        moved = np.take_along_axis(left, switch[:, None], axis=1) + near[:, j] + bent[:, j]
        stayed = value + np.maximum(far[:, j - 1], near[:, j]) + bent[:, j]
        came_from.append(np.where(stayed <= moved, own, switch[:, None]))
        value = np.minimum(stayed, moved)
    choices = np.empty((count, num_intervals), dtype=np.int64)
    choices[:, -1] = (value + far[:, -1]).argmin(axis=1)
    for j in range(num_intervals - 1, 0, -1):
        choices[:, j - 1] = came_from[j - 1][np.arange(count), choices[:, j]]
    return choices


def chain_charges(near: Tensor, far: Matrix, begins: Flags) -> Vector:
    """Return what a chain costs at every step.

    Parameters
    ----------
    near : (B, K, 1 or 2) array
        Risks of the chosen directions at the start of each interval.
    far : (B, K) array
        Risks at its end.
    begins : (B, K) bool array
        Where a run begins; always at the first interval.

    Returns
    -------
    (B, K+1) array
        Risk per step.
    """
    bent, near = near[..., 1:].sum(axis=2), near[..., 0]
    left, right = far[:, :-1], near[:, 1:]
    inner = np.where(begins[:, 1:], left + right, np.maximum(left, right))
    charged = np.concatenate([near[:, :1], inner, far[:, -1:]], axis=1)
    charged[:, :-1] += bent
    return charged


def run_scores(risks: Tensor, begins: Flags) -> Tensor:
    """Return what the whole run of each interval costs, for several directions.

    Parameters
    ----------
    risks : (S, P, 2 or 3) array
        Risks at the ends of consecutive intervals: near, bent near if any, far.
    begins : (S,) bool array
        Where a run begins.

    Returns
    -------
    (S, P) array
        Equal for all intervals of a run.
    """
    near, far = risks[:, :, 0], risks[:, :, -1]
    before = np.concatenate([np.zeros_like(far[:1]), far[:-1]])
    cost = np.where(begins[:, None], near, np.maximum(before, near))
    ends = np.append(begins[1:], True)
    cost += risks[:, :, 1:-1].sum(axis=2)
    cost += np.where(ends[:, None], far, 0.0)
    totals = np.add.reduceat(cost, np.flatnonzero(begins), axis=0)
    return np.asarray(totals[np.cumsum(begins) - 1])
