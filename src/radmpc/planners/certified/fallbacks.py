"""After a search without a plan: what else leads to one, and why there is none."""

from __future__ import annotations

from radmpc.model.scenario import Scenario
from radmpc.planners.certified.fleet import Fleet
from radmpc.planners.certified.infeasible.answer import WhyNot
from radmpc.planners.certified.infeasible.ended import ended
from radmpc.planners.certified.infeasible.explanation import why_not
from radmpc.planners.certified.infeasible.least_risk import feasible_within
from radmpc.planners.certified.infeasible.rarely_hit import rarely_hit
from radmpc.planners.certified.infeasible.tuning import TUNING as WITHOUT
from radmpc.planners.certified.more_faces import Finer, faces_text, finer_scenarios
from radmpc.planners.certified.search import PriceSearch
from radmpc.planners.certified.state.search_state import SearchState
from radmpc.planners.certified.tuning import TUNING
from radmpc.planners.certified.turned.noiseless import turn_from_noiseless
from radmpc.planners.certified.turned.tuning import TUNING as TURNING
from radmpc.planners.certified.turned.turned_plans import plan_by_turning
from radmpc.planners.certified.within_budget import replan_with_alternatives
from radmpc.records import dataclass, replace

__all__ = ["LastResort", "last_resort"]

_FOUND = WhyNot("", is_proven=False)
"""What there is to explain where a plan was found after all: nothing."""


@dataclass(frozen=True, slots=True, eq=False)
class LastResort:
    """How the last resort ended.

    Attributes
    ----------
    search : PriceSearch
        The one that has a plan, if any has one after all: of the same fleet, or with more faces.
    state : SearchState
        How far its search has come.
    answer : WhyNot
        Why there is no plan; what there is to say about the plan where one was found.
    """

    search: PriceSearch
    state: SearchState
    answer: WhyNot


def last_resort(
    search: PriceSearch, state: SearchState, *, is_persistent: bool = True
) -> LastResort:
    """Go on without a plan: from the safest, with more faces, with more effort, until time is up.

    Parameters
    ----------
    search : PriceSearch
        That found none.
    state : SearchState
        Where it ended.
    is_persistent : bool
        Whether to go on where a plan without noise leads to none either.

    Returns
    -------
    LastResort
        With a plan if one was found after all; with the reason otherwise.
    """
    fleet = search.fleet
    scenario, limits = fleet.scenario, fleet.limits
    answer: WhyNot | None = None
    # Not all of the time: the safest plan is tried in any case.
    some = limits.within(TURNING.most_time_from_noiseless * limits.seconds_left)
    state = turn_from_noiseless(fleet.with_limits(some), state, search.judge)
    if state.has_plan and state.budget > 0.0 and state.without_plan() is None:
        # Prices that were doubtful without any plan are not so with one: go on for a bound.
        state = search.run(state)
    while is_persistent and not limits.reached and not state.has_plan:
        if answer is None:
            answer = why_not(scenario, limits)
            is_ruled_out = answer.is_proven
            if answer.controls:
                state = _from_safest(search, state, answer)
            if answer.blocked and not state.has_plan:
                other, answer = _with_more_faces(search, answer)
                other = other or _through_rarely_hit(search, answer)
                if other is not None:
                    return other
            # More effort by the same faces finds no plan that is ruled out by them.
            if is_ruled_out and not state.has_plan:
                return LastResort(search, state, answer)
        else:
            state = replace(state, effort=state.effort * TUNING.prices.more_effort)
        if state.budget <= 0.0:
            break
        if not limits.reached:
            state = search.run(state)
    if state.has_plan:
        return LastResort(search, state, _FOUND)
    if answer is None or not answer.explanation:
        answer = WhyNot(ended(scenario, limits, fleet.programs.models), is_proven=False)
    return LastResort(search, state, answer)


def _from_safest(search: PriceSearch, state: SearchState, answer: WhyNot) -> SearchState:
    """Look for a certified plan from the safest that was met."""
    fleet, judge = search.fleet, search.judge
    state = replan_with_alternatives(fleet, state, judge, answer.sets, answer.controls)
    if state.has_plan:
        return state
    return plan_by_turning(fleet, state, judge, answer.sets, answer.controls)


def _with_more_faces(search: PriceSearch, answer: WhyNot) -> tuple[LastResort | None, WhyNot]:
    """Search where more faces leave a plan to vehicles that have none; say what was tried."""
    scenario, limits = search.fleet.scenario, search.fleet.limits
    ruled_out: list[Finer] = []
    unplanned: list[Finer] = []
    untold, is_cut_off = tuple(finer_scenarios(scenario)), False
    # All of them shortly first: where one of them leaves a plan, that is soon known, as a rule.
    for seconds in WITHOUT.face_trials:
        still: list[Finer] = []
        for finer in untold:
            part = finer.scenario.subset(answer.blocked, scenario.risk_bound)
            trial = limits.within(seconds)
            has_plan = feasible_within(part, trial)
            if has_plan is None:
                still.append(finer)
                is_cut_off |= trial.reached
            elif not has_plan:
                ruled_out.append(finer)
            else:
                found = _planned_with(search, finer, answer)
                if found is not None:
                    return found, found.answer
                unplanned.append(finer)
        untold = tuple(still)
    text = answer.explanation
    if ruled_out:
        text += f" More faces allowed no plan: tried were {faces_text(ruled_out)}."
    if unplanned:
        faces = faces_text(unplanned)
        text += (
            f" A plan of these vehicles exists with {faces}, but no plan of the whole fleet was "
            "found with them."
        )
    if untold:
        given = f"each was given up to {WITHOUT.face_trials[-1]:g} s"
        why = limits.reason or (given if is_cut_off else "searches ended without an answer")
        text += f" Whether a plan exists with {faces_text(untold)} is not known: {why}."
    is_proven = answer.is_proven and not (untold or unplanned)
    return None, replace(answer, explanation=text, is_proven=is_proven)


def _planned_with(search: PriceSearch, finer: Finer, answer: WhyNot) -> LastResort | None:
    """Plan with more faces; None where no plan is found."""
    text = f"Planned with {finer.text}. By the faces of the scenario itself: {answer.explanation}"
    return _planned_in(search, finer.scenario, text)


def _through_rarely_hit(search: PriceSearch, answer: WhyNot) -> LastResort | None:
    """Plan without obstacles that the referee charges little anywhere; None without a plan."""
    fleet = search.fleet
    fewer = rarely_hit(fleet.scenario, fleet.programs.models)
    if fewer is None or fleet.limits.reached:
        return None
    text = f"{fewer.text} By the faces of the scenario itself: {answer.explanation}"
    # What they may be hit with is for the referee to say, and left of Δ meanwhile.
    return _planned_in(search, fewer.scenario, text, fewer.risk)


def _planned_in(
    search: PriceSearch, scenario: Scenario, text: str, reserved: float = 0.0
) -> LastResort | None:
    """Plan another scenario for the same referee; None where no plan is found."""
    fleet = search.fleet
    limits, progress = fleet.limits, fleet.progress
    other = Fleet.of(scenario, fleet.gap, limits, progress=progress, executor=fleet.executor)
    if reserved > 0.0:
        first = max(other.first_budget - reserved, 0.0)
        other = replace(other, initial=other.initial + reserved, first_budget=first)
    other_search, state = PriceSearch.of(other, search.judge), SearchState.of(other)
    if state.budget > 0.0:
        state = other_search.run(state)
    if not state.has_plan:
        return None
    return LastResort(other_search, state, WhyNot(text, is_proven=False))
