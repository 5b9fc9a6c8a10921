"""Branch and bound over alternatives and risks together.

A node is a set of chosen alternatives; its linear program (`RiskLp`) underestimates their risk
and ignores that of all others, so its optimum bounds every solution below it. Every point of a
node is a solution of the priced problem

    minimize  cost(z) + price · risk(z) / unit,

with risk(z) the sum over avoidances of the least risk of their alternatives. It is rated at that
true risk, so incumbents come for free and are exact. Nodes closed by the cutoff are kept with
their bounds: at another price, or for a smaller gap, the search resumes from them.
"""

from __future__ import annotations

from collections.abc import Sequence

from radmpc.arrays import Vector
from radmpc.program.program import DisjunctiveProgram
from radmpc.solvers.diving import Dives
from radmpc.solvers.lp.outcome import LpOutcome
from radmpc.solvers.priced.branching import BranchingChoice
from radmpc.solvers.priced.lp import RiskLp, SetBound
from radmpc.solvers.priced.nodes import Frontier, Incumbent, Node
from radmpc.solvers.priced.rating import Rater, Rating
from radmpc.solvers.priced.tuning import TUNING
from radmpc.solvers.priced.value import negligible_difference, priced_value
from radmpc.solvers.solution import Limits, cutoff_below

__all__ = ["RiskTree"]

_INF = float("inf")


class RiskTree:
    """The running state of one search at a price, the Lagrange multiplier of the risk bound.

    Parameters
    ----------
    program : DisjunctiveProgram
        The program.
    unit : float
        Risk budget that the price refers to; no row may risk more than it, nor than one half.
    price : float
        Cost of one unit of risk.
    gap : float
        Relative gap at which to stop.
    scale : float
        Values below this count as this in relative gaps.
    limits : Limits
        When to stop early.
    bounds : sequence of SetBound
        Proven bounds of parts, at this price.
    rater : Rater or None
        The program laid out for rating, if at hand.

    Attributes
    ----------
    best : Incumbent or None
        The best solution at the present price.
    value : float
        Its cost with its risk at the price; inf without one.
    bound : float
        Proven lower bound of the value; inf where there is no solution at any price.
    nodes : int
        Nodes solved.
    is_limited : bool
        Whether a limit ended the last run, or a linear program that matters was not solved.
    """

    rounds = 8
    """Times that a node's linear program is solved at most, with ever more tangents."""

    def __init__(
        self,
        program: DisjunctiveProgram,
        unit: float,
        price: float,
        *,
        gap: float,
        scale: float,
        limits: Limits,
        bounds: Sequence[SetBound] = (),
        rater: Rater | None = None,
    ) -> None:
        self.program = program
        self.unit = unit
        self.price = price
        self.gap = gap
        self.scale = scale
        self.limits = limits
        self.best: Incumbent | None = None
        self.value = _INF
        self.bound = -_INF
        self.nodes = 0
        self.is_limited = False
        self.rater = Rater(program, unit) if rater is None else rater
        self._bounds = tuple(bounds)
        self._lp: RiskLp | None = None
        self._open: Dives[Node] = Dives(TUNING.patience)
        self._parked: list[Node] = []
        self._unsolved: list[Node] = []
        self._created = 0
        self._choice = BranchingChoice(program, self.rater)
        if self.rater.is_infeasible:
            self.bound = _INF
        else:
            self._open.open(self._node(-_INF, ()))

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
    def frontier(self) -> Frontier:
        """What is left of the search: nodes that together hold every solution, with bounds."""
        nodes = [*self._open, *self._parked]
        return tuple((node.bound, node.chosen) for node in nodes)

    def resume(
        self, frontier: Frontier, price: float, best: Incumbent | None, base: float = 0.0
    ) -> None:
        """Resume from another search's frontier, whatever its price and gap.

        A bound is concave in the price. One at a lower price holds as it is; one at a higher price
        gives, with what solutions cost where risk is free, the chord between.

        Parameters
        ----------
        frontier : Frontier
            Of the other search.
        price : float
            Its price.
        best : Incumbent or None
            Its incumbent.
        base : float
            Least cost of any solution, at price 0; a cost is never negative.
        """
        share = 1.0 if self.price >= price else self.price / price
        self._open.clear()
        self._parked = []
        if self.rater.is_infeasible:
            return
        for bound, chosen in frontier:
            lower = bound if share == 1.0 else share * bound + (1.0 - share) * base
            self._open.open(self._node(lower, chosen))
        if best is not None:
            self.best = best
            self.value = best.cost + self.price * best.risk / self.unit

    def consider(self, z: Vector) -> None:
        """Make an incumbent of a point that keeps the hard rows."""
        self._note(z, self.rater.rate(z))

    def run(self, max_nodes: int) -> None:
        """Dive from the best open node until none can improve on the incumbent.

        Stops after that many nodes; called again it resumes where it stopped.
        """
        last = self.nodes + max_nodes
        self.is_limited = False
        while not self.is_limited:
            top = self._open.best()
            if top is None or top.bound >= self._cutoff():
                break
            self.is_limited = self._open.dive(
                self._expand,
                is_over=lambda: self.nodes >= last or self.limits.reached,
                has_solution=lambda: self.best is not None,
            )
        if self.rater.is_infeasible:
            return
        top = self._open.best()
        bounds = [n.bound for n in self._parked]
        if top is not None:
            bounds.append(top.bound)
        # Parked where HiGHS failed, a node is work left over unless its bound is good enough.
        self.is_limited |= any(node.bound < self._cutoff() for node in self._unsolved)
        # The incumbent is below no node's bound by more than rounding.
        self.bound = min([*bounds, self.value])

    def _expand(self, node: Node) -> Node | None:
        """Solve a node and its children one after the other; return the best that is left open.

        All at once: from one child to the next the linear program changes by a row, and with
        its own bound a child need not be visited again before it is its turn.
        """
        if not node.is_solved:
            self._solve(node)
        children = []
        for alternative in node.alternatives:
            child = self._node(node.bound, self._choice.replaced(node.chosen, alternative))
            child.basis = node.basis
            if self.limits.reached:
                # A linear program may take half a second: no other is begun.
                self._open.open(child)
                continue
            self._solve(child)
            if child.alternatives:
                children.append(child)
        children.sort()
        for child in children:
            self._open.open(child)
        self._open.leave(children[:0:-1])
        return children[0] if children else None

    def _solve(self, node: Node) -> None:
        """Solve a node: find the alternatives to branch on, or park it, or drop it."""
        self.nodes += 1
        node.is_solved = True
        if node.bound < self._cutoff():
            lp, choice = self.lp, self._choice
            lp.activate(node.chosen)
            lp.begin_with(node.basis)
            for attempt in range(self.rounds):
                outcome = self._relax(node, lp)
                if outcome is LpOutcome.INFEASIBLE:
                    return
                if outcome is not LpOutcome.OPTIMAL:
                    self._unsolved += [node] * (outcome is LpOutcome.FAILED)
                    break
                point = lp.point()
                z = point[: self.program.num_columns]
                rating = self.rater.rate(z)
                worth = self._note(z, rating)
                epsilon = negligible_difference(min(worth, self.value), self.gap, self.scale)
                if worth - node.bound <= epsilon:
                    break
                has_plan = self.best is not None
                avoidance, is_blunt = choice.most_promising(node.chosen, rating, has_plan=has_plan)
                # Far from any plan, an exact account of the risks chosen so far can wait.
                tolerance = (3.0 if is_blunt else 0.5) * epsilon
                is_last = attempt >= (1 if is_blunt else self.rounds - 1)
                if not is_last and self._refine(point, rating, tolerance):
                    continue
                if avoidance is None:
                    break
                node.alternatives = choice.alternatives(avoidance, node.chosen, rating)
                node.basis = lp.basis()
                return
        node.is_open = True
        self._parked.append(node)

    def _relax(self, node: Node, lp: RiskLp) -> LpOutcome:
        """Solve a node's linear program and raise its bound; cut off where it cannot matter."""
        cutoff = self._cutoff()
        # A little beyond the cutoff, so that the bound still serves at a higher price.
        outcome, bound = lp.solve(cutoff + TUNING.headroom * abs(cutoff))
        if outcome is not LpOutcome.OPTIMAL and node.chosen:
            self._choice.failed(node.chosen[-1])
        node.bound = max(node.bound, bound)
        if outcome is LpOutcome.OPTIMAL and node.bound >= cutoff:
            return LpOutcome.CUTOFF
        return outcome

    def _refine(self, point: Vector, rating: Rating, tolerance: float) -> bool:
        """Add tangents where the chosen rows' risk is underestimated; tell whether any was."""
        # What risk is worth nothing may be underestimated.
        return self.price > 0.0 and self.lp.refine(rating, point, tolerance / self.price)

    def _worth(self, z: Vector, rating: Rating) -> float:
        """Return a point's value; inf where it is no candidate."""
        row_cap = self.rater.row_cap
        return priced_value(
            self.program, z, rating, unit=self.unit, price=self.price, row_cap=row_cap
        )

    def _note(self, z: Vector, rating: Rating) -> float:
        """Keep a point if it is the best; return its value."""
        value = self._worth(z, rating)
        if value < self.value:
            cost = float(self.program.cost @ z)
            self.best = Incumbent(z, rating.selection, cost, rating.risk)
            self.value = value
        return value

    def _cutoff(self) -> float:
        """Return the value from which on a node cannot matter."""
        return _INF if self.best is None else cutoff_below(self.value, self.gap, self.scale)

    def _node(self, bound: float, chosen: tuple[int, ...]) -> Node:
        """Return a new node."""
        self._created += 1
        return Node(bound, -len(chosen), self._created, chosen)
