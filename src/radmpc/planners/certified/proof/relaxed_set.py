"""One set of vehicles in a proof, by cones or by faces, and how far its search has come."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from radmpc.arrays import Tensor, Vector
from radmpc.model.scenario import Scenario
from radmpc.planners.certified.proof.built import Built
from radmpc.program.build import SharedBlocks, build_program
from radmpc.program.condensed import CondensedModel
from radmpc.program.relaxed.build import build_relaxation
from radmpc.program.relaxed.shared_rows import SharedRows
from radmpc.program.relaxed.tails import Tails
from radmpc.records import dataclass, replace
from radmpc.solvers.priced.nodes import Frontier, Incumbent
from radmpc.solvers.priced.rating import Rater
from radmpc.solvers.priced.set_bounds import SetBound
from radmpc.solvers.priced.tree import RiskTree
from radmpc.solvers.solution import Limits

__all__ = ["RelaxedSet"]

_WHOLE: Frontier = ((-float("inf"), ()),)
"""The frontier of a search that has not begun."""


@dataclass(frozen=True, slots=True, eq=False)
class RelaxedSet:
    """A set's relaxation and the least value that is proven of it.

    Attributes
    ----------
    built : Built or None
        What is searched; None where it was left behind in another process, to be built again.
    base : float
        What the vehicles cost at least in empty space.
    most : float
        Value up to which it is searched: the program need not hold plans of larger values, and
        no larger bound is proven.
    around : (N, T+1, d) array or None
        Mean positions in a plan [m]: hazards far from them were left out. None is none.
    price : float
        Cost per unit of probability that the values refer to; negative before any search.
    bound : float
        Proven least ``cost + price · risk``; inf where no plan can be certified.
    best : Incumbent or None
        The best point of the relaxation, whatever its value.
    frontier : Frontier
        What is left of the search.
    nodes : int
        Nodes of all searches.
    widenings : int
        How often ``most`` was chosen anew.
    fingerprint : bytes
        Of the program that was left behind: its frontier is of no use to another one.
    is_trivial : bool
        Whether nothing is asked of the set.
    is_partial : bool
        Whether hazards were left out.
    is_complete : bool
        Whether they would not raise the bound.
    """

    built: Built | None
    base: float
    most: float = float("inf")
    around: Tensor | None = None
    price: float = -1.0
    bound: float = 0.0
    best: Incumbent | None = None
    frontier: Frontier = _WHOLE
    nodes: int = 0
    widenings: int = 0
    fingerprint: bytes = b""
    is_trivial: bool = False
    is_partial: bool = False
    is_complete: bool = True

    @classmethod
    def of(
        cls,
        scenario: Scenario,
        models: Sequence[CondensedModel],
        base: float,
        tails: Tails,
        num_directions: int,
        most: float = float("inf"),
        shared: SharedRows | None = None,
        around: Tensor | None = None,
    ) -> RelaxedSet:
        """Build a set's relaxation.

        Parameters
        ----------
        scenario : Scenario
            The vehicles alone, with what they may meet.
        models : sequence of CondensedModel
            Theirs, with the reach of plans up to ``most`` at least.
        base : float
            What they cost at least in empty space.
        tails : Tails
            For the fleet's Δ.
        num_directions : int
            Directions around every hazard.
        most : float
            Value up to which it is searched.
        shared : SharedRows or None
            Those of other sets of the same vehicles.
        around : (N, T+1, d) array or None
            Mean positions in a plan [m]: hazards far from them are left out. None leaves out none.
        """
        made = build_relaxation(scenario, models, tails, num_directions, shared, around)
        rater = Rater(made.program, scenario.risk_bound)
        return cls._of(Built(scenario, made.program, rater, made.left_out), base, most, around)

    @classmethod
    def by_faces(
        cls,
        scenario: Scenario,
        models: Sequence[CondensedModel],
        base: float,
        most: float = float("inf"),
        shared: SharedBlocks | None = None,
    ) -> RelaxedSet:
        """Build the program of a set's faces, of which no risk beyond Δ is of interest.

        Parameters
        ----------
        scenario, models, base, most
            As in `of`.
        shared : SharedBlocks or None
            Rows of other sets of the same vehicles, whose reach is theirs.
        """
        risk_bound = scenario.risk_bound
        program = build_program(scenario, tuple(models), risk_bound=risk_bound, shared=shared)
        return cls._of(Built(scenario, program, Rater(program, risk_bound)), base, most)

    @classmethod
    def _of(
        cls, built: Built, base: float, most: float, around: Tensor | None = None
    ) -> RelaxedSet:
        """Return a set that was not searched yet."""
        is_partial = bool(built.left_out)
        return cls(
            built,
            base,
            most,
            around,
            bound=base,
            is_trivial=built.program.num_avoidances == 0 and not is_partial,
            is_partial=is_partial,
            is_complete=not is_partial,
        )

    @property
    def num_rows(self) -> int:
        """Rows of what is searched, while it is kept [-]."""
        return 0 if self.built is None else self.built.program.rows.count

    @property
    def is_sent_without(self) -> bool:
        """Whether another process builds what is searched sooner than it receives it.

        Where reach was narrowed, that took linear programs, which limits may have ended.
        """
        return self.most == float("inf")

    def to_be_sent(self) -> RelaxedSet:
        """Return the set as other processes are given it."""
        return self.left_behind() if self.is_sent_without else self

    def left_behind(self) -> RelaxedSet:
        """Return the set without what is searched, which is built anew to be searched on."""
        if self.built is None:
            return self
        return replace(self, built=None, fingerprint=self.built.fingerprint())

    def built_anew(self, like: RelaxedSet) -> RelaxedSet:
        """Return the set with what is searched built again.

        Parameters
        ----------
        like : RelaxedSet
            The same set, built alike and not searched.
        """
        is_same = like.built is not None and like.built.fingerprint() == self.fingerprint
        return replace(self, built=like.built, frontier=self.frontier if is_same else _WHOLE)

    def continued(self, before: RelaxedSet) -> RelaxedSet:
        """Return this set, not searched yet, with what another search of it has proven.

        Parameters
        ----------
        before : RelaxedSet
            That search, up to another value, or with hazards left out.
        """
        return replace(
            self,
            price=before.price,
            bound=before.bound,
            # What was left out makes points look cheaper than they are.
            best=None if before.is_partial else before.best,
            nodes=before.nodes,
            widenings=before.widenings + (self.most != before.most or not before.is_partial),
        )

    @property
    def value(self) -> float:
        """What the best point costs with its risk at the price; inf without one."""
        return self._value_at(self.price)

    def _value_at(self, price: float) -> float:
        """Return what the best point costs with its risk at a price; inf without one."""
        return float("inf") if self.best is None else self.best.cost + price * self.best.risk

    def bound_at(self, price: float) -> float:
        """Return what is proven at another price: values are concave in it, and never fall.

        Parameters
        ----------
        price : float
            Cost per unit of probability.
        """
        if price >= self.price:
            return self.bound
        return self.base + price / self.price * (self.bound - self.base)

    def searched(
        self,
        limits: Limits,
        price: float,
        bounds: tuple[SetBound, ...],
        gap: float,
        max_nodes: int,
        hint: Vector,
        enough: float = float("inf"),
    ) -> RelaxedSet:
        """Return the same set, searched on.

        Parameters
        ----------
        limits : Limits
            When to stop early.
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
        enough : float
            Bound at which to stop.
        """
        built = self.built
        assert built is not None, "built anew before"
        unit = built.scenario.risk_bound
        if built.scenario.has_windows and built.scenario.num_vehicles == 1:
            # The program says nothing of visits whose step is open.
            bounds = (*bounds, SetBound(frozenset({0}), self.base))
        tree = RiskTree(
            built.program,
            unit,
            price * unit,
            gap=gap,
            scale=max(1e-9, 1e-3 * self.base),
            limits=limits,
            bounds=bounds,
            rater=built.rater,
        )
        # What is cheaper than the most that is asked for counts; all else need not be told apart.
        best, known, most = self.best, self.best, min(self.most, enough / (1.0 - gap))
        if most < self._value_at(price):
            best = Incumbent(hint, np.zeros(built.program.num_avoidances, np.int64), most, 0.0)
        tree.resume(self.frontier, max(self.price, 0.0) * unit, best, self.base)
        tree.consider(hint)
        tree.run(max_nodes)
        if tree.best is not best:
            known = tree.best
        bound = max([self.bound_at(price), tree.bound, *(b.value for b in bounds)])
        bound = min(bound, most, tree.value)
        is_clear = known is not None and not built.is_close(known.z)
        return replace(
            self,
            is_complete=not self.is_partial or is_clear or bound == float("inf"),
            price=price,
            bound=bound,
            best=known,
            frontier=tree.frontier,
            nodes=self.nodes + tree.nodes,
        )
