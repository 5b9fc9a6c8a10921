"""Solving the nodes of a search at a price: linear programs, tangents, and points that are better.

Every point of a node is a solution of the priced problem and is rated at its true risk, so
incumbents come for free and are exact.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from radmpc.arrays import Vector
from radmpc.program.program import DisjunctiveProgram
from radmpc.solvers.compiled_code import is_compiled
from radmpc.solvers.lp.outcome import LpOutcome
from radmpc.solvers.priced.branching import BranchingChoice
from radmpc.solvers.priced.lp import RiskLp
from radmpc.solvers.priced.nodes import Incumbent, Node, NodeState
from radmpc.solvers.priced.rating import Rater, Rating
from radmpc.solvers.priced.set_bounds import SetBound
from radmpc.solvers.priced.tuning import TUNING
from radmpc.solvers.priced.value import Precision, negligible_difference, priced_value
from radmpc.solvers.solution import cutoff_below

if TYPE_CHECKING:
    from radmpc.solvers.priced.compiled_nodes import CompiledNodes, Solved

__all__ = ["NodeSolver"]

_INF = float("inf")

_ENDED = {LpOutcome.INFEASIBLE: NodeState.DROPPED, LpOutcome.FAILED: NodeState.UNSOLVED}
"""What becomes of a node whose linear program has no optimum."""


class NodeSolver:
    """What the nodes of one search have in common, and the best point of any.

    Parameters
    ----------
    program : DisjunctiveProgram
        The program.
    rater : Rater
        The same, laid out for rating.
    unit : float
        Risk budget that the price refers to.
    price : float
        Cost of one unit of risk.
    bounds : sequence of SetBound
        Proven bounds of parts, at this price.
    precision : Precision
        Of the search.

    Attributes
    ----------
    best : Incumbent or None
        The best solution at the price.
    value : float
        Its cost with its risk at the price; inf without one.
    choice : BranchingChoice
        Where to branch.
    """

    def __init__(
        self,
        program: DisjunctiveProgram,
        rater: Rater,
        unit: float,
        price: float,
        bounds: Sequence[SetBound],
        precision: Precision,
    ) -> None:
        self.program = program
        self.rater = rater
        self.unit = unit
        self.price = price
        self.precision = precision
        self.best: Incumbent | None = None
        self.value = _INF
        self.choice = BranchingChoice(program, rater)
        self._bounds = tuple(bounds)
        self._lp: RiskLp | None = None
        self._compiled: CompiledNodes | None = None
        self._loaded = -1

    @property
    def lp(self) -> RiskLp:
        """The linear program, loaded when first needed."""
        if self._lp is None:
            self._lp = RiskLp(self.program, self.unit, self.price, self._bounds, self.rater)
        return self._lp

    @property
    def lps(self) -> int:
        """Linear programs solved."""
        return 0 if self._lp is None else self._lp.solves

    @property
    def cutoff(self) -> float:
        """The value from which on a node cannot matter."""
        if self.best is None:
            return _INF
        return cutoff_below(self.value, self.precision.gap, self.precision.scale)

    def begin_with(self, best: Incumbent) -> None:
        """Begin with an incumbent from elsewhere.

        Parameters
        ----------
        best : Incumbent
            Whose risk counts at this price.
        """
        self.best = best
        self.value = best.cost + self.price * best.risk / self.unit

    def note(self, z: Vector, rating: Rating) -> float:
        """Keep a point if it is the best; return its value, inf where it is no candidate.

        Parameters
        ----------
        z : (n,) array
            The point, which keeps the hard rows.
        rating : Rating
            Its rating.
        """
        value = priced_value(
            self.program,
            z,
            rating,
            unit=self.unit,
            price=self.price,
            row_cap=self.rater.row_cap,
            most_units=self.precision.most_units,
        )
        if value < self.value:
            cost = float(self.program.cost @ z)
            self.best = Incumbent(z, rating.selection, cost, rating.risk)
            self.value = value
        return value

    def solve(self, node: Node) -> NodeState:
        """Solve a node that may matter, raise its bound, and find where to branch.

        Parameters
        ----------
        node : Node
            Below the cutoff; it is told its alternatives and the vertex where it ended, if open.
        """
        solved = self._at_once(node)
        if solved is not None and solved.state is NodeState.CROWDED:
            self.lp.restart()
            solved = self._at_once(node)
        if solved is None:
            return self._by_python(node)
        if solved.state is NodeState.UNSOLVED:
            return self._by_python(node, solved.attempt)
        return solved.state

    def _at_once(self, node: Node) -> Solved | None:
        """Solve a node by compiled code; None where there is none for it."""
        lp, nodes = self.lp, self._compiled_nodes()
        if nodes is None:
            return None
        starts, vertex = node.basis
        begin = vertex if starts == lp.starts else b""
        solved = nodes.solve(node.chosen, begin, node.bound, self.value)
        node.bound = solved.bound
        if solved.is_better:
            self.begin_with(nodes.best(solved))
        if solved.state is NodeState.OPEN:
            missed = nodes.short[solved.avoidance]
            node.alternatives = self.choice.alternatives(solved.avoidance, node.chosen, missed)
            node.basis = lp.starts, solved.basis
        return solved

    def _compiled_nodes(self) -> CompiledNodes | None:
        """Return what solves nodes on the program as it is loaded, if compiled code keeps that."""
        lp = self.lp
        if self._loaded != lp.starts:
            self._loaded, self._compiled = lp.starts, None
            is_rated = self.program.num_avoidances > 0 and not self.rater.is_infeasible
            if is_compiled() and is_rated and lp.rater is self.rater:
                from radmpc.solvers.priced.compiled_nodes import compiled_nodes  # noqa: PLC0415 - where there is any

                parts = self.rater, self.choice, self.unit, self.precision
                self._compiled = compiled_nodes(lp.rows, *parts)
        return self._compiled

    def _by_python(self, node: Node, first: int = 0) -> NodeState:
        """Solve a node without compiled code, or go on where that gave up after some attempts."""
        lp, choice, precision = self.lp, self.choice, self.precision
        if first == 0:
            lp.activate(node.chosen)
            lp.begin_with(node.basis)
        for attempt in range(first, precision.rounds):
            outcome = self._relax(node, lp)
            if outcome is not LpOutcome.OPTIMAL:
                return _ENDED.get(outcome, NodeState.PARKED)
            point = lp.point()
            z = point[: self.program.num_columns]
            rating = self.rater.rate(z)
            worth = self.note(z, rating)
            known = min(worth, self.value)
            epsilon = negligible_difference(known, precision.gap, precision.scale)
            if worth - node.bound <= epsilon:
                return NodeState.PARKED
            has_plan = self.best is not None
            avoidance, is_blunt = choice.most_promising(node.chosen, rating, has_plan=has_plan)
            # Far from any plan, an exact account of the risks chosen so far can wait.
            tolerance = (3.0 if is_blunt else 0.5) * epsilon
            is_last = attempt >= (1 if is_blunt else precision.rounds - 1)
            if not is_last and self._refine(point, rating, tolerance):
                continue
            if avoidance is None:
                return NodeState.PARKED
            node.alternatives = choice.alternatives(avoidance, node.chosen, rating.short[avoidance])
            node.basis = lp.basis()
            return NodeState.OPEN
        return NodeState.PARKED

    def _relax(self, node: Node, lp: RiskLp) -> LpOutcome:
        """Solve a node's linear program and raise its bound; cut off where it cannot matter."""
        cutoff = self.cutoff
        # A little beyond the cutoff, so that the bound still serves at a higher price.
        outcome, bound = lp.solve(cutoff + TUNING.headroom * abs(cutoff))
        if outcome is not LpOutcome.OPTIMAL and node.chosen:
            self.choice.failed(node.chosen[-1])
        node.bound = max(node.bound, bound)
        if outcome is LpOutcome.OPTIMAL and node.bound >= cutoff:
            return LpOutcome.CUTOFF
        return outcome

    def _refine(self, point: Vector, rating: Rating, tolerance: float) -> bool:
        """Add tangents where the chosen rows' risk is underestimated; tell whether any was."""
        # What risk is worth nothing may be underestimated, unless it is beyond the budget.
        if self.price > 0.0 and self.lp.refine(rating, point, tolerance / self.price):
            return True
        is_beyond = rating.risk > self.precision.most_units * self.unit
        is_asked = self.precision.missing < _INF
        return is_beyond and is_asked and self.lp.refine(rating, point, self.precision.missing)
