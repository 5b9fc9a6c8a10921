"""How far a proof around a first plan has come: both bounds, and turning to better sides."""

from __future__ import annotations

import numpy as np

from radmpc.arrays import Matrix
from radmpc.planners.certified.fleet import Fleet
from radmpc.planners.certified.inter_set_risk import by_sets, pair_risks_across_sets
from radmpc.planners.certified.merging import owners_of
from radmpc.planners.certified.phases.by_faces import bound_faces
from radmpc.planners.certified.phases.tuning import TUNING
from radmpc.planners.certified.proof.grouping import Proven
from radmpc.planners.certified.proof.search import BoundSearch
from radmpc.planners.certified.proof.tuning import TUNING as PROOF_TUNING
from radmpc.planners.certified.rounds import merge_worst
from radmpc.planners.certified.state.bounds import is_proven
from radmpc.planners.certified.state.search_state import SearchState
from radmpc.planners.certified.turned.large.sides import on_other_sides
from radmpc.planners.certified.turned.turned_plans import turn_half_spaces, turn_to
from radmpc.planners.verdict import Judge
from radmpc.records import dataclass, field, replace
from radmpc.solvers.solution import relative_gap

__all__ = ["Around"]


@dataclass(slots=True, eq=False)
class Around:
    """How far it has come; it exists for one first plan, and only this class writes to it.

    Attributes
    ----------
    fleet : Fleet
        The fleet, with the limits that end this.
    state : SearchState
        With the best plan, its sets, and the bounds by faces that were proven.
    judge : callable
        The referee.
    on_any : float
        No plan that the referee would certify costs less.
    turned_to : tuple of (T, m) array
        The plan of the relaxation that half-spaces were turned to last; empty before.
    least : float
        Cost of the plan that was turned until little was gained; inf before.
    price : float or None
        Shadow price of the risk that the relaxation was searched at; None before.
    proven : mapping of tuple of int to mapping of tuple of int to RelaxedSet
        How far the relaxation is searched.
    """

    fleet: Fleet
    state: SearchState
    judge: Judge
    on_any: float = 0.0
    turned_to: tuple[Matrix, ...] = ()
    least: float = float("inf")
    price: float | None = None
    proven: Proven = field(default_factory=dict)

    @property
    def gap(self) -> float:
        """The gap to any certified plan that is good enough [-]."""
        return max(PROOF_TUNING.gap, self.fleet.gap)

    @property
    def is_near(self) -> bool:
        """Whether any certified plan is proven to be nearly as dear."""
        return relative_gap(self.state.incumbent.cost, self.on_any) <= self.gap

    @property
    def is_proven(self) -> bool:
        """Whether the gap asked for is proven: what bounds any certified plan bounds faces, too."""
        gap = relative_gap(self.state.incumbent.cost, self.on_any)
        return gap <= self.fleet.gap or is_proven(self.fleet, self.state)

    @property
    def most_nodes(self) -> int:
        """Nodes of either bound at most."""
        count = self.fleet.scenario.num_vehicles
        few = min(count, PROOF_TUNING.most_together)
        return max(TUNING.most_nodes * few, TUNING.nodes_each * count)

    def bound_any(self, timed: Fleet) -> None:
        """Bound any certified plan, and turn the plan to better sides, until they meet.

        Parameters
        ----------
        timed : Fleet
            Outside its norms, with the limits that end this.
        """
        base, incumbent = float(sum(timed.base)), self.state.incumbent
        self.on_any = base
        if relative_gap(incumbent.cost, base) <= self.gap or timed.limits.reached:
            return
        search = BoundSearch(timed, incumbent, self._price(), base, self.most_nodes)
        effort, parts = 0, search.order
        while effort < TUNING.rounds:
            is_open = search.advance(TUNING.nodes, effort, parts)
            self.on_any = max(self.on_any, search.best)
            self.price, self.proven = search.price, search.proven
            before = frozenset(search.order)
            if not search.is_over and self._has_merged(search):
                parts = tuple(members for members in search.order if members not in before)
                if max(map(len, parts), default=0) > TUNING.few_together and self.turn_on():
                    # Their search takes long; if it is stopped, there is a better plan already.
                    search.continue_from(self.state.incumbent, self._price())
                continue
            gained = self._turned(search, is_outside=timed.scenario is not self.fleet.scenario)
            if self.is_near or search.nodes >= self.most_nodes or timed.limits.reached:
                return
            if gained:
                search.continue_from(self.state.incumbent, self._price())
            elif not is_open:
                return
            effort, parts = effort + 1, search.order

    def _turned(self, search: BoundSearch, *, is_outside: bool) -> bool:
        """Turn half-spaces to the plan of the relaxation; tell whether that made a cheaper one.

        Outside its norms that is beyond what programs may do, but its sides may be better ones.
        """
        fleet, before = self.fleet, self.state
        other = search.relaxed_controls()
        if not other or not self._promises(search, other):
            return self.turn_on()
        self.turned_to = other
        incumbent = before.incumbent
        price = (incumbent.turned_price or self._guess()) / incumbent.risk_ratio
        self.state = turn_to(fleet, before, self.judge, other, price, is_outside=is_outside)
        now = self.state.incumbent.cost
        if now < before.incumbent.cost:
            self.least = now
        return before.incumbent.cost - now > TUNING.little * self.gap * now

    def turn_on(self) -> bool:
        """Turn the best plan on its own sides, if it leaves risk; tell whether that gains much."""
        before, risk_bound = self.state.incumbent, self.fleet.scenario.risk_bound
        left = (before.turned_price or 0.0) * (risk_bound - before.certified)
        if before.cost >= self.least or left <= TUNING.left * self.fleet.gap * before.cost:
            return False
        self.state = turn_half_spaces(self.fleet, self.state, self.judge)
        now = self.least = self.state.incumbent.cost
        return before.cost - now > TUNING.little * self.gap * now

    def _promises(self, search: BoundSearch, other: tuple[Matrix, ...]) -> bool:
        """Whether a plan of the relaxation has other sides than those that were turned to.

        Or is much cheaper, by less risk: half-spaces may be stuck on the same sides, too.
        """
        proven = self.turned_to or self.state.incumbent.controls
        if on_other_sides(self.fleet.programs.hazards, proven, other, TUNING.same_side):
            return True
        incumbent = self.state.incumbent
        return not self.turned_to and relative_gap(incumbent.cost, search.value) > self.gap

    def _has_merged(self, search: BoundSearch) -> bool:
        """Merge sets whose relaxed plans collide; tell whether there are any."""
        sets = self.state.incumbent.sets
        controls = search.relaxed_controls()
        if len(sets) == 1 or not controls:
            return False
        programs, owners = self.fleet.programs, owners_of(sets)
        # A tenth of what the referee takes: it need not tell how much of Δ these plans risk.
        pair_risks = pair_risks_across_sets(
            self.fleet.scenario,
            np.array([model.path(u) for model, u in zip(programs.models, controls, strict=True)]),
            programs.covariances,
            owners,
            common=programs.hazards.common,
            num_faces=PROOF_TUNING.directions,
        )
        allowed = TUNING.apart * self.gap * self.state.incumbent.cost / max(search.price, 1e-300)
        allowed = min(allowed, TUNING.most_apart * self.fleet.scenario.risk_bound)
        merged = merge_worst(sets, by_sets(pair_risks, owners), allowed)
        if len(merged) == len(sets):
            return False
        merging = self.state.merging.remember(sets, merged, pair_risks)
        incumbent = replace(self.state.incumbent, sets=merged)
        self.state = replace(self.state, merging=merging, incumbent=incumbent)
        search.regroup(merged)
        return True

    def bound_faces(self) -> None:
        """Bound plans by faces whose union bound is at most Δ."""
        # At the price of the relaxation, whose values serve here.
        price = self._price() if self.price is None else self.price
        self.state = bound_faces(self.fleet, self.state, price, self.most_nodes, self.proven)

    def _price(self) -> float:
        """Return a price for the relaxation: near what Δ is worth to the plan at hand."""
        turned = self.state.incumbent.turned_price
        return TUNING.price_share * turned if turned else self._guess()

    def _guess(self) -> float:
        """Return what Δ may be worth where no plan was turned yet."""
        return self.fleet.first_unit_price(self.state.budget) / self.fleet.unit
