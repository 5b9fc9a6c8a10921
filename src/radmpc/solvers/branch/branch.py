"""Solver ``branch``: vehicles solved apart as long as their solutions do not conflict.

Every block (vehicle) is first solved alone. Blocks whose solutions violate an avoidance between
them are merged and solved together, and so on (independence detection, Standley 2010). Dropping
avoidances relaxes, so the sum of the groups' bounds bounds the whole; once nothing is violated
the sum of their costs is a solution. What a smaller group was proven to cost enters the larger
one's linear program as a row: ``cost of S >= v(S)``.
"""

from __future__ import annotations

import time

import numpy as np

from radmpc.arrays import Indices, Vector
from radmpc.program.program import DisjunctiveProgram
from radmpc.records import dataclass
from radmpc.solvers.solution import Guide, Limits, Outcome, Solution, Solver
from radmpc.wording import changed_texts, with_options

__all__ = ["Branch"]


@dataclass(frozen=True, slots=True)
class Branch(Solver):
    """Disjunctive branch and bound; anytime, repeatable under a node limit.

    Attributes
    ----------
    max_nodes : int
        Nodes after which the search stops with what it has.
    """

    max_nodes: int = 5_000

    def __str__(self) -> str:
        return with_options("branch", *changed_texts(self, Branch(), "max_nodes"))

    def solve(
        self,
        program: DisjunctiveProgram,
        margins: Vector,
        *,
        gap: float,
        limits: Limits,
        start: Indices | None = None,
        guide: Guide | None = None,
        rng: np.random.Generator | None = None,
    ) -> Solution:
        """Minimize the cost at fixed margins; see `radmpc.solvers.solution.Solver`.

        Parameters
        ----------
        program, margins, gap, limits, start, guide
            As there.
        rng
            Ignored: the search is deterministic.
        """
        del rng  # deterministic
        begun = time.perf_counter()
        if np.any(np.diff(program.avoidance_starts) == 0):
            return Solution(Outcome.INFEASIBLE, None, None, float("inf"), float("inf"))
        # Who asks for a policy that has trees of its own never waits for these.
        from radmpc.solvers.branch.groups import Groups  # noqa: PLC0415 - other policies do without

        groups = Groups(program, margins, gap, limits, self.max_nodes, start, guide)
        return groups.solve(begun)
