"""Where to branch: on which avoidance, and its alternatives in which order."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from radmpc.arrays import Indices, Vector
from radmpc.program.program import DisjunctiveProgram
from radmpc.solvers.compiled_code import is_compiled
from radmpc.solvers.priced.rating import Rater, Rating
from radmpc.solvers.priced.tuning import TUNING

if is_compiled():
    from radmpc.solvers import _compiled

__all__ = ["FACTORS", "BranchingChoice"]

_INF = float("inf")

FACTORS = np.array([TUNING.second_weight, TUNING.missing_factor, TUNING.missing_length])
"""As compiled code takes them (`choose_avoidance`)."""


class BranchingChoice:
    """Which avoidance to branch on, by violations and by how often a choice failed.

    Parameters
    ----------
    program : DisjunctiveProgram
        The program.
    rater : Rater
        The same, laid out for rating.

    Attributes
    ----------
    owners : (a,) int array
        The avoidance of each alternative.
    is_refined : (a,) bool array
        Whether others refine it.
    weights : (v,) array
        How often alternatives of an avoidance ended a branch, and one more [-].
    """

    def __init__(self, program: DisjunctiveProgram, rater: Rater) -> None:
        self._table = rater.table
        self.weights = np.ones(program.num_avoidances)
        self.owners = program.layout.owners
        parents = program.parents
        self._parents: Indices = (
            np.full(program.num_alternatives, -1) if parents is None else parents
        )
        # One number of an array costs more than one of a view.
        self._owners, self._outer = self.owners.data, self._parents.data
        self.is_refined = np.zeros(program.num_alternatives, dtype=bool)
        self.is_refined[self._parents[self._parents >= 0]] = True
        self._steps: dict[tuple[int, int], list[int]] = {}

    def failed(self, alternative: int) -> None:
        """Note that choosing an alternative ended a branch."""
        self.weights[self.owners[alternative]] += 1.0

    def most_promising(
        self, chosen: Sequence[int], rating: Rating, *, has_plan: bool
    ) -> tuple[int | None, bool]:
        """Return the avoidance to branch on, and whether any is violated.

        Parameters
        ----------
        chosen : sequence of int
            The node's alternatives; their avoidances are decided.
        rating : Rating
            Of the node's point.
        has_plan : bool
            Whether the search has an incumbent.

        Returns
        -------
        (int or None, bool)
            None where nothing is left to decide; and whether an undecided avoidance misses the
            reference clearance.
        """
        if rating.cheapest.size == 0:
            return None, False
        is_decided = np.zeros(rating.cheapest.size, dtype=bool)
        decided = np.array(chosen, dtype=np.int64)
        is_decided[self.owners[decided[~self.is_refined[decided]]]] = True
        # Without a solution, what failed often fails early: begin there (Boussemart 2004).
        by_weight = not has_plan or rating.short.shape[1] == 1
        if is_compiled():
            parts = rating.short, rating.cheapest, is_decided, self.weights, FACTORS
            worst, is_blunt = _compiled.choose_avoidance(*parts, by_weight)
            return (worst if worst >= 0 else None), bool(is_blunt)
        return self._worst(~is_decided, rating, by_weight=by_weight)

    def _worst(
        self, free: npt.NDArray[np.bool_], rating: Rating, *, by_weight: bool
    ) -> tuple[int | None, bool]:
        """Choose among free avoidances without compiled code."""
        least = np.where(free, rating.short.min(axis=1), -np.inf)
        violated = np.flatnonzero(least > 0.0)
        if violated.size == 0:
            risks = np.where(free, rating.cheapest, 0.0)
            worst = int(risks.argmax())
            return (worst if risks[worst] > 0.0 else None), False
        if by_weight:
            return int(violated[(least[violated] * self.weights[violated]).argmax()]), True
        nearest = np.partition(rating.short[violated], 1, axis=1)[:, :2]
        second = np.where(
            np.isfinite(nearest[:, 1]),
            nearest[:, 1],
            TUNING.missing_factor * nearest[:, 0] + TUNING.missing_length,
        )
        return int(violated[(nearest[:, 0] + TUNING.second_weight * second).argmax()]), True

    def alternatives(self, avoidance: int, chosen: Sequence[int], short: Vector) -> tuple[int, ...]:
        """Return the alternatives of an avoidance to choose from, the one violated least first.

        Where one is chosen that others refine, these; otherwise those that refine no other.

        Parameters
        ----------
        avoidance : int
            Its number.
        chosen : sequence of int
            The node's alternatives.
        short : (w,) array
            By how much each of its alternatives misses the reference clearance [m].
        """
        outer = -1
        for alternative in chosen:
            if self._owners[alternative] == avoidance:
                outer = alternative
                break
        steps = self._steps.get((avoidance, outer))
        if steps is None:
            every = self._table[avoidance].tolist()
            steps = self._steps[avoidance, outer] = self._steps_to(every, outer)
        missed = short.tolist()
        # By what is missed alone: where two miss as much, the first stays first.
        order = sorted(range(len(missed)), key=missed.__getitem__)
        found = dict.fromkeys([steps[k] for k in order if missed[k] < _INF])
        found.pop(-1, None)
        return tuple(found)

    def replaced(self, chosen: tuple[int, ...], alternative: int) -> tuple[int, ...]:
        """Return a node's alternatives with one more, in place of the one that it refines.

        Parameters
        ----------
        chosen : tuple of int
            The node's alternatives.
        alternative : int
            The one more.
        """
        outer = self._outer[alternative]
        if outer not in chosen:
            return (*chosen, alternative)
        return (*[c for c in chosen if c != outer], alternative)

    def _steps_to(self, alternatives: Sequence[int], outer: int) -> list[int]:
        """Return the next steps from alternatives to one that these refine; -1 if they do not."""
        steps, above = [], self._outer
        for alternative in alternatives:
            step = alternative
            while step >= 0 and above[step] != outer:
                step = above[step]
            steps.append(step)
        return steps
