"""Where to branch: which avoidance, and its sides in which order."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from radmpc.program.program import DisjunctiveProgram
from radmpc.solvers.priced.rating import Rater, Rating

__all__ = ["BranchingChoice"]

_SECOND_WEIGHT = 0.5
"""What the second best side counts, beside the best, in how hard an avoidance is."""


class BranchingChoice:
    """What a search has learned of a program's avoidances.

    Parameters
    ----------
    program : DisjunctiveProgram
        The program.
    rater : Rater
        The same, laid out for rating.
    """

    def __init__(self, program: DisjunctiveProgram, rater: Rater) -> None:
        self._table = rater.table
        self._weights = np.ones(program.num_avoidances)
        self._owner = program.layout.owners

    def failed(self, side: int) -> None:
        """Note that choosing a side ended a branch."""
        self._weights[self._owner[side]] += 1.0

    def most_promising(
        self, chosen: Sequence[int], rating: Rating, *, has_plan: bool
    ) -> tuple[int | None, bool]:
        """Return the avoidance to branch on, and whether any is far from kept."""
        if rating.cheapest.size == 0:
            return None, False
        free = np.ones(rating.cheapest.size, dtype=bool)
        free[self._owner[list(chosen)]] = False
        least = np.where(free, rating.short.min(axis=1), -np.inf)
        violated = np.flatnonzero(least > 0.0)
        if violated.size == 0:
            risks = np.where(free, rating.cheapest, 0.0)
            worst = int(risks.argmax())
            return (worst if risks[worst] > 0.0 else None), False
        if not has_plan or rating.short.shape[1] == 1:
            # Without a solution, what failed often fails early: begin there (Boussemart 2004).
            return int(violated[(least[violated] * self._weights[violated]).argmax()]), True
        nearest = np.partition(rating.short[violated], 1, axis=1)[:, :2]
        second = np.where(np.isfinite(nearest[:, 1]), nearest[:, 1], 2.0 * nearest[:, 0] + 5.0)
        return int(violated[(nearest[:, 0] + _SECOND_WEIGHT * second).argmax()]), True

    def alternatives(self, avoidance: int, rating: Rating) -> tuple[int, ...]:
        """Return the possible alternatives of an avoidance, the one violated least first."""
        short = rating.short[avoidance]
        order = [int(i) for i in short.argsort(kind="stable") if np.isfinite(short[i])]
        return tuple(int(self._table[avoidance, i]) for i in order)
