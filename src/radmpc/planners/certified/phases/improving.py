"""Turning half-spaces once the search is over: to its plan, and to others that may be better."""

from __future__ import annotations

from radmpc.model.scenario import Scenario
from radmpc.planners.certified.fleet import Fleet
from radmpc.planners.certified.phases.tuning import TUNING as PHASES
from radmpc.planners.certified.proof.prove import Proof
from radmpc.planners.certified.proof.tuning import TUNING as PROOF_TUNING
from radmpc.planners.certified.state.bounds import (
    bound_of_programs,
    finite,
    reported_bound,
    shadow_price,
)
from radmpc.planners.certified.state.incumbent import FleetIncumbent
from radmpc.planners.certified.state.search_state import SearchState
from radmpc.planners.certified.turned.price_tuning import PRICE_TUNING
from radmpc.planners.certified.turned.tuning import TUNING
from radmpc.planners.planner import Run
from radmpc.planners.verdict import Judge
from radmpc.records import replace
from radmpc.solvers.solution import relative_gap

__all__ = ["cheaper", "improved", "is_searched_nearby", "searched_nearby", "turned_to_others"]


def improved(fleet: Fleet, state: SearchState, first: FleetIncumbent, judge: Judge) -> SearchState:
    """Turn half-spaces to the plan of the search, and again to a first plan that stays cheaper.

    Parameters
    ----------
    fleet : Fleet
        The fleet.
    state : SearchState
        Where the search ended.
    first : FleetIncumbent
        A plan made before the search, if any.
    judge : callable
        The referee.

    Returns
    -------
    SearchState
        With the cheaper of the two.
    """
    searched, least = state.incumbent, float(sum(fleet.base))
    if relative_gap(min(first.cost, searched.cost), least) > PRICE_TUNING.negligible * fleet.gap:
        from radmpc.planners.certified.turned.turned_plans import turn_half_spaces  # noqa: PLC0415 - vehicles without conflicts do without

        if state.has_plan:
            state = _turned(fleet, state, judge)
        if first.cost < state.incumbent.cost:
            begin = replace(state, incumbent=first)
            first = turn_half_spaces(fleet, begin, judge, state.incumbent.cost).incumbent
    return cheaper(state, first, searched)


def searched_nearby(fleet: Fleet, state: SearchState, run: Run) -> SearchState:
    """Search neighborhoods of the plan of a few vehicles, if the search left a gap.

    Parameters
    ----------
    fleet : Fleet
        The fleet, with the limits of its improvement.
    state : SearchState
        With a plan, or without.
    run : Run
        The referee, and what draws.

    Returns
    -------
    SearchState
        With a cheaper plan where there is one.
    """
    if not (is_searched_nearby(fleet.scenario) and state.has_plan) or fleet.limits.reached:
        return state
    found = state.incumbent
    if relative_gap(found.cost, bound_of_programs(fleet, state, fleet.gap)) <= PHASES.ajar:
        return state
    from radmpc.planners.certified.phases.neighborhoods import search_neighborhoods  # noqa: PLC0415 - few need it

    share = PHASES.share_in_the_open * fleet.limits.seconds_left
    fleet = fleet.with_limits(fleet.limits.within(share))
    bound = finite(reported_bound(fleet, state, fleet.gap))

    def on_cheaper(cheaper: FleetIncumbent) -> None:
        run.found(cheaper.cost, bound)
        run.improved(cheaper.controls)

    found = search_neighborhoods(fleet, found, run.judge, run.rng.spawn(1)[0], on_cheaper)
    return replace(state, incumbent=found)


def is_searched_nearby(scenario: Scenario) -> bool:
    """Whether neighborhoods of plans are searched after the search: few vehicles, few obstacles.

    Fewer than five among obstacles have had theirs searched before it, and in space these are
    drawn, not replanned, which leads to nothing there.

    Parameters
    ----------
    scenario : Scenario
        The fleet.
    """
    least = 2
    if scenario.obstacles:
        least = TUNING.many
        if scenario.dimension != 2 or len(scenario.obstacles) >= TUNING.many_obstacles:
            return False
    return least <= scenario.num_vehicles <= TUNING.few and not scenario.has_windows


def cheaper(
    state: SearchState, first: FleetIncumbent, searched: FleetIncumbent | None = None
) -> SearchState:
    """Return the state with a first plan, where that is cheaper than its own.

    Parameters
    ----------
    state : SearchState
        With a plan, or without.
    first : FleetIncumbent
        A plan made before the search, if any.
    searched : FleetIncumbent or None
        What the search ended with: its sets and its budget say what had to be planned together;
        None is the state's own.
    """
    if first.cost >= state.incumbent.cost:
        return state
    searched = searched or state.incumbent
    sets = searched.sets or first.sets
    return replace(state, incumbent=replace(first, sets=sets, union_bound=searched.union_bound))


def _turned(fleet: Fleet, state: SearchState, judge: Judge) -> SearchState:
    """Turn half-spaces to the plan of the search, and to others where risk was not its limit."""
    # A vehicle without conflicts costs no more than in empty space: nothing is turned.
    from radmpc.planners.certified.turned.turned_plans import turn_half_spaces  # noqa: PLC0415 - vehicles without conflicts do without

    state = turn_half_spaces(fleet, state, judge)
    if state.incumbent.certified < TUNING.unspent * fleet.scenario.risk_bound:
        # Not risk but the faces made the plan what it is. (Tried for all
        # fleets of up to four: 0.03 to 0.3 % cheaper, in two to four times the time.)
        from radmpc.planners.certified.turned.noiseless import turn_from_noiseless  # noqa: PLC0415 - few need it

        state = turn_from_noiseless(fleet, state, judge)
    return state


def turned_to_others(fleet: Fleet, state: SearchState, proof: Proof, judge: Judge) -> SearchState:
    """Turn half-spaces to plans of the relaxation and without noise, where these may be better.

    Parameters
    ----------
    fleet : Fleet
        The fleet.
    state : SearchState
        With a plan.
    proof : Proof
        What the relaxation says.
    judge : callable
        The referee.

    Returns
    -------
    SearchState
        With a cheaper plan where there is one.
    """
    gap = relative_gap(state.incumbent.cost, proof.bound)
    if gap > PROOF_TUNING.gap and proof.controls and not fleet.limits.reached:
        from radmpc.planners.certified.turned.turned_plans import turn_to  # noqa: PLC0415 - vehicles without conflicts do without

        price = shadow_price(fleet, state) or fleet.first_unit_price(state.budget) / fleet.unit
        state = turn_to(fleet, state, judge, proof.controls, price, is_outside=proof.is_outside)
        gap = relative_gap(state.incumbent.cost, proof.bound)
    if gap > PROOF_TUNING.doubtful:
        from radmpc.planners.certified.turned.noiseless import turn_from_noiseless  # noqa: PLC0415 - few need it

        sets = state.incumbent.sets
        state = turn_from_noiseless(fleet, state, judge)
        # Which vehicles had to be planned together is what the search found, not the sets here.
        state = replace(state, incumbent=replace(state.incumbent, sets=sets))
    return state
