"""After a search without a plan: the reason, the safest plan met on the way, and more faces."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from radmpc.planners.certified.best import Best, RiskOf
from radmpc.planners.certified.cures import has_plan_within
from radmpc.planners.certified.finer import finer_scenarios
from radmpc.planners.certified.fleet import Fleet
from radmpc.planners.certified.why_not import WhyNot, ended, why_not

__all__ = ["last_resort"]

_TRIAL = 1.5
"""Time to find out whether more faces open a way to those who have none [s]."""

Search = Callable[[Fleet, Best], None]
"""Searches for plans of a fleet and keeps the best."""


def last_resort(fleet: Fleet, best: Best, risk_of: RiskOf, search: Search) -> tuple[Fleet, WhyNot]:
    """Say why there is no plan, and find one after all if the faces alone stood in its way.

    Parameters
    ----------
    fleet : Fleet
        Whose search found none.
    best : Best
        Takes the plan, if there is one after all.
    risk_of : callable
        What the referee says that controls risk.
    search : callable
        The search, for the same fleet with more faces.

    Returns
    -------
    fleet : Fleet
        The one that `best` is a plan of.
    answer : WhyNot
        The reason; what there is to say about the plan where one was found.
    """
    scenario, limits = fleet.scenario, fleet.limits
    if limits.reached:
        return fleet, WhyNot(ended(scenario, limits), is_proven=False)
    answer = why_not(scenario, limits)
    if answer.controls and risk_of(answer.controls) <= scenario.risk_bound:
        best.controls, best.sets = answer.controls, answer.sets
        best.cost = sum(
            vehicle.cost_weight * float(np.abs(controls).sum())
            for vehicle, controls in zip(scenario.vehicles, answer.controls, strict=True)
        )
        return fleet, WhyNot("", is_proven=False)
    if not answer.blocked:
        return fleet, answer
    tried: list[str] = []
    for finer in finer_scenarios(scenario):
        part = finer.scenario.subset(answer.blocked, scenario.risk_bound)
        tried.append(finer.text)
        if limits.reached or not has_plan_within(part, limits.within(_TRIAL)):
            continue
        other = Fleet(finer.scenario, fleet.gap, limits, fleet.progress, fleet.executor)
        search(other, best)
        if best.controls:
            text = f"Planned with {finer.text}. By the faces of the scenario itself: "
            return other, WhyNot(text + answer.explanation, is_proven=False)
    text = answer.explanation
    if tried and not limits.reached:
        text += f" More faces opened no way: tried were {'; '.join(tried)}."
    return fleet, WhyNot(text, answer.is_proven)
