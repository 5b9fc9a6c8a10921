"""The groups of blocks that `branch` solves together, each with its tree."""

from __future__ import annotations

import time

import numpy as np
from scipy.sparse import csr_array

from radmpc.arrays import Indices, Vector
from radmpc.program.program import DisjunctiveProgram
from radmpc.program.restrict import Restriction, avoidance_blocks, restrict
from radmpc.solvers.branch.neighborhood import improve, prioritize
from radmpc.solvers.branch.tree import Tree
from radmpc.solvers.lp.warm_lp import CostRow
from radmpc.solvers.selection import least_violated, violations_of
from radmpc.solvers.solution import Guide, Limits, Outcome, Solution, relative_gap

__all__ = ["Groups"]

_TOUCH_TOL = 1e-7
"""Violation from which two groups conflict [m]: above the trees' own tolerance, so that only
avoidances between groups count."""

_EASY_NODES = 60
"""Nodes per block that a group's tree gets before heuristics look for an incumbent [-]: fewer spend
heuristics on groups that close at once."""


class Groups:
    """The running state: which vehicles are solved together, and their solutions."""

    def __init__(
        self,
        program: DisjunctiveProgram,
        margins: Vector,
        gap: float,
        limits: Limits,
        max_nodes: int,
        start: Indices | None,
        guide: Guide | None,
    ) -> None:
        self.program = program
        self.margins = margins
        self.gap = gap
        self.limits = limits
        self.max_nodes = max_nodes
        self.start = start
        self.guide = guide
        self.nodes = 0
        self.lps = 0
        self.cost = float("inf")
        self.z: Vector | None = None
        self.touched: csr_array = avoidance_blocks(program)
        self.whole = frozenset(range(int(self.touched.shape[1])))
        self.bounds: dict[frozenset[int], float] = {}
        self.solved: dict[frozenset[int], tuple[Restriction, Vector | None]] = {}

    def solve(self, begun: float) -> Solution:
        """Merge and solve until the groups' solutions do not conflict."""
        if self._is_trivially_infeasible():
            return Solution(Outcome.INFEASIBLE, None, None, float("inf"), float("inf"))
        groups = [frozenset({block}) for block in sorted(self.whole)]
        while True:
            for group in groups:
                if group not in self.solved:
                    self._grow(group)
                if self.bounds[group] == float("inf"):
                    return self._answer(begun, float("inf"))
            bound = sum(self.bounds[group] for group in groups)
            conflicts = self._conflicts(groups)
            if not conflicts or len(groups) == 1:
                return self._answer(begun, bound)
            if relative_gap(self.cost, bound) <= self.gap:
                return self._answer(begun, bound)
            if self.nodes >= self.max_nodes or self.limits.reached:
                self._seek(self.whole)
                return self._answer(begun, bound)
            groups = _merged(groups, conflicts)

    def _grow(self, group: frozenset[int]) -> None:
        """Solve one group by a tree of its own."""
        part = restrict(self.program, np.array(sorted(group)), self.touched)
        tree = self._tree(part, group)
        left = max(self.max_nodes - self.nodes, 1)
        if self.start is not None:
            tree.try_selection(self._start_of(part))
        if len(group) == 1:
            tree.run(left)
        else:
            tree.run(min(left, _EASY_NODES * len(group)))
            if tree.is_limited:
                self._help(part, tree)
                tree.run(max(left - tree.nodes, 1))
        self.nodes += tree.nodes
        self.lps += tree.lps
        parts = [value for other, value in self.bounds.items() if other < group]
        self.bounds[group] = max([tree.bound, *parts])
        self.solved[group] = (part, tree.z)

    def _start_of(self, part: Restriction) -> Indices:
        """Return the start's selection of a group, in the group's own numbers."""
        if self.start is None:
            return np.zeros(0, dtype=np.int64)
        return np.searchsorted(part.alternatives, self.start[part.avoidances])

    def _tree(self, part: Restriction, group: frozenset[int]) -> Tree:
        """Return a tree that knows what smaller groups cost."""
        blocks = part.program.blocks
        rows = [
            CostRow(np.flatnonzero(np.isin(blocks, list(other))), bound)
            for other, bound in self.bounds.items()
            if other < group
        ]
        margins = self.margins[part.rows]
        return Tree(part.program, margins, gap=self.gap, limits=self.limits, cost_rows=rows)

    def _help(self, part: Restriction, tree: Tree) -> None:
        """Look for a good incumbent: from the guide, else by planning one block at a time."""
        margins = self.margins[part.rows]
        if self.start is None and self.guide is not None:
            self.start, self.guide = self.guide(), None
            if self.start is not None:
                tree.try_selection(self._start_of(part))
        z = tree.z
        if z is None:
            alone = np.zeros(part.program.num_columns)
            for block in np.unique(part.program.blocks):
                z_block = self.solved[frozenset({int(block)})][1]
                if z_block is None:
                    return
                alone[part.program.blocks == block] = z_block
            z = prioritize(part.program, margins, alone, limits=self.limits)
        if z is not None:
            tree.try_point(improve(part.program, margins, z, gap=self.gap, limits=self.limits))

    def _seek(self, group: frozenset[int]) -> None:
        """Look for any solution of the whole once a limit has ended the proof."""
        if self.cost < float("inf") or self.limits.reached:
            return
        part = restrict(self.program, np.array(sorted(group)), self.touched)
        tree = self._tree(part, group)
        self._help(part, tree)
        if tree.z is None:
            tree.run(_EASY_NODES * len(group))
        self.nodes += tree.nodes
        self.lps += tree.lps
        if tree.z is not None:
            self._note(tree.z)

    def _conflicts(self, groups: list[frozenset[int]]) -> list[tuple[int, int]]:
        """Return pairs of groups in conflict, worst first; keep a solution of the whole."""
        z = np.zeros(self.program.num_columns)
        for group in groups:
            part, found = self.solved[group]
            if found is None:
                # A limit left the group without a solution: nothing to compare.
                return [(0, 1)] if len(groups) > 1 else []
            z[part.columns] = found
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
            if members:
                pairs.append((members[0], members[-1]))
        return pairs

    def _note(self, z: Vector) -> None:
        """Keep a solution of the whole if it is the best."""
        cost = float(self.program.cost @ z)
        if cost < self.cost:
            self.cost, self.z = cost, z

    def _answer(self, begun: float, bound: float) -> Solution:
        """Return the answer so far."""
        if self.start is not None and self.z is None:
            self._try_start()
        bound = min(bound, self.cost)
        if self.z is not None:
            closed = relative_gap(self.cost, bound) <= self.gap * (1.0 + 1e-6)
            outcome = Outcome.OPTIMAL if closed else Outcome.FEASIBLE
        else:
            outcome = Outcome.INFEASIBLE if bound == float("inf") else Outcome.LIMIT
        selection = None
        if self.z is not None:
            violations = violations_of(self.program, self.margins, self.z)
            selection = least_violated(self.program, violations)
        return Solution(
            outcome=outcome,
            z=self.z,
            selection=selection,
            cost=self.cost,
            bound=bound,
            nodes=self.nodes,
            lps=self.lps,
            seconds=time.perf_counter() - begun,
        )

    def _try_start(self) -> None:
        """Solve the whole with the alternatives of the start, for want of anything better."""
        if self.start is None:
            return
        part = restrict(self.program, np.array(sorted(self.whole)), self.touched)
        tree = self._tree(part, frozenset())
        tree.try_selection(self.start)
        self.lps += tree.lps
        if tree.z is not None:
            self._note(tree.z)

    def _is_trivially_infeasible(self) -> bool:
        """Whether an avoidance that no control touches is violated."""
        untouched = np.diff(self.touched.indptr) == 0
        if not untouched.any():
            return False
        program = self.program
        least = np.minimum.reduceat(
            violations_of(program, self.margins, np.zeros(program.num_columns)),
            program.avoidance_starts[:-1],
        )
        return bool(np.any(least[untouched] > _TOUCH_TOL))


def _merged(groups: list[frozenset[int]], conflicts: list[tuple[int, int]]) -> list[frozenset[int]]:
    """Merge pairs of groups, worst conflict first, each group at most once a round."""
    merged: set[int] = set()
    result = []
    for i, j in conflicts:
        if i not in merged and j not in merged:
            merged |= {i, j}
            result.append(groups[i] | groups[j])
    return [*result, *(g for i, g in enumerate(groups) if i not in merged)]
