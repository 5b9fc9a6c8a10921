"""The search for the unit price of risk at which a fleet just uses its budget."""

from __future__ import annotations

import logging
import time

from radmpc.planners.certified.acceptance import accept_round
from radmpc.planners.certified.closing import close_gap
from radmpc.planners.certified.fleet import Fleet
from radmpc.planners.certified.pricing import next_price, price_alone
from radmpc.planners.certified.rounds import Round, run_round
from radmpc.planners.certified.state.bounds import bound_on_cost, is_proven
from radmpc.planners.certified.state.outdone import is_outdone
from radmpc.planners.certified.state.search_state import SearchState
from radmpc.planners.certified.tuning import TUNING
from radmpc.planners.certified.within_budget import WithinBudget
from radmpc.planners.draft import Step
from radmpc.planners.verdict import Judge
from radmpc.records import dataclass, replace
from radmpc.solvers.solution import Limits, relative_gap
from radmpc.wording import count_text, percent

__all__ = ["PriceSearch"]

_LOG = logging.getLogger(__name__)
_TUNED = TUNING.prices


@dataclass(frozen=True, slots=True, eq=False)
class PriceSearch:
    """The loop over prices; how far it has come is in the state that it is handed.

    Attributes
    ----------
    fleet : Fleet
        The fleet.
    judge : callable
        The referee.
    within : WithinBudget
        The search for where no price leads.
    rival : float
        Cost of a certified plan by other half-spaces; inf without one.
    """

    fleet: Fleet
    judge: Judge
    within: WithinBudget
    rival: float = float("inf")

    @classmethod
    def of(cls, fleet: Fleet, judge: Judge, rival: float = float("inf")) -> PriceSearch:
        """Return the search of a fleet, every plan judged by a referee.

        Parameters
        ----------
        fleet, judge, rival : Fleet, callable and float
            As in `PriceSearch`.
        """
        return cls(fleet, judge, WithinBudget(fleet, judge), rival)

    def with_limits(self, limits: Limits) -> PriceSearch:
        """Return the same search, to be stopped by other limits."""
        fleet = self.fleet.with_limits(limits)
        return replace(self, fleet=fleet, within=replace(self.within, fleet=fleet))

    def run(self, state: SearchState) -> SearchState:
        """Plan the fleet at prices, until the gap is closed, or none can close it, or a limit.

        Without any plan it stops where none is likely to come of a higher price, and goes on from
        there when run again.

        Parameters
        ----------
        state : SearchState
            Where it begins.

        Returns
        -------
        SearchState
            Where it ended.
        """
        fleet = self.fleet
        if state.unit_price == 0.0:
            state = price_alone(fleet, state)
        for _ in range(_TUNED.max_rounds):
            began = time.perf_counter()
            state, candidate = run_round(fleet, state)
            if candidate is None:
                if fleet.limits.reached or state.without_plan() is not None:
                    return state
                state = replace(state, effort=state.effort * _TUNED.more_effort)
                continue
            proven = (candidate.least, state.unit_price)
            state = replace(state, round_bounds=(*state.round_bounds, proven))
            accepted = accept_round(fleet, state, candidate, self.judge)
            seconds = time.perf_counter() - began
            state = _recorded(fleet, accepted.state, candidate, seconds)
            is_over = fleet.limits.reached or is_outdone(fleet, state, self.rival)
            if is_over or _is_closed(fleet, state, candidate):
                return state
            if accepted.has_merged:
                # What other sets risked says little of these.
                state = replace(state, tried=())
                continue
            state, is_over = self._after_round(state, candidate)
            if is_over:
                return state
        return state

    def _after_round(self, state: SearchState, candidate: Round) -> tuple[SearchState, bool]:
        """Choose price and effort of the next round; tell whether there is nothing to choose."""
        fleet = self.fleet
        if candidate.is_initial:
            return _after_initial_plan(state, candidate), False
        left_open = state.incumbent.cost - bound_on_cost(fleet, state)
        if candidate.is_limited and candidate.open_gap > _TUNED.search_share * left_open:
            # The searches leave more open than a better price could close.
            if is_proven(fleet, state):
                return state, True
            return replace(state, effort=state.effort * _TUNED.more_effort), False
        state = replace(state, tried=(*state.tried, (state.unit_price, candidate.risk)))
        following = next_price(state.tried, state.budget - candidate.inter_set_risk)
        if _is_at_jump(state, candidate):
            # No price leads to what lies between two plans of different alternatives.
            state = close_gap(self.within, state, candidate)
            if state.has_plan:
                return state, True
        first = fleet.first_unit_price(state.budget)
        following = min(following, _TUNED.dearest * first)
        is_same = abs(following - state.unit_price) <= _TUNED.same * state.unit_price
        is_doubtful = not state.has_plan and following > _TUNED.doubtful * first
        state = replace(state, unit_price=following)
        if is_doubtful or (is_same and not candidate.is_limited):
            return state, True
        if is_same:
            state = replace(state, effort=state.effort * _TUNED.more_effort)
        return state, False


def _is_closed(fleet: Fleet, state: SearchState, candidate: Round) -> bool:
    """Whether the gap is closed, to plans within the same budget or to all within Δ."""
    open_gap = relative_gap(state.incumbent.cost, bound_on_cost(fleet, state))
    if open_gap <= fleet.gap:
        return True
    if fleet.is_large and not candidate.is_initial and open_gap <= _TUNED.coarse_gap:
        return True
    is_fine = open_gap <= max(fleet.gap, _TUNED.fine_gap)
    # No plan within Δ by union bounds is cheaper; what a larger budget could still gain is
    # little, or rejected by the referee, or takes long.
    return is_proven(fleet, state) and (state.has_failed or is_fine or state.effort > 1)


def _after_initial_plan(state: SearchState, candidate: Round) -> SearchState:
    """Raise the price where the initial plan risks too much, before searching at length."""
    if candidate.risk > _TUNED.overdrawn * state.budget:
        tried = (*state.tried, (state.unit_price, candidate.risk))
        following = next_price(tried, state.budget - candidate.inter_set_risk)
        state = replace(state, tried=tried, unit_price=following)
    # Far from the budget, make it again at the new price.
    is_near = state.has_plan or candidate.risk <= _TUNED.far * state.budget
    is_enough = is_near or len(state.tried) >= _TUNED.max_initial_plans
    return replace(state, has_tried_initial_plan=is_enough)


def _is_at_jump(state: SearchState, candidate: Round) -> bool:
    """Whether one set's risk, above the budget, does not move with the price."""
    if len(candidate.sets) > 1 or candidate.is_limited or len(state.tried) < 2:
        return False
    (before, risk), (unit_price, same) = state.tried[-2:]
    return unit_price > before and same > state.budget and risk <= same * (1.0 + _TUNED.stubborn)


def _recorded(fleet: Fleet, state: SearchState, candidate: Round, seconds: float) -> SearchState:
    """Log a round, and add it to the record of the rounds; nothing else is changed."""
    state = replace(state, steps=(*state.steps, _step(fleet, state, candidate, seconds)))
    _tell(fleet, state, candidate)
    return state


def _tell(fleet: Fleet, state: SearchState, candidate: Round) -> None:
    """Log a round."""
    step, incumbent, plan = state.steps[-1], state.incumbent, "no plan yet"
    if incumbent.controls:
        plan = (
            f"best cost by faces {incumbent.cost:.6g}, gap {percent(step.gap)}, certificate "
            f"{incumbent.certified:.3g} of risk bound {fleet.scenario.risk_bound:g}"
        )
    _LOG.info(
        "%s %d: %s, the largest of %d; 1 %% of the risk bound at a price of %.3g; union "
        "bounds sum to %.3g, up to %.3g allowed; %s; %.2f s",
        step.stage,
        step.iteration + 1,
        count_text(len(candidate.sets), "set"),
        max(len(members) for members in candidate.sets),
        candidate.unit_price / fleet.unit * 0.01 * fleet.scenario.risk_bound,
        candidate.risk + candidate.inter_set_risk,
        state.budget,
        plan,
        step.seconds,
    )


def _step(fleet: Fleet, state: SearchState, candidate: Round, seconds: float) -> Step:
    """Return the record of a round."""
    plans = candidate.plans
    return Step(
        stage="initial" if candidate.is_initial else "round",
        vehicles=tuple(v.name for v in fleet.scenario.vehicles),
        iteration=len(state.steps),
        cost=sum(plan.cost for plan in plans),
        num_active=0,
        num_chosen=sum(plan.selection.size for plan in plans),
        allocated=state.budget,
        used=candidate.risk + candidate.inter_set_risk,
        gap=relative_gap(state.incumbent.cost, bound_on_cost(fleet, state)),
        nodes=sum(state.set_states[m].nodes for m in candidate.sets if m in state.set_states),
        seconds=seconds,
    )
