"""Solver ``branch``: vehicles solved apart as long as they keep out of each other's way.

Every block (vehicle) is first solved alone. Blocks whose solutions violate an avoidance between
them are merged and solved together, and so on (independence detection, Standley 2010). Dropping
avoidances relaxes, so the sum of the groups' bounds bounds the whole; once nothing is violated
the sum of their costs is a solution. What a smaller group was proven to cost enters the larger
one's linear programme as a row: ``cost of S >= v(S)``.
"""

from __future__ import annotations

import time
from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_array

from radmpc.arrays import Indices, Vector
from radmpc.program.program import DisjunctiveProgram
from radmpc.program.restrict import Restriction, avoidance_blocks, restrict
from radmpc.solvers.lp import CostRow
from radmpc.solvers.selection import least_violated, violations_of
from radmpc.solvers.solution import Limits, Outcome, Solution, relative_gap
from radmpc.solvers.tree import Tree

__all__ = ["Branch"]

_TOUCH_TOL = 1e-7
"""Above the trees' own tolerance, so that only what lies between groups counts."""


@dataclass(frozen=True, slots=True)
class Branch:
    """Disjunctive branch and bound; anytime, repeatable for a node limit.

    Attributes
    ----------
    max_nodes : int
        Nodes after which the search stops with what it has.
    """

    max_nodes: int = 20_000

    def __str__(self) -> str:
        return "branch"

    def solve(
        self,
        program: DisjunctiveProgram,
        margins: Vector,
        *,
        gap: float,
        limits: Limits,
        start: Indices | None = None,
    ) -> Solution:
        """Minimise the cost at fixed margins; see `radmpc.solvers.solution.Solver`."""
        begun = time.perf_counter()
        if np.any(np.diff(program.avoidance_starts) == 0):
            return Solution(Outcome.INFEASIBLE, None, None, float("inf"), float("inf"))
        return _Groups(program, margins, gap, limits, self.max_nodes, start).solve(begun)


class _Groups:
    """The running state: groups of blocks, each with its tree."""

    def __init__(
        self,
        program: DisjunctiveProgram,
        margins: Vector,
        gap: float,
        limits: Limits,
        max_nodes: int,
        start: Indices | None,
    ) -> None:
        self.program = program
        self.margins = margins
        self.gap = gap
        self.limits = limits
        self.max_nodes = max_nodes
        self.start = start
        self.nodes = 0
        self.lps = 0
        self.cost = float("inf")
        self.z: Vector | None = None
        self.touched: csr_array = avoidance_blocks(program)
        self.known: dict[frozenset[int], float] = {}
        self.trees: dict[frozenset[int], tuple[Restriction, Tree]] = {}

    def solve(self, begun: float) -> Solution:
        """Merge and solve until the groups' solutions go together."""
        num_blocks = int(self.touched.shape[1])
        groups = [frozenset({b}) for b in range(num_blocks)]
        has_dived = self.start is not None
        while True:
            for group in groups:
                if group not in self.trees:
                    self._grow(group)
                if self.known[group] == float("inf"):
                    return self._answer(begun, float("inf"))
            bound = sum(self.known[group] for group in groups)
            conflicts = self._conflicts(groups)
            if not conflicts:
                return self._answer(begun, bound)
            if not has_dived:
                has_dived = True
                self._dive(num_blocks)
            if self._is_limited() or relative_gap(self.cost, bound) <= self.gap:
                return self._answer(begun, bound)
            groups = _merged(groups, conflicts)

    def _grow(self, group: frozenset[int]) -> None:
        """Solve one group by a tree of its own."""
        whole = len(group) == self.touched.shape[1]
        part = restrict(self.program, np.array(sorted(group)), self.touched)
        tree = self._tree(part, group, self.max_nodes - self.nodes)
        if self.start is not None:
            tree.try_selection(np.searchsorted(part.alternatives, self.start[part.avoidances]))
        elif whole and self.z is not None:
            tree.try_selection(self._selection(self.z))
        tree.run()
        self.nodes += tree.nodes
        self.lps += tree.lps
        known = [value for other, value in self.known.items() if other < group]
        self.known[group] = max([tree.bound, *known]) if tree.is_limited else tree.bound
        self.trees[group] = (part, tree)

    def _tree(self, part: Restriction, group: frozenset[int], max_nodes: int) -> Tree:
        """Return a tree that knows what smaller groups cost."""
        blocks = part.program.blocks
        rows = [
            CostRow(np.flatnonzero(np.isin(blocks, list(other))), bound)
            for other, bound in self.known.items()
            if other < group
        ]
        return Tree(
            part.program,
            self.margins[part.rows],
            gap=self.gap,
            limits=self.limits,
            max_nodes=max(max_nodes, 1),
            cost_rows=rows,
        )

    def _conflicts(self, groups: list[frozenset[int]]) -> list[tuple[int, int]]:
        """Return pairs of groups whose solutions collide, worst first; note good wholes."""
        z = np.zeros(self.program.num_columns)
        for group in groups:
            part, tree = self.trees[group]
            if tree.z is None:
                return []
            z[part.columns] = tree.z
        violations = violations_of(self.program, self.margins, z)
        if violations.size:
            worst = np.minimum.reduceat(violations, self.program.avoidance_starts[:-1])
        else:
            worst = np.zeros(0)
        violated = np.flatnonzero(worst > _TOUCH_TOL)
        if violated.size == 0:
            self._note(z)
            return []
        owner = {block: g for g, group in enumerate(groups) for block in group}
        ranked = violated[np.argsort(-worst[violated], kind="stable")]
        pairs = []
        for avoidance in ranked:
            span = self.touched.indptr[avoidance : avoidance + 2]
            members = sorted({owner[int(b)] for b in self.touched.indices[span[0] : span[1]]})
            pairs.append((members[0], members[-1]))
        return pairs

    def _dive(self, num_blocks: int) -> None:
        """Look for any solution of the whole, so that a limit never leaves empty-handed."""
        part = restrict(self.program, np.arange(num_blocks), self.touched)
        tree = self._tree(part, frozenset(range(num_blocks)), 2 * self.program.num_avoidances)
        tree.gap = 1.0 - 1e-9
        tree.run()
        self.nodes += tree.nodes
        self.lps += tree.lps
        if tree.z is not None:
            self._note(tree.z)

    def _note(self, z: Vector) -> None:
        """Keep a solution of the whole if it is the best."""
        cost = float(self.program.cost @ z)
        if cost < self.cost:
            self.cost, self.z = cost, z

    def _is_limited(self) -> bool:
        """Whether the search must end."""
        return self.nodes >= self.max_nodes or self.limits.reached

    def _selection(self, z: Vector) -> Indices:
        """Return the alternatives a point satisfies best."""
        return least_violated(self.program, violations_of(self.program, self.margins, z))

    def _answer(self, begun: float, bound: float) -> Solution:
        """Return the answer as it stands."""
        if self.start is not None:
            self._try_start()
        bound = min(bound, self.cost)
        if self.z is not None:
            closed = relative_gap(self.cost, bound) <= self.gap * (1.0 + 1e-6)
            outcome = Outcome.OPTIMAL if closed else Outcome.FEASIBLE
        else:
            outcome = Outcome.INFEASIBLE if bound == float("inf") else Outcome.LIMIT
        return Solution(
            outcome=outcome,
            z=self.z,
            selection=None if self.z is None else self._selection(self.z),
            cost=self.cost,
            bound=bound,
            nodes=self.nodes,
            lps=self.lps,
            seconds=time.perf_counter() - begun,
        )

    def _try_start(self) -> None:
        """Solve the whole on the sides of the start: it may beat a search cut short."""
        if self.start is None or self.cost < float("inf"):
            return
        tree = self._tree(
            restrict(self.program, np.arange(int(self.touched.shape[1])), self.touched),
            frozenset(),
            1,
        )
        tree.try_selection(self.start)
        self.lps += tree.lps
        if tree.z is not None:
            self._note(tree.z)


def _merged(groups: list[frozenset[int]], conflicts: list[tuple[int, int]]) -> list[frozenset[int]]:
    """Merge pairs of groups, worst conflict first, each group at most once a round."""
    taken: set[int] = set()
    result = []
    for i, j in conflicts:
        if i not in taken and j not in taken:
            taken |= {i, j}
            result.append(groups[i] | groups[j])
    return [*result, *(g for i, g in enumerate(groups) if i not in taken)]
