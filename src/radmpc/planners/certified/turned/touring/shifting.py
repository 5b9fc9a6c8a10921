"""Visits a step sooner or later, one at a time, and paths that make them then."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from radmpc.arrays import Matrix
from radmpc.program.condensed import CondensedModel
from radmpc.program.visits.columns import windows_of

__all__ = ["shifted", "warped"]


def shifted(
    model: CondensedModel, steps: Sequence[int], by: Sequence[int] = (-1, 1)
) -> Iterator[tuple[int, ...]]:
    """Yield steps of visits of which one is moved, within its window and in order.

    Parameters
    ----------
    model : CondensedModel
        The vehicle, visits at any step of their windows.
    steps : sequence of int
        Those that are given, rising.
    by : sequence of int
        Steps to move one by [-].
    """
    before = (-1, *steps[:-1])
    after = (*steps[1:], model.horizon + 1)
    for j, (first, last) in enumerate(windows_of(model)):
        for moved in (steps[j] + each for each in by):
            if max(first, before[j] + 1) <= moved <= min(last, after[j] - 1):
                yield (*steps[:j], moved, *steps[j + 1 :])


def warped(path: Matrix, before: Sequence[int], after: Sequence[int]) -> Matrix:
    """Return a path that is at other steps where it was at given ones, (T+1, d) [m].

    Parameters
    ----------
    path : (T+1, d) array
        Positions [m].
    before, after : sequence of int
        Steps, rising, from 1 to T - 1.
    """
    last = len(path) - 1
    every = np.arange(last + 1)
    times = np.interp(every, (0, *after, last), (0, *before, last))
    return np.stack([np.interp(times, every, path[:, a]) for a in range(path.shape[1])], axis=1)
