"""Planning a whole fleet at the right price of risk, with a certificate and a lower bound."""

from __future__ import annotations

import logging
import time
from collections.abc import Callable
from concurrent.futures import Executor

import numpy as np

from radmpc.model.plan import Status
from radmpc.model.scenario import Scenario
from radmpc.planners.certified.best import Best, RiskOf, take
from radmpc.planners.certified.fleet import Fleet
from radmpc.planners.certified.last_resort import last_resort
from radmpc.planners.certified.pricing import MORE_EFFORT, OVERDRAWN, next_price, price_alone
from radmpc.planners.certified.rounds import Round, run_round
from radmpc.planners.certified.why_not import WhyNot, sure_why_not
from radmpc.planners.draft import Draft, Step
from radmpc.planners.planner import Planner
from radmpc.solvers.solution import Limits, relative_gap

__all__ = ["plan_certified"]

_LOG = logging.getLogger(__name__)

_MAX_ROUNDS = 40
_SEARCH_SHARE = 0.5
_MAX_SKETCHES = 8
_HOPELESS = 1e3
"""Multiple of the first price at which the bound itself is doubted."""

_FAR = 1.6
"""Multiple of the budget beyond which a sketch is drawn again."""

_SAME = 1e-4
"""Relative difference below which two prices are one."""

_FINE = 2e-3
"""Gap to plans that spend as much that is small enough once Δ itself is proven."""


def plan_certified(
    scenario: Scenario,
    planner: Planner,
    limits: Limits,
    executor: Executor | None,
    progress: Callable[[str, int, int | None], None],
    risk_of: RiskOf,
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
    risk_of : callable
        What the referee says that controls risk, in the scenario's order.

    Returns
    -------
    Draft
        With the best certified plan and a lower bound on the cost of any.
    """
    begun = time.perf_counter()
    ruled_out = sure_why_not(scenario, limits)
    if ruled_out is not None:
        return _empty(scenario, ruled_out, begun)
    fleet = Fleet(
        scenario, planner.gap, limits, lambda done, n: progress("sets", done, n), executor
    )
    best = Best()
    if fleet.budget > 0.0:
        _search(fleet, best, planner.gap, risk_of)
    explanation = ""
    if not best.controls:
        fleet, answer = last_resort(
            fleet, best, risk_of, lambda other, found: _search(other, found, planner.gap, risk_of)
        )
        if not best.controls:
            return _empty(scenario, answer, begun)
        explanation = answer.explanation
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


def _search(
    fleet: Fleet,
    best: Best,
    gap: float,
    risk_of: RiskOf,
) -> None:
    """Search for the price at which the fleet just uses its budget."""
    tried: list[tuple[float, float]] = []
    price, effort = price_alone(fleet, tried), 1
    for _ in range(_MAX_ROUNDS):
        began = time.perf_counter()
        found = run_round(fleet, price, effort)
        if found is None:
            if fleet.limits.reached or fleet.without_plan() is not None:
                return
            effort *= MORE_EFFORT
            continue
        best.rounds.append((found.least, price))
        take(fleet, found, best, risk_of)
        best.steps.append(_step(fleet, found, best, time.perf_counter() - began))
        _tell(fleet, found, best)
        if relative_gap(best.cost, best.bound(fleet)) <= gap or fleet.limits.reached:
            return
        is_proven = relative_gap(best.cost, best.reported(fleet, gap)) <= gap
        is_fine = relative_gap(best.cost, best.bound(fleet)) <= max(gap, _FINE)
        if is_proven and (best.has_failed or is_fine or effort > 1):
            # No plan within Δ by simple bounds is cheaper; what spending more of the referee's
            # leave could still gain is little, or out of its leave, or dear.
            return
        if found.is_sketch:
            if found.risk > OVERDRAWN * fleet.budget:
                # These sides risk too much at this price: raise it before searching at length.
                tried.append((price, found.risk))
                price = next_price(tried, fleet.budget - found.cross)
            # Far from any plan draw again, at the new price.
            is_near = bool(best.controls) or found.risk <= _FAR * fleet.budget
            fleet.is_sketched = is_near or len(tried) >= _MAX_SKETCHES
            continue
        if found.is_limited and found.open_gap > _SEARCH_SHARE * (best.cost - best.bound(fleet)):
            # The searches leave more open than a better price could close.
            if is_proven:
                return
            effort *= MORE_EFFORT
            continue
        tried.append((price, found.risk))
        following = next_price(tried, fleet.budget - found.cross)
        if not best.controls and following > _HOPELESS * fleet.first_price():
            return
        if abs(following - price) <= _SAME * price:
            if not found.is_limited:
                return
            effort *= MORE_EFFORT
        price = following


def _tell(fleet: Fleet, found: Round, best: Best) -> None:
    """Log a round."""
    step, plan = best.steps[-1], "no plan yet"
    if best.controls:
        plan = (
            f"best {best.cost:.6g}, gap {100.0 * step.gap:.2g} %, certificate {best.certified:.3g}"
        )
    _LOG.info(
        "%s %d: %d sets, the largest of %d; price of risk %.3g, risk %.3g of %.3g; %s; %.2f s",
        step.stage,
        step.iteration + 1,
        len(found.sets),
        max(len(members) for members in found.sets),
        found.price,
        found.risk + found.cross,
        fleet.budget,
        plan,
        step.seconds,
    )


def _step(fleet: Fleet, found: Round, best: Best, seconds: float) -> Step:
    """Return the record of a round."""
    plans = found.plans
    return Step(
        stage="sketch" if found.is_sketch else "round",
        vehicles=tuple(v.name for v in fleet.scenario.vehicles),
        iteration=len(best.steps),
        cost=sum(plan.cost for plan in plans),
        num_active=0,
        num_chosen=sum(plan.selection.size for plan in plans),
        allocated=fleet.budget,
        used=found.risk + found.cross,
        gap=relative_gap(best.cost, best.bound(fleet)),
        nodes=sum(fleet.states[m].nodes for m in found.sets if m in fleet.states),
        seconds=seconds,
    )
