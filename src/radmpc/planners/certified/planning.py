"""Planning a whole fleet at the right price of risk, with a certificate and a lower bound."""

from __future__ import annotations

import time
from collections.abc import Callable
from concurrent.futures import Executor

import numpy as np

from radmpc.model.plan import Status
from radmpc.model.scenario import Scenario
from radmpc.planners.certified.best import Best
from radmpc.planners.certified.fleet import Fleet
from radmpc.planners.certified.last_resort import last_resort
from radmpc.planners.certified.noiseless import turn_from_noiseless
from radmpc.planners.certified.search import PriceSearch
from radmpc.planners.certified.turning import turn_half_spaces
from radmpc.planners.certified.verdict import Judge
from radmpc.planners.certified.why_not import WhyNot, sure_why_not
from radmpc.planners.draft import Draft
from radmpc.planners.planner import Planner
from radmpc.solvers.solution import Limits, relative_gap

__all__ = ["plan_certified"]

_TURNING_SHARE, _TURNING_SECONDS, _MOST_SHARE = 0.1, 1.0, 0.3
"""Time kept back for turning half-spaces to a plan: a share of the limit, or seconds up to a larger
share of it. Turning takes 0.3 to 4 s on the families of the benchmarks."""

_LEAST_TURNING = 2.0
"""Time that turning is granted at least, if the limit leaves it [s]."""

_UNSPENT = 0.5
"""Share of Δ below which the referee leaves so much that other sides are tried."""


def plan_certified(
    scenario: Scenario,
    planner: Planner,
    limits: Limits,
    executor: Executor | None,
    progress: Callable[[str, int, int | None], None],
    judge: Judge,
    tell_best: Callable[[float, float | None], None],
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
    tell_best : callable
        Told the cost of the best plan so far, and a lower bound or None.

    Returns
    -------
    Draft
        With the best certified plan and a lower bound on the cost of any.
    """
    begun = time.perf_counter()
    ruled_out = sure_why_not(scenario, limits)
    if ruled_out is not None:
        return _empty(scenario, ruled_out, begun)
    granted = limits.seconds_left
    kept = max(_TURNING_SHARE * granted, min(_TURNING_SECONDS, _MOST_SHARE * granted))
    begin = limits if granted == float("inf") else limits.within(granted - kept)

    def tell(done: int, total: int) -> None:
        progress("sets", done, total)
        if best.controls:
            tell_best(best.cost, _finite(best.reported(fleet, planner.gap)))

    fleet = Fleet(scenario, planner.gap, begin, tell, executor)
    best = Best()
    search = PriceSearch(fleet, best, planner.gap, judge)
    if fleet.budget > 0.0:
        search.run()
    # Turning has time of its own, kept back from the search.
    stopped_by = begin.reason or None
    explanation = ""
    if not best.controls:
        fleet.limits = limits
        search, answer = last_resort(search)
        fleet, best = search.fleet, search.best
        if not best.controls:
            return _empty(scenario, answer, begun)
        explanation = answer.explanation
    search.close()
    stopped_by = stopped_by or begin.reason or None
    tell_best(best.cost, _finite(best.reported(fleet, planner.gap)))
    progress("polishing", 0, 1)
    # Large fleets gain little by the second: not longer than the search took.
    fleet.limits = limits.within(max(_LEAST_TURNING, time.perf_counter() - begun))
    turn_half_spaces(fleet, best, judge)
    if best.certified < _UNSPENT * scenario.risk_bound:
        # Not risk but the faces, or their sides, made the plan what it is. (Tried for all fleets of
        # up to four: 0.03 to 0.3 % cheaper, in two to four times the time.)
        turn_from_noiseless(fleet, best, judge)
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
        explanation or None,
        lower_bound=_finite(bound),
        price=best.price(fleet),
        couplings=fleet.couplings(best.sets),
        stopped_by=stopped_by,
    )


def _empty(scenario: Scenario, answer: WhyNot, begun: float) -> Draft:
    """Return that there is no plan, and why."""
    status = Status.INFEASIBLE if answer.is_proven else Status.LIMIT
    sets = (tuple(range(scenario.num_vehicles)),) if answer.is_proven else ()
    seconds = {"sets": time.perf_counter() - begun}
    return Draft(status, (), sets, (), (), seconds, answer.explanation)


def _finite(bound: float) -> float | None:
    """Return a bound that says something."""
    return max(bound, 0.0) if np.isfinite(bound) else None
