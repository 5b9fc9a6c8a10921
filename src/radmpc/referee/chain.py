"""Which half-space to hold over each interval, when neighbours may share one."""

from __future__ import annotations

import numpy as np

from radmpc.arrays import Indices, Tensor, Vector

__all__ = ["cheapest_chain"]


def cheapest_chain(near: Tensor, far: Tensor) -> Vector:
    """Return the risk charged to every step by the best choice of one direction per interval.

    Interval j holds direction c at its ends: ``near[:, j, c]`` at step j, ``far[:, j, c]`` at step
    j+1. If j and j+1 hold the same direction, their events at step j+1 are ``n·δ < −margin`` with
    the same n and nested: the union has the larger of the two probabilities. Otherwise both are
    charged. The best choice is a shortest path.

    Parameters
    ----------
    near, far : (B, K, C) array
        Risk of each candidate at the start and the end of each interval.

    Returns
    -------
    (B, K+1) array
        Risk per step; the sum over steps is the least one.
    """
    num_intervals = near.shape[1]
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
    choice = (value + far[:, -1]).argmin(axis=1)
    return _charges(near, far, came_from, choice)


def _charges(near: Tensor, far: Tensor, came_from: list[Indices], last: Indices) -> Vector:
    """Walk the chosen path backwards and write down what each step costs."""
    rows = np.arange(len(near))
    risks = np.zeros((len(near), near.shape[1] + 1))
    choice = last
    risks[:, -1] = far[rows, -1, choice]
    for j in range(near.shape[1] - 1, 0, -1):
        before = came_from[j - 1][rows, choice]
        left, right = far[rows, j - 1, before], near[rows, j, choice]
        risks[:, j] = np.where(before == choice, np.maximum(left, right), left + right)
        choice = before
    risks[:, 0] = near[rows, 0, choice]
    return risks
