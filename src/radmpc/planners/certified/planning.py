"""Planning a whole fleet at the right price of risk, with a certificate and a lower bound."""

from __future__ import annotations

import time
from collections.abc import Callable
from concurrent.futures import Executor
from dataclasses import replace

import numpy as np

from radmpc.model.plan import Status
from radmpc.model.scenario import Scenario
from radmpc.planners.certified.best import Best
from radmpc.planners.certified.fleet import Fleet
from radmpc.planners.certified.pricing import MORE_EFFORT
from radmpc.planners.certified.search import PriceSearch
from radmpc.planners.certified.verdict import Judge
from radmpc.planners.certified.why_not import why_not
from radmpc.planners.certified.within import take_sides
from radmpc.planners.draft import Draft
from radmpc.planners.planner import Planner
from radmpc.solvers.solution import Limits, relative_gap

__all__ = ["plan_certified"]

_ENDED = "Nothing was ruled out: raise the time limit."


def plan_certified(
    scenario: Scenario,
    planner: Planner,
    limits: Limits,
    executor: Executor | None,
    progress: Callable[[str, int, int | None], None],
    judge: Judge,
) -> Draft:
    """Plan a fleet to a proven gap; every plan returned is certified.

    Parameters
    ----------
    scenario : Scenario
        The question.
    planner : Planner
        Its gap.
    limits : Limits
        When to stop early.
    executor : Executor or None
        Where sets are searched; the plan is the same.
    progress : callable
        Told the stage, sets done, and of how many.
    judge : callable
        What the referee says of controls, in the scenario's order.

    Returns
    -------
    Draft
        With the best certified plan and a lower bound on the cost of any.
    """
    begun = time.perf_counter()
    fleet = Fleet(
        scenario, planner.gap, limits, lambda done, n: progress("sets", done, n), executor
    )
    best = Best()
    search = PriceSearch(fleet, best, planner.gap, judge)
    if fleet.budget > 0.0:
        search.run()
    if not best.controls:
        answer = _persist(search)
        if answer is not None:
            return replace(answer, seconds={"sets": time.perf_counter() - begun})
    search.close()
    seconds = {"sets": time.perf_counter() - begun}
    gap = planner.gap * (1.0 + 1e-6)
    bound = best.reported(fleet, gap)
    closed = relative_gap(best.cost, bound) <= gap
    return Draft(
        Status.OPTIMAL if closed else Status.FEASIBLE,
        best.controls,
        best.sets,
        tuple(best.steps),
        (),
        seconds,
        lower_bound=_finite(bound),
        price=best.price(fleet),
        couplings=fleet.couplings(best.sets),
    )


def _finite(bound: float) -> float | None:
    """Return a bound that says something."""
    return max(bound, 0.0) if np.isfinite(bound) else None


def _persist(search: PriceSearch) -> Draft | None:
    """Go on without a plan: by way of the safest, and by more effort, until time is up.

    Returns
    -------
    Draft or None
        Why there is no plan; None where there is one after all.
    """
    fleet, best = search.fleet, search.best
    answer = None
    while not fleet.limits.reached:
        if answer is None:
            answer = why_not(fleet.scenario, fleet.limits)
            if answer.is_proven:
                break
            if answer.controls:
                take_sides(fleet, best, search.judge, answer.sets, answer.controls)
        elif fleet.budget > 0.0:
            search.effort *= MORE_EFFORT
        if fleet.budget <= 0.0:
            break
        if not fleet.limits.reached:
            search.run()
        if best.controls:
            return None
    if best.controls:
        return None
    if answer is not None and answer.is_proven:
        return _nothing(Status.INFEASIBLE, answer.explanation, fleet.scenario.num_vehicles)
    return _nothing(Status.LIMIT, (answer and answer.explanation) or _ENDED)


def _nothing(status: Status, explanation: str, num_vehicles: int = 0) -> Draft:
    """Return that there is no plan."""
    sets = (tuple(range(num_vehicles)),) if num_vehicles else ()
    return Draft(status, (), sets, (), (), {}, explanation)
