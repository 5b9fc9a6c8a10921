"""One set of vehicles in the relaxation, and how far its search has come."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from radmpc.arrays import Vector
from radmpc.planners.certified.fleet import Fleet
from radmpc.planners.certified.merging import Members
from radmpc.program.condensed import CondensedModel
from radmpc.program.program import DisjunctiveProgram
from radmpc.program.relaxed.build import build_relaxation
from radmpc.program.relaxed.tails import Tails
from radmpc.solvers.priced.lp import SetBound
from radmpc.solvers.priced.nodes import Frontier, Incumbent
from radmpc.solvers.priced.rating import Rater
from radmpc.solvers.priced.tree import RiskTree

__all__ = ["RelaxedSet"]


@dataclass(frozen=True, slots=True, eq=False)
class RelaxedSet:
    """A set's relaxation and the least value that is proven of it.

    Attributes
    ----------
    members : tuple of int
        The vehicles, ascending.
    program : DisjunctiveProgram
        Their relaxation.
    rater : Rater
        The same, laid out for rating.
    base : float
        What they cost at least in empty space.
    price : float
        Cost per unit of probability that the values refer to; negative before any search.
    bound : float
        Proven least ``cost + price · risk``; inf where no plan can be certified.
    best : Incumbent or None
        The best point of the relaxation.
    frontier : Frontier
        What is left of the search.
    nodes : int
        Nodes of all searches.
    """

    members: Members
    program: DisjunctiveProgram
    rater: Rater
    base: float
    price: float = -1.0
    bound: float = 0.0
    best: Incumbent | None = None
    frontier: Frontier = ()
    nodes: int = 0

    @classmethod
    def of(
        cls,
        fleet: Fleet,
        members: Members,
        models: Sequence[CondensedModel],
        tails: Tails,
        num_directions: int,
    ) -> RelaxedSet:
        """Build a set's relaxation.

        Parameters
        ----------
        fleet : Fleet
            The fleet.
        members : tuple of int
            The vehicles, ascending.
        models : sequence of CondensedModel
            Theirs.
        tails : Tails
            For the fleet's Δ.
        num_directions : int
            Directions around every hazard.
        """
        program = build_relaxation(fleet.programs.alone(members), models, tails, num_directions)
        base = sum(fleet.base[i] for i in members)
        rater = Rater(program, fleet.scenario.risk_bound)
        return cls(members, program, rater, base, bound=base)

    @property
    def value(self) -> float:
        """What the best point costs with its risk at the price; inf without one."""
        if self.best is None:
            return float("inf")
        return self.best.cost + self.price * self.best.risk

    @property
    def is_trivial(self) -> bool:
        """Whether nothing is asked of the set."""
        return self.program.num_avoidances == 0

    def searched(
        self,
        fleet: Fleet,
        price: float,
        bounds: tuple[SetBound, ...],
        gap: float,
        max_nodes: int,
        hint: Vector,
    ) -> RelaxedSet:
        """Return the same set, searched on.

        Parameters
        ----------
        fleet : Fleet
            With the limits that end the search.
        price : float
            Cost per unit of probability.
        bounds : tuple of SetBound
            Lower bounds proven for parts at this price.
        gap : float
            Relative gap at which to stop [-].
        max_nodes : int
            Nodes to spend now.
        hint : (n,) array
            A point to begin with.
        """
        unit = fleet.scenario.risk_bound
        tree = RiskTree(
            self.program,
            unit,
            price * unit,
            gap=gap,
            scale=max(1e-9, 1e-3 * self.base),
            limits=fleet.limits,
            bounds=bounds,
            rater=self.rater,
        )
        if self.price >= 0.0:
            tree.resume(self.frontier, self.price * unit, self.best, self.base)
        tree.consider(hint)
        tree.run(max_nodes)
        bound = max([self.base, tree.bound, *(b.value for b in bounds)])
        if self.price == price:
            bound = max(bound, self.bound)
        if tree.best is not None:
            bound = min(bound, tree.value)
        return replace(
            self,
            price=price,
            bound=bound,
            best=tree.best,
            frontier=tree.frontier,
            nodes=self.nodes + tree.nodes,
        )
