"""After a search without a plan: what else leads to one, and why there is none."""

from __future__ import annotations

from radmpc.planners.certified.fleet import Fleet
from radmpc.planners.certified.incumbent import FleetIncumbent
from radmpc.planners.certified.infeasible.cures import has_plan_within
from radmpc.planners.certified.infeasible.explanation import WhyNot, ended, why_not
from radmpc.planners.certified.more_faces import finer_scenarios
from radmpc.planners.certified.pricing import MORE_EFFORT
from radmpc.planners.certified.search import PriceSearch
from radmpc.planners.certified.turned.noiseless import turn_from_noiseless
from radmpc.planners.certified.turned.turning import plan_by_turning
from radmpc.planners.certified.within_budget import replan_with_alternatives

__all__ = ["last_resort"]

_TRIAL = 1.5
"""Time to find out whether more faces leave a plan to vehicles that have none [s]."""

_FOUND = WhyNot("", is_proven=False)
"""What there is to explain where a plan was found after all: nothing."""


def last_resort(search: PriceSearch) -> tuple[PriceSearch, WhyNot]:
    """Go on without a plan: from the safest, with more faces, with more effort, until time is up.

    Parameters
    ----------
    search : PriceSearch
        That found none.

    Returns
    -------
    search : PriceSearch
        The one that has a plan, if any has one after all: of the same fleet, or with more faces.
    answer : WhyNot
        The reason; what there is to say about the plan where one was found.
    """
    fleet, incumbent = search.fleet, search.incumbent
    scenario, limits = fleet.scenario, fleet.limits
    answer: WhyNot | None = None
    turn_from_noiseless(fleet, incumbent, search.judge)
    if incumbent.controls and fleet.budget > 0.0 and fleet.without_plan() is None:
        # Prices that were doubtful without any plan are not so with one: go on for a bound.
        search.run()
    while not limits.reached and not incumbent.controls:
        if answer is None:
            answer = why_not(scenario, limits)
            if answer.controls:
                _take(search, answer)
            if answer.blocked and not incumbent.controls:
                other, answer = _with_more_faces(search, answer)
                if other is not None:
                    return other, answer
            if answer.is_proven and not incumbent.controls:
                return search, answer
        else:
            search.effort *= MORE_EFFORT
        if fleet.budget <= 0.0:
            break
        if not limits.reached:
            search.run()
    if incumbent.controls:
        return search, _FOUND
    if answer is None or not answer.explanation:
        return search, WhyNot(ended(scenario, limits), is_proven=False)
    return search, answer


def _take(search: PriceSearch, answer: WhyNot) -> None:
    """Look for a certified plan from the safest that was met."""
    fleet, incumbent, judge = search.fleet, search.incumbent, search.judge
    replan_with_alternatives(fleet, incumbent, judge, answer.sets, answer.controls)
    if not incumbent.controls:
        plan_by_turning(fleet, incumbent, judge, answer.sets, answer.controls)


def _with_more_faces(search: PriceSearch, answer: WhyNot) -> tuple[PriceSearch | None, WhyNot]:
    """Search where more faces leave a plan to vehicles that have none; say what was tried."""
    fleet = search.fleet
    scenario, limits = fleet.scenario, fleet.limits
    tried: list[str] = []
    for finer in finer_scenarios(scenario):
        part = finer.scenario.subset(answer.blocked, scenario.risk_bound)
        tried.append(finer.text)
        if limits.reached or not has_plan_within(part, limits.within(_TRIAL)):
            continue
        other_fleet = Fleet(finer.scenario, fleet.gap, limits, fleet.progress, fleet.executor)
        other = PriceSearch(other_fleet, FleetIncumbent(), search.gap, search.judge)
        if other_fleet.budget > 0.0:
            other.run()
        if other.incumbent.controls:
            text = f"Planned with {finer.text}. By the faces of the scenario itself: "
            return other, WhyNot(text + answer.explanation, is_proven=False)
    text = answer.explanation
    if tried and not limits.reached:
        text += f" More faces opened no way: tried were {'; '.join(tried)}."
    return None, WhyNot(text, answer.is_proven, answer.controls, answer.sets)
