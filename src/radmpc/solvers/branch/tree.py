"""Disjunctive branch and bound over one warm linear program, at fixed margins.

A node is a set of chosen alternatives. Its linear program holds their rows only, so its
optimum bounds every solution that chooses them. Where the optimum violates some avoidance, the
node splits into one child per alternative of one such avoidance. Children are kept disjoint:
a later child takes the opposite of its earlier siblings' rows, so that no solution is found twice.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from radmpc.arrays import Indices, Vector
from radmpc.program.program import DisjunctiveProgram
from radmpc.records import dataclass
from radmpc.solvers.diving import Dives, OpenNode
from radmpc.solvers.lp.outcome import LpOutcome
from radmpc.solvers.lp.warm_lp import CostRow, WarmLp
from radmpc.solvers.selection import alternative_table, possible_alternatives, violations_of
from radmpc.solvers.solution import Limits, cutoff_below, relative_gap

__all__ = ["Tree"]

_VIOLATION_TOL = 1e-8
"""Violation up to which an avoidance holds [m]: above the linear solver's own, or its points would
satisfy nothing."""

_SECOND_WEIGHT = 0.5
"""Weight of the second best alternative's violation beside the best's in the choice of the
avoidance to branch on [-]: where both are large, the bounds of both children rise (10 to 15 % fewer
nodes)."""

_PATIENCE = 100
"""Nodes after which a dive without any solution gives up for the best bound [-]. Backtracking at
all takes 2 to 6 times fewer nodes to the first solution in narrow scenes."""


@dataclass(slots=True, eq=False)
class _Node(OpenNode):
    """An open node; the alternatives of its earlier siblings are excluded."""

    excluded: tuple[int, ...] = ()


class Tree:
    """The running state of one search; afterwards its answer.

    Parameters
    ----------
    program : DisjunctiveProgram
        The program.
    margins : (r,) array
        Back-off of each row [m].
    gap : float
        Relative gap at which to stop.
    limits : Limits
        When to stop early.
    cost_rows : sequence of CostRow
        Known lower bounds on the cost of some columns.

    Attributes
    ----------
    cost, z : float, (n,) array or None
        The best solution found.
    bound : float
        Proven lower bound; inf where infeasible.
    nodes, lps : int
        Work done.
    is_limited : bool
        Whether a limit ended the search.
    """

    def __init__(
        self,
        program: DisjunctiveProgram,
        margins: Vector,
        *,
        gap: float,
        limits: Limits,
        cost_rows: Sequence[CostRow] = (),
    ) -> None:
        self.program = program
        self.margins = margins
        self.gap = gap
        self.limits = limits
        self.cost = float("inf")
        self.z: Vector | None = None
        self.bound = float("inf")
        self.nodes = 0
        self.is_limited = False
        self._lp = WarmLp(program, margins, cost_rows)
        self._open: Dives[_Node] = Dives(_PATIENCE)
        self._weights = np.ones(program.num_avoidances)
        self._owner = program.layout.owners
        self._created = 0
        self._closed = float("inf")
        self._possible = possible_alternatives(program, margins)
        self._table = alternative_table(program, self._possible)
        left = (self._table >= 0).sum(axis=1)
        self._is_infeasible = bool(np.any(left == 0)) or bool(np.any(program.upper < program.lower))
        self._forced = tuple(int(self._table[v, 0]) for v in np.flatnonzero(left == 1))

    @property
    def lps(self) -> int:
        """Linear programs solved."""
        return self._lp.solves

    def try_selection(self, selection: Indices) -> None:
        """Make an incumbent of a full selection, if it has a solution."""
        if self._is_infeasible:
            return
        self._lp.activate(self.program.selected_rows(selection))
        outcome, _ = self._lp.solve()
        if outcome is LpOutcome.OPTIMAL:
            z = self._lp.point()
            cost = float(self.program.cost @ z)
            if cost < self.cost:
                self.cost, self.z = cost, z

    def try_point(self, z: Vector) -> None:
        """Make an incumbent of a point, if it satisfies the program."""
        violations = violations_of(self.program, self.margins, z)
        cost = float(self.program.cost @ z)
        if cost < self.cost and self._most_promising(violations) is None:
            self.cost, self.z = cost, z

    def run(self, max_nodes: int) -> None:
        """Dive from the best open node until none can improve on the incumbent.

        Stops after that many nodes; called again it resumes where it stopped.
        """
        if self._is_infeasible:
            return
        if self.nodes == 0:
            self._push(-float("inf"), self._forced, ())
        last = self.nodes + max_nodes
        self.is_limited = False
        while not self.is_limited:
            top = self._open.best()
            if top is None or relative_gap(self.cost, top.bound) <= self.gap:
                break
            self.is_limited = self._open.dive(
                self._expand,
                is_over=lambda: self.nodes >= last or self.limits.reached,
                has_solution=lambda: self.z is not None,
            )
        left = self._open.best()
        self.bound = min(self._closed, float("inf") if left is None else left.bound, self.cost)

    def _expand(self, node: _Node) -> _Node | None:
        """Solve a node; return the child to dive into, if it has any."""
        self.nodes += 1
        cutoff = self._cutoff()
        if node.bound >= cutoff:
            self._close(node.bound)
            return None
        self._lp.activate(self._rows(node.chosen), self._rows(node.excluded))
        outcome, bound = self._lp.solve(cutoff)
        if outcome is not LpOutcome.OPTIMAL and node.chosen:
            self._weights[self._owner[node.chosen[-1]]] += 1.0
        if outcome is LpOutcome.INFEASIBLE:
            return None
        bound = max(bound, node.bound)
        if outcome is not LpOutcome.OPTIMAL:
            # Cut off; or HiGHS failed: a limit like any other, its bound stays.
            self._close(bound)
            return None
        z = self._lp.point()
        violations = violations_of(self.program, self.margins, z)
        avoidance = self._most_promising(violations)
        if avoidance is not None:
            return self._branch(node, avoidance, violations, bound)
        self._close(bound)
        cost = float(self.program.cost @ z)
        if cost < self.cost:
            self.cost, self.z = cost, z
        return None

    def _most_promising(self, violations: Vector) -> int | None:
        """Return the avoidance to branch on; None if all hold."""
        if violations.size == 0:
            return None
        padded = np.where(self._table >= 0, violations[self._table], np.inf)
        least = padded.min(axis=1)
        violated = np.flatnonzero(least > _VIOLATION_TOL)
        if violated.size == 0:
            return None
        if self.z is None or padded.shape[1] == 1:
            # Without a solution, what failed often fails early: begin there (Boussemart 2004).
            return int(violated[(least[violated] * self._weights[violated]).argmax()])
        nearest = np.partition(padded[violated], 1, axis=1)
        return int(violated[(nearest[:, 0] + _SECOND_WEIGHT * nearest[:, 1]).argmax()])

    def _branch(self, node: _Node, avoidance: int, violations: Vector, bound: float) -> _Node:
        """Open one child per alternative; return the one violated least."""
        alternatives = [int(a) for a in self._table[avoidance] if a >= 0]
        alternatives.sort(key=lambda a: violations[a])
        excluded, later = node.excluded, []
        for before, alternative in pairwise(alternatives):
            # Only a single row has an opposite that is a row.
            if self.program.rows_of(before).size == 1:
                excluded = (*excluded, before)
            later.append(self._push(bound, (*node.chosen, alternative), excluded))
        self._open.leave(later[::-1])
        self._created += 1
        chosen = (*node.chosen, alternatives[0])
        return _Node(bound, -len(chosen), self._created, chosen, excluded=node.excluded)

    def _rows(self, alternatives: tuple[int, ...]) -> list[int]:
        """Return the rows of alternatives."""
        starts, rows = self.program.alternative_starts, self.program.alternative_rows
        return [int(r) for a in alternatives for r in rows[starts[a] : starts[a + 1]]]

    def _cutoff(self) -> float:
        """Return the cost from which on a node cannot matter."""
        return float("inf") if self.z is None else cutoff_below(self.cost, self.gap)

    def _close(self, bound: float) -> None:
        """Account for the bound of a node that is not split further."""
        self._closed = min(self._closed, bound)

    def _push(self, bound: float, chosen: tuple[int, ...], excluded: tuple[int, ...]) -> _Node:
        """Open a node."""
        self._created += 1
        node = _Node(bound, -len(chosen), self._created, chosen, excluded=excluded)
        self._open.open(node)
        return node
