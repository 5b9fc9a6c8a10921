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
from radmpc.solvers.diving import Dives, rank
from radmpc.solvers.priced.node_solver import NodeSolver
from radmpc.solvers.priced.nodes import Frontier, Incumbent, Node, NodeState
from radmpc.solvers.priced.rating import Rater
from radmpc.solvers.priced.set_bounds import SetBound
from radmpc.solvers.priced.tuning import TUNING
from radmpc.solvers.priced.value import Precision
from radmpc.solvers.solution import Limits

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
    bound : float
        Proven lower bound of the value; inf where there is no solution at any price.
    nodes : int
        Nodes solved.
    is_limited : bool
        Whether a limit ended the last run, or a linear program that matters was not solved.
    """

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
        self.limits = limits
        self.bound = -_INF
        self.nodes = 0
        self.is_limited = False
        self.rater = Rater(program, unit) if rater is None else rater
        precision = self.precision(gap, scale)
        self._solver = NodeSolver(program, self.rater, unit, price, bounds, precision)
        self._open: Dives[Node] = Dives(TUNING.patience)
        self._parked: list[Node] = []
        self._unsolved: list[Node] = []
        self._created = 0
        if self.rater.is_infeasible:
            self.bound = _INF
        else:
            self._open.open(self._node(-_INF, ()))

    @classmethod
    def precision(cls, gap: float, scale: float) -> Precision:
        """Return how exact it is.

        Parameters
        ----------
        gap, scale : float
            As in `Precision`.
        """
        return Precision(gap, scale)

    @property
    def best(self) -> Incumbent | None:
        """The best solution at the price."""
        return self._solver.best

    @property
    def value(self) -> float:
        """Its cost with its risk at the price; inf without one."""
        return self._solver.value

    @property
    def lps(self) -> int:
        """Linear programs solved."""
        return self._solver.lps

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
            self._solver.begin_with(best)

    def consider(self, z: Vector) -> None:
        """Make an incumbent of a point that keeps the hard rows."""
        self._solver.note(z, self.rater.rate(z))

    def run(self, max_nodes: int) -> None:
        """Dive from the best open node until none can improve on the incumbent.

        Stops after that many nodes; called again it resumes where it stopped.
        """
        last = self.nodes + max_nodes
        self.is_limited = False
        while not self.is_limited:
            top = self._open.best()
            if top is None or top.bound >= self._solver.cutoff:
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
        self.is_limited |= any(node.bound < self._solver.cutoff for node in self._unsolved)
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
            child = self._node(node.bound, self._solver.choice.replaced(node.chosen, alternative))
            child.basis = node.basis
            if self.limits.reached:
                # A linear program may take half a second: no other is begun.
                self._open.open(child)
                continue
            self._solve(child)
            if child.alternatives:
                children.append(child)
        children.sort(key=rank)
        for child in children:
            self._open.open(child)
        self._open.leave(children[:0:-1])
        return children[0] if children else None

    def _solve(self, node: Node) -> None:
        """Solve a node: find the alternatives to branch on, or park it, or drop it."""
        self.nodes += 1
        node.is_solved = True
        if node.bound < self._solver.cutoff:
            state = self._solver.solve(node)
            if state in {NodeState.OPEN, NodeState.DROPPED}:
                return
            self._unsolved += [node] * (state is NodeState.UNSOLVED)
        node.is_open = True
        self._parked.append(node)

    def _node(self, bound: float, chosen: tuple[int, ...]) -> Node:
        """Return a new node."""
        self._created += 1
        return Node(bound, -len(chosen), self._created, chosen)
