"""The last phase by faces: search within budgets where prices leave a gap."""

from __future__ import annotations

from dataclasses import replace

from radmpc.planners.certified.fleet import Fleet
from radmpc.planners.certified.rounds import Round
from radmpc.planners.certified.state.bounds import is_proven
from radmpc.planners.certified.state.search_state import SearchState
from radmpc.planners.certified.tuning import TUNING
from radmpc.planners.certified.within_budget import WithinBudget
from radmpc.solvers.priced.budget import OVER

__all__ = ["close_gap"]

_TUNED = TUNING.within


def close_gap(
    within: WithinBudget, state: SearchState, candidate: Round | None = None
) -> SearchState:
    """Search within the budget where prices leave a gap.

    Parameters
    ----------
    within : WithinBudget
        The search within a budget.
    state : SearchState
        What is known of the fleet.
    candidate : Round or None
        A plan of one set at a price that risks too much, where there is no other.

    Returns
    -------
    SearchState
        With what was found and certified, and the bounds that were proven.
    """
    fleet = within.fleet
    max_nodes = _TUNED.nodes * state.effort
    budget = _used_budget(state) if candidate is None else state.budget
    passed, failed = 0.0, float("inf")
    for _ in range(_TUNED.max_budgets):
        if fleet.limits.reached or is_proven(fleet, state):
            break
        sets, plans = state.incumbent.sets, within.plans(state.incumbent)
        if not state.has_plan and candidate is not None:
            sets, plans = candidate.sets, list(candidate.plans)
        cost = state.incumbent.cost
        found = within.search(state, sets, plans, budget, max_nodes)
        state = found.state
        if found.is_limited and len(sets) == 1:
            max_nodes *= TUNING.prices.more_effort
        if found.first_certificate > fleet.scenario.risk_bound:
            failed = min(failed, budget)
        elif found.first_certificate > 0.0:
            passed = max(passed, budget)
        now = state.incumbent.cost
        has_gained = now < cost - _TUNED.worthwhile * fleet.gap * abs(now)
        following = _next_budget(fleet, budget, passed, failed, found.first_certificate)
        if failed == float("inf") and has_gained:
            following = _used_budget(state)
        is_same = abs(following - budget) <= _TUNED.same_budget * budget
        if is_same and not (found.is_limited or has_gained):
            break
        budget = following
    if not state.has_plan:
        return state
    return replace(state, budget=fleet.clipped_budget(state.incumbent.union_bound))


def _used_budget(state: SearchState) -> float:
    """Return what union bounds may sum to, or do in the incumbent if that is more."""
    return max(state.budget, state.incumbent.union_bound)


def _next_budget(
    fleet: Fleet, budget: float, passed: float, failed: float, certificate: float
) -> float:
    """Return the budget to search within next, given what the referee passed and rejected."""
    least = fleet.least_budget
    if failed == float("inf"):
        return budget
    if passed > 0.0:
        return (passed * failed) ** 0.5 if passed < failed else passed
    if budget <= least * (1.0 + OVER):
        # The union bounds are the referee's, and what exceeds them is rounding.
        return least * (1.0 - 10.0 * OVER)
    share = _TUNED.aim * fleet.scenario.risk_bound / certificate if certificate > 0.0 else 1.0
    return max(least, budget * min(_TUNED.aim, share))
