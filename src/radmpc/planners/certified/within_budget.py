"""The cheapest plan within a budget, where no price of risk leads to it."""

from __future__ import annotations

from collections.abc import Sequence

from radmpc.arrays import Matrix
from radmpc.planners.certified.acceptance import accept_round
from radmpc.planners.certified.fleet import Fleet
from radmpc.planners.certified.merging import Members
from radmpc.planners.certified.problem import SetProblem
from radmpc.planners.certified.repair import repriced
from radmpc.planners.certified.rounds import Round
from radmpc.planners.certified.state.incumbent import FleetIncumbent
from radmpc.planners.certified.state.search_state import SearchState
from radmpc.planners.certified.tuning import TUNING
from radmpc.planners.verdict import Judge
from radmpc.program.build import point_of
from radmpc.records import dataclass, field, replace
from radmpc.solvers.priced.budget import BudgetTree
from radmpc.solvers.priced.nodes import Frontier, Incumbent
from radmpc.solvers.priced.rating import Rater

__all__ = ["Searched", "WithinBudget", "replan_with_alternatives"]

_TUNED = TUNING.within

_INF = float("inf")
"""No limit, or, negated, no bound."""

_LEAST_SCALE = 1e-6
"""Cost below which gaps are taken of this instead."""


def replan_with_alternatives(
    fleet: Fleet,
    state: SearchState,
    judge: Judge,
    sets: tuple[Members, ...],
    controls: tuple[Matrix, ...],
) -> SearchState:
    """Look for the cheapest certified plan with the alternatives of a given one.

    Parameters
    ----------
    fleet : Fleet
        The fleet.
    state : SearchState
        What is known of it.
    judge : callable
        The referee.
    sets : tuple of tuple of int
        Vehicles that were planned together in the given plan.
    controls : tuple of (T, m) array
        Its controls, in the scenario's order.

    Returns
    -------
    SearchState
        With the plan, if it is certified and cheaper.
    """
    plans = tuple(_incumbent(fleet.programs.problem(m), [controls[i] for i in m]) for m in sets)
    inter_set_risk = sum(fleet.programs.inter_set_risks(sets, [plan.z for plan in plans]).values())
    unit_price = fleet.first_unit_price(state.budget)
    given = _round(sets, unit_price, plans, inter_set_risk)
    state = accept_round(fleet, state, given, judge).state
    low, high = _TUNED.cheapest * unit_price, _TUNED.dearest * unit_price
    chosen = None
    for _ in range(_TUNED.bisections):
        if fleet.limits.reached:
            break
        unit_price = (low * high) ** 0.5
        priced = tuple(
            repriced(fleet.programs.problem(m), plan, fleet.unit, unit_price, fleet.limits)
            for m, plan in zip(sets, plans, strict=True)
        )
        if sum(plan.risk for plan in priced) + inter_set_risk <= state.budget:
            high, chosen = unit_price, _round(sets, unit_price, priced, inter_set_risk)
        else:
            low = unit_price
    return state if chosen is None else accept_round(fleet, state, chosen, judge).state


@dataclass(frozen=True, slots=True, eq=False)
class Searched:
    """How a search within a budget ended.

    Attributes
    ----------
    state : SearchState
        With what was found and certified, and the bounds that were proven.
    first_certificate : float
        What the referee found in it at this budget [-]; 0 where it was not asked.
    is_limited : bool
        Whether a limit ended the search of any set.
    """

    state: SearchState
    first_certificate: float
    is_limited: bool


@dataclass(frozen=True, slots=True, eq=False)
class WithinBudget:
    """The search for the least cost within what union bounds may sum to.

    Where the whole fleet is one set, what is found is the best, and its bound that of any plan;
    several sets are improved one after the other, each within what the others leave.

    Its search trees are kept beside the state: searched within the same budget again, a set's goes
    on where it stood.

    Attributes
    ----------
    fleet : Fleet
        The fleet.
    judge : callable
        The referee.
    """

    fleet: Fleet
    judge: Judge
    _trees: dict[tuple[Members, float], BudgetTree] = field(default_factory=dict)

    def search(
        self,
        state: SearchState,
        sets: tuple[Members, ...],
        plans: Sequence[Incumbent],
        budget: float,
        max_nodes: int,
    ) -> Searched:
        """Look for a better plan, or for a first one.

        Parameters
        ----------
        state : SearchState
            What is known of the fleet.
        sets : tuple of tuple of int
            A partition of the fleet.
        plans : sequence of Incumbent
            A plan of each, within the budget together unless there is only one.
        budget : float
            What union bounds may sum to beyond the starts [-].
        max_nodes : int
            Nodes per vehicle of a set.

        Returns
        -------
        Searched
            The next state, and how the search ended.
        """
        fleet = self.fleet
        plans, is_limited, is_changed = list(plans), False, False
        inter_set_risk = sum(
            fleet.programs.inter_set_risks(sets, [plan.z for plan in plans]).values()
        )
        for number, (members, plan) in enumerate(zip(sets, plans, strict=True)):
            # A plan with more faces may have no risk by those of the scenario: others only count.
            others = sum(p.risk for i, p in enumerate(plans) if i != number)
            left = budget - inter_set_risk - others
            if not left > 0.0 or fleet.limits.reached:
                continue
            tree = self._tree(state, members, left, plan)
            tree.consider(plan.z)
            tree.run(max_nodes * len(members))
            is_limited |= tree.is_limited
            if tree.best is None:
                continue
            if len(sets) == 1:
                proven = (left, tree.bound - tree.price)
                state = replace(state, budget_bounds=(*state.budget_bounds, proven))
            plans[number], is_changed = tree.best, True
        if not is_changed:
            return Searched(state, 0.0, is_limited=is_limited)
        found = _round(sets, state.last_unit_price(fleet), plans, inter_set_risk)
        state = replace(state, budget=fleet.clipped_budget(budget))
        accepted = accept_round(fleet, state, found, self.judge)
        return Searched(accepted.state, accepted.first_certificate, is_limited=is_limited)

    def plans(self, incumbent: FleetIncumbent) -> list[Incumbent]:
        """Return a certified plan, set by set."""
        return [
            _incumbent(self.fleet.programs.problem(m), [incumbent.controls[i] for i in m])
            for m in incumbent.sets
        ]

    def _tree(
        self, state: SearchState, members: Members, budget: float, plan: Incumbent
    ) -> BudgetTree:
        """Return the search of a set within a budget, where it stood."""
        if (members, budget) not in self._trees:
            problem = self.fleet.programs.problem(members)
            scale = max(plan.cost, _LEAST_SCALE)
            unit_price = _TUNED.tie * self.fleet.gap * scale
            tree = BudgetTree(
                problem.program,
                budget,
                unit_price,
                gap=_TUNED.gap_share * self.fleet.gap,
                scale=scale,
                limits=self.fleet.limits,
                rater=Rater(problem.program, budget),
            )
            tree.resume(_frontier(self.fleet, state, members, budget), unit_price, None)
            self._trees[members, budget] = tree
        tree = self._trees[members, budget]
        tree.limits = self.fleet.limits
        return tree


def _round(
    sets: tuple[Members, ...], unit_price: float, plans: Sequence[Incumbent], inter_set_risk: float
) -> Round:
    """Return plans of sets as a round that proves nothing."""
    risk = sum(plan.risk for plan in plans)
    return Round(sets, unit_price, tuple(plans), risk, inter_set_risk, -_INF, _INF, is_limited=True)


def _incumbent(problem: SetProblem, controls: Sequence[Matrix]) -> Incumbent:
    """Return a set's controls as a plan of its program."""
    z = point_of(problem.models, controls)
    rating = problem.rater.rate(z)
    return Incumbent(z, rating.selection, float(problem.program.cost @ z), rating.risk)


def _frontier(fleet: Fleet, state: SearchState, members: Members, budget: float) -> Frontier:
    """Return what the search at a price left open, with bounds on cost alone within a budget."""
    known = state.set_states.get(members)
    if known is None or not known.frontier:
        return ((-_INF, ()),)
    paid = known.unit_price * budget / fleet.unit
    return tuple((bound - paid, chosen) for bound, chosen in known.frontier)
