"""Disjunctive branch and bound over one warm linear programme (at fixed margins).

A node is a set of chosen alternatives. Its linear programme holds their rows only, so its
optimum bounds every solution that chooses them. Where the optimum violates some avoidance, the
node splits into one child per alternative of the most violated one.
"""

from __future__ import annotations

import heapq
import time
from dataclasses import dataclass, field

import numpy as np

from radmpc.arrays import Indices, Vector
from radmpc.program.program import DisjunctiveProgram
from radmpc.solvers.lp import LpOutcome, WarmLp
from radmpc.solvers.selection import least_violated, violations_of
from radmpc.solvers.solution import Limits, Outcome, Solution, relative_gap

__all__ = ["Branch"]

_VIOLATION_TOL = 1e-8


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
        search = _Search(program, margins, gap, limits, self.max_nodes)
        if np.any(program.upper < program.lower) or np.any(np.diff(program.avoidance_starts) == 0):
            return search.finish(begun)
        if start is not None:
            search.try_selection(start)
        search.run()
        return search.finish(begun)


@dataclass(order=True, slots=True)
class _Node:
    """An open node, ordered by its bound, then deeper first, then older first."""

    bound: float
    depth: int
    number: int
    alternatives: tuple[int, ...] = field(compare=False)


class _Search:
    """The running state of one search."""

    def __init__(
        self,
        program: DisjunctiveProgram,
        margins: Vector,
        gap: float,
        limits: Limits,
        max_nodes: int,
    ) -> None:
        self.program = program
        self.margins = margins
        self.gap = gap
        self.limits = limits
        self.max_nodes = max_nodes
        self.lp = WarmLp(program, margins)
        self.open: list[_Node] = []
        self.nodes = 0
        self.created = 0
        self.cost = float("inf")
        self.z: Vector | None = None
        self.bound = float("inf")
        self.is_limited = False

    def run(self) -> None:
        """Dive from the best open node until none can improve on the incumbent."""
        self._push(-float("inf"), ())
        while self.open:
            if relative_gap(self.cost, self.open[0].bound) <= self.gap:
                break
            node: _Node | None = heapq.heappop(self.open)
            while node is not None:
                if self.nodes >= self.max_nodes or self.limits.reached:
                    self.is_limited = True
                    heapq.heappush(self.open, node)
                    return
                node = self._expand(node)

    def _expand(self, node: _Node) -> _Node | None:
        """Solve a node; return the child to dive into, if it has any."""
        self.nodes += 1
        if relative_gap(self.cost, node.bound) <= self.gap:
            self._close(node.bound)
            return None
        self.lp.activate(self._rows(node.alternatives))
        outcome, bound = self.lp.solve(self._cutoff())
        if outcome is not LpOutcome.OPTIMAL:
            if outcome is LpOutcome.CUTOFF:
                self._close(bound)
            return None
        bound = max(bound, node.bound)
        z = self.lp.point()
        violations = violations_of(self.program, self.margins, z)
        worst = np.minimum.reduceat(violations, self.program.avoidance_starts[:-1])
        avoidance = int(worst.argmax()) if worst.size else -1
        if avoidance < 0 or worst[avoidance] <= _VIOLATION_TOL:
            self._close(bound)
            if bound < self.cost:
                self.cost, self.z = bound, z
            return None
        return self._branch(node, avoidance, violations, bound)

    def _branch(self, node: _Node, avoidance: int, violations: Vector, bound: float) -> _Node:
        """Open one child per alternative; return the one violated least."""
        alternatives = self.program.alternatives_of(avoidance)
        ranked = sorted(alternatives, key=lambda a: violations[a])
        for alternative in ranked[1:]:
            self._push(bound, (*node.alternatives, alternative))
        self.created += 1
        chosen = (*node.alternatives, ranked[0])
        return _Node(bound, -len(chosen), self.created, chosen)

    def try_selection(self, selection: Indices) -> None:
        """Make an incumbent of a full selection, if it has a solution."""
        self.lp.activate(self.program.selected_rows(selection))
        outcome, cost = self.lp.solve()
        if outcome is LpOutcome.OPTIMAL and cost < self.cost:
            self.cost, self.z = cost, self.lp.point()

    def finish(self, begun: float) -> Solution:
        """Return the answer as it stands."""
        if self.open and self.is_limited:
            self.bound = min(self.bound, self.open[0].bound)
        elif self.open:
            self._close(self.open[0].bound)
        if self.z is None:
            outcome = Outcome.LIMIT if self.is_limited else Outcome.INFEASIBLE
            selection = None
        else:
            bound = min(self.bound, self.cost)
            closed = relative_gap(self.cost, bound) <= self.gap
            outcome = Outcome.OPTIMAL if closed else Outcome.FEASIBLE
            violations = violations_of(self.program, self.margins, self.z)
            selection = least_violated(self.program, violations)
        return Solution(
            outcome=outcome,
            z=self.z,
            selection=selection,
            cost=self.cost,
            bound=min(self.bound, self.cost),
            nodes=self.nodes,
            lps=self.lp.solves,
            seconds=time.perf_counter() - begun,
        )

    def _rows(self, alternatives: tuple[int, ...]) -> Indices:
        """Return the rows of chosen alternatives."""
        if not alternatives:
            return np.zeros(0, dtype=np.int64)
        return np.concatenate([self.program.rows_of(a) for a in alternatives])

    def _cutoff(self) -> float:
        """Return the cost above which a node cannot matter."""
        # A hair above what the gap allows, so that a node cut off counts as within it.
        return self.cost - self.gap * (1.0 - 1e-6) * max(abs(self.cost), 1e-9)

    def _close(self, bound: float) -> None:
        """Account for the bound of a node that is not split further."""
        self.bound = min(self.bound, bound)

    def _push(self, bound: float, alternatives: tuple[int, ...]) -> None:
        """Open a node."""
        self.created += 1
        heapq.heappush(self.open, _Node(bound, -len(alternatives), self.created, alternatives))
