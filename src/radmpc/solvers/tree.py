"""Disjunctive branch and bound over one warm linear programme, at fixed margins.

A node is a set of chosen alternatives. Its linear programme holds their rows only, so its
optimum bounds every solution that chooses them. Where the optimum violates some avoidance, the
node splits into one child per alternative of one such avoidance. Children are kept disjoint:
a later child takes the opposite of its earlier siblings' rows, so that no solution is met twice.
"""

from __future__ import annotations

import heapq
from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np

from radmpc.arrays import Indices, Vector
from radmpc.program.program import DisjunctiveProgram
from radmpc.solvers.lp import CostRow, LpOutcome, WarmLp
from radmpc.solvers.selection import violations_of
from radmpc.solvers.solution import Limits, relative_gap

__all__ = ["Tree", "possible_alternatives"]

_VIOLATION_TOL = 1e-8
_SECOND_WEIGHT = 0.5
"""An avoidance is worth branching on if its best alternative is far away, and half as much if its
second best is: then both children move."""


def possible_alternatives(program: DisjunctiveProgram, margins: Vector) -> np.ndarray:
    """Return which alternatives some admissible control can satisfy, (a,) bool."""
    if program.num_alternatives == 0:
        return np.zeros(0, dtype=bool)
    normals = program.rows.normals
    least = (
        normals.maximum(0.0) @ program.output_lower + normals.minimum(0.0) @ program.output_upper
    )
    missed = least - program.rows.offsets + margins > 1e-6
    return ~np.logical_or.reduceat(
        missed[program.alternative_rows], program.alternative_starts[:-1]
    )


@dataclass(order=True, slots=True)
class _Node:
    """An open node, ordered by its bound, then deeper first, then older first."""

    bound: float
    depth: int
    number: int
    chosen: tuple[int, ...] = field(compare=False)
    excluded: tuple[int, ...] = field(compare=False)


class Tree:
    """The running state of one search; afterwards its answer.

    Parameters
    ----------
    program : DisjunctiveProgram
        The programme.
    margins : (r,) array
        Back-off of each row [m].
    gap : float
        Relative gap at which to stop.
    limits : Limits
        When to stop early.
    max_nodes : int
        Nodes after which to stop.
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
        max_nodes: int,
        cost_rows: Sequence[CostRow] = (),
    ) -> None:
        self.program = program
        self.margins = margins
        self.gap = gap
        self.limits = limits
        self.max_nodes = max_nodes
        self.cost = float("inf")
        self.z: Vector | None = None
        self.bound = float("inf")
        self.nodes = 0
        self.is_limited = False
        self._lp = WarmLp(program, margins, cost_rows)
        self._open: list[_Node] = []
        self._created = 0
        self._possible = possible_alternatives(program, margins)
        self._table = _padded(program, self._possible)
        left = (self._table >= 0).sum(axis=1)
        self._is_hopeless = bool(np.any(left == 0)) or bool(np.any(program.upper < program.lower))
        self._forced = tuple(int(self._table[v, 0]) for v in np.flatnonzero(left == 1))

    @property
    def lps(self) -> int:
        """Linear programmes solved."""
        return self._lp.solves

    def try_selection(self, selection: Indices) -> None:
        """Make an incumbent of a full selection, if it has a solution."""
        if self._is_hopeless:
            return
        self._lp.activate(self.program.selected_rows(selection))
        outcome, cost = self._lp.solve()
        if outcome is LpOutcome.OPTIMAL and cost < self.cost:
            self.cost, self.z = cost, self._lp.point()

    def run(self) -> Tree:
        """Dive from the best open node until none can improve on the incumbent."""
        if self._is_hopeless:
            return self
        self._push(-float("inf"), self._forced, ())
        while self._open and relative_gap(self.cost, self._open[0].bound) > self.gap:
            node: _Node | None = heapq.heappop(self._open)
            while node is not None:
                if self.nodes >= self.max_nodes or self.limits.reached:
                    self.is_limited = True
                    heapq.heappush(self._open, node)
                    break
                node = self._expand(node)
            if self.is_limited:
                break
        if self._open:
            self._close(self._open[0].bound)
        self.bound = min(self.bound, self.cost)
        return self

    def _expand(self, node: _Node) -> _Node | None:
        """Solve a node; return the child to dive into, if it has any."""
        self.nodes += 1
        cutoff = self._cutoff()
        if node.bound >= cutoff:
            self._close(node.bound)
            return None
        self._lp.activate(self._rows(node.chosen), self._rows(node.excluded))
        outcome, bound = self._lp.solve(cutoff)
        if outcome is LpOutcome.INFEASIBLE:
            return None
        bound = max(bound, node.bound)
        if outcome is LpOutcome.CUTOFF:
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
        nearest = np.partition(padded[violated], 1, axis=1) if padded.shape[1] > 1 else None
        if nearest is None:
            return int(violated[least[violated].argmax()])
        return int(violated[(nearest[:, 0] + _SECOND_WEIGHT * nearest[:, 1]).argmax()])

    def _branch(self, node: _Node, avoidance: int, violations: Vector, bound: float) -> _Node:
        """Open one child per alternative; return the one violated least."""
        alternatives = [int(a) for a in self._table[avoidance] if a >= 0]
        alternatives.sort(key=lambda a: violations[a])
        excluded = node.excluded
        for before, alternative in pairwise(alternatives):
            # Only a single row has an opposite that is a row.
            if self.program.rows_of(before).size == 1:
                excluded = (*excluded, before)
            self._push(bound, (*node.chosen, alternative), excluded)
        self._created += 1
        chosen = (*node.chosen, alternatives[0])
        return _Node(bound, -len(chosen), self._created, chosen, node.excluded)

    def _rows(self, alternatives: tuple[int, ...]) -> list[int]:
        """Return the rows of alternatives."""
        starts, rows = self.program.alternative_starts, self.program.alternative_rows
        return [int(r) for a in alternatives for r in rows[starts[a] : starts[a + 1]]]

    def _cutoff(self) -> float:
        """Return the cost from which on a node cannot matter."""
        if self.z is None:
            return float("inf")
        # A hair above what the gap allows, so that a node cut off counts as within it.
        return self.cost - self.gap * (1.0 - 1e-6) * max(abs(self.cost), 1e-9)

    def _close(self, bound: float) -> None:
        """Account for the bound of a node that is not split further."""
        self.bound = min(self.bound, bound)

    def _push(self, bound: float, chosen: tuple[int, ...], excluded: tuple[int, ...]) -> None:
        """Open a node."""
        self._created += 1
        heapq.heappush(self._open, _Node(bound, -len(chosen), self._created, chosen, excluded))


def _padded(program: DisjunctiveProgram, possible: np.ndarray) -> Indices:
    """Return the possible alternatives of every avoidance, (v, most), filled up with −1."""
    sizes = np.diff(program.avoidance_starts)
    owner = np.repeat(np.arange(sizes.size), sizes)[possible]
    counts = np.bincount(owner, minlength=sizes.size)
    table = np.full((sizes.size, int(counts.max(initial=1))), -1, dtype=np.int64)
    place = np.arange(owner.size) - np.repeat(np.cumsum(counts) - counts, counts)
    table[owner, place] = np.flatnonzero(possible)
    return table
