"""Planning a whole fleet at the right price of risk, with a certificate and a lower bound."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, field, replace

import numpy as np

from radmpc.arrays import Matrix, Vector
from radmpc.model.plan import Status
from radmpc.model.scenario import Scenario
from radmpc.planners.certified.fitting import fitted
from radmpc.planners.certified.fleet import Fleet
from radmpc.planners.certified.polish import repriced
from radmpc.planners.certified.rounds import Round, run_round
from radmpc.planners.certified.why_not import why_not
from radmpc.planners.planner import Planner
from radmpc.planners.result import Draft, Step
from radmpc.solvers.solution import Limits, relative_gap

__all__ = ["plan_certified"]

_MAX_ROUNDS = 40
_MORE_EFFORT = 3
_SEARCH_SHARE = 0.5
_MAX_SKETCHES = 8
_MAX_PRICES = 6
_MOST = 12.0
_HOPELESS = 1e3
"""Multiple of the first price at which the bound itself is doubted."""

_ENDED = "Nothing was ruled out: raise the time limit."
_LITTLE = 1e-3
"""Share of the unit below which a vehicle's risk does not tell the price."""

_OVERDRAWN = 1.2
_FAR_OVERDRAWN = 1.6
_FITS = 5
_SAME = 1e-4
"""Relative difference below which two prices are one."""

_SPENT = 0.85
"""Share of Δ from which on the referee's figure counts as used up."""

_FINE = 2e-3
"""Gap to plans that spend as much that is small enough once Δ itself is proven."""

_AIM = 0.95
_BACK_OFF = 0.97
_STRETCH = 3.0
_STEEPNESS = 1.15
_CLOSE = 0.03
"""Share of the budget that may stay unused when the price is right."""


RiskOf = Callable[[tuple[Matrix, ...]], float]
"""The referee's certificate of every vehicle's controls."""


@dataclass(slots=True, eq=False)
class _Best:
    """The best certified plan so far, and what the rounds proved."""

    controls: tuple[Matrix, ...] = ()
    cost: float = float("inf")
    spent: float = 0.0
    too_much: float = float("inf")
    has_failed: bool = False
    sets: tuple[tuple[int, ...], ...] = ()
    rounds: list[tuple[float, float]] = field(default_factory=list)
    steps: list[Step] = field(default_factory=list)

    def bound(self, fleet: Fleet) -> float:
        """Return the least cost of any plan whose simple bounds sum to no more than its own."""
        return self._bound(max(fleet.budget, self.spent) / fleet.unit)

    def reported(self, fleet: Fleet, gap: float) -> float:
        """Return a lower bound on the cost of any plan whose simple bounds sum to Δ at most.

        If the gap is closed, that of plans whose simple bounds sum to what this one's do: lower,
        and saying more.
        """
        bound = self.bound(fleet)
        if relative_gap(self.cost, bound) > gap:
            bound = self._bound((fleet.scenario.risk_bound - fleet.initial) / fleet.unit)
        return min(bound, self.cost)

    def _bound(self, units: float) -> float:
        """Return the least cost within a budget."""
        return max((least - price * units for least, price in self.rounds), default=-np.inf)


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
    fleet = Fleet(
        scenario, planner.gap, limits, lambda done, n: progress("sets", done, n), executor
    )
    best = _Best()
    if fleet.budget > 0.0:
        _search(fleet, best, planner.gap, risk_of)
    if not best.controls:
        answer = _without_plan(fleet, best, risk_of)
        if not best.controls:
            return replace(answer, seconds={"sets": time.perf_counter() - begun})
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
    )


def _finite(bound: float) -> float | None:
    """Return a bound that says something."""
    return max(bound, 0.0) if np.isfinite(bound) else None


def _search(
    fleet: Fleet,
    best: _Best,
    gap: float,
    risk_of: RiskOf,
) -> None:
    """Search for the price at which the fleet just uses its budget."""
    tried: list[tuple[float, float]] = []
    price, effort = _price_alone(fleet, tried), 1
    for _ in range(_MAX_ROUNDS):
        began = time.perf_counter()
        found = run_round(fleet, price, effort)
        if found is None:
            if fleet.limits.reached or fleet.without_plan() is not None:
                return
            effort *= _MORE_EFFORT
            continue
        best.rounds.append((found.least, price))
        _take(fleet, found, best, risk_of)
        best.steps.append(_step(fleet, found, best, time.perf_counter() - began))
        if relative_gap(best.cost, best.bound(fleet)) <= gap or fleet.limits.reached:
            return
        is_proven = relative_gap(best.cost, best.reported(fleet, gap)) <= gap
        is_fine = relative_gap(best.cost, best.bound(fleet)) <= max(gap, _FINE)
        if is_proven and (best.has_failed or is_fine or effort > 1):
            # No plan within Δ by simple bounds is cheaper; what spending more of the referee's
            # leave could still gain is little, or out of its leave, or dear.
            return
        if found.is_sketch:
            if found.risk > _OVERDRAWN * fleet.budget:
                # These sides risk too much at this price: raise it before searching at length.
                tried.append((price, found.risk))
                price = _next_price(tried, fleet.budget - found.cross)
            # Far from any plan draw again, at the new price.
            is_near = bool(best.controls) or found.risk <= _FAR_OVERDRAWN * fleet.budget
            fleet.is_sketched = is_near or len(tried) >= _MAX_SKETCHES
            continue
        if found.is_limited and found.open_gap > _SEARCH_SHARE * (best.cost - best.bound(fleet)):
            # The searches leave more open than a better price could close.
            if is_proven:
                return
            effort *= _MORE_EFFORT
            continue
        tried.append((price, found.risk))
        following = _next_price(tried, fleet.budget - found.cross)
        if not best.controls and following > _HOPELESS * fleet.first_price():
            return
        if abs(following - price) <= _SAME * price:
            if not found.is_limited:
                return
            effort *= _MORE_EFFORT
        price = following


def _step(fleet: Fleet, found: Round, best: _Best, seconds: float) -> Step:
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


def _price_alone(fleet: Fleet, tried: list[tuple[float, float]]) -> float:
    """Return a price at which vehicles that ignore each other do not exceed the budget by far."""
    price = fleet.first_price()
    # Where known sides risk too much at any price, others are needed, not a higher price.
    most = _MOST * price
    fleet.solve(fleet.singles, price, 1)
    effort = 1
    while missing := [m for m in fleet.singles if fleet.states[m].best is None]:
        if fleet.limits.reached or fleet.without_plan() is not None:
            return price
        effort *= _MORE_EFFORT
        fleet.solve(missing, price, effort)
    plans = [fleet.best(m) for m in fleet.singles]
    for _ in range(_MAX_PRICES):
        risk = sum(plan.risk for plan in plans)
        if risk <= _OVERDRAWN * fleet.budget or fleet.limits.reached:
            break
        tried.append((price, risk))
        price = min(_next_price(tried, fleet.budget), most)
        # By the sides found so far: no need to search for others yet.
        plans = [
            repriced(fleet.problems[m], plan, fleet.unit, price, fleet.limits)
            if plan.risk > _LITTLE * fleet.unit
            else plan
            for m, plan in zip(fleet.singles, plans, strict=True)
        ]
    tried.clear()
    return price


def _take(fleet: Fleet, found: Round, best: _Best, risk_of: RiskOf) -> None:
    """Keep a round's plan if it is certified and better than what there is.

    What simple bounds sum to and what the referee finds differ: fitted to more or less of the
    former, the sides of the round come to just below Δ by the latter.
    """
    granted = fleet.scenario.risk_bound
    budget, low, high = fleet.budget, 0.0, float("inf")
    cross = found.cross
    for _ in range(_FITS):
        points = fitted(fleet, found, budget, cross)
        if points is None:
            if high == float("inf"):
                break
            # Too little for these sides, and `high` too much.
            budget = 0.5 * (budget + high)
            continue
        risk = _keep(fleet, found, points, best, risk_of, budget)
        if risk > granted:
            high = min(high, budget)
            cross = 2.0 * cross + 0.02 * budget
        else:
            low = max(low, budget)
            if risk >= _SPENT * granted:
                break
        following = budget * min(_STRETCH, _AIM * granted / max(risk, 1e-12))
        if low and high < float("inf"):
            following = (low * high) ** 0.5
        following = min(following, fleet.most_budget)
        if abs(following - budget) <= _CLOSE * budget:
            break
        budget = following
    best.has_failed = high < float("inf") and not low
    if low:
        fleet.set_budget(min(low, _BACK_OFF * best.too_much))
    elif best.has_failed:
        # The referee finds more in these sides: nearer to Δ, where it cannot.
        best.too_much = min(best.too_much, fleet.budget)
        fleet.set_budget(_BACK_OFF * (fleet.budget * (granted - fleet.initial)) ** 0.5)
    elif not best.controls:
        _keep(fleet, found, [plan.z for plan in found.plans], best, risk_of, found.risk + cross)


def _keep(
    fleet: Fleet,
    found: Round,
    points: Sequence[Vector],
    best: _Best,
    risk_of: RiskOf,
    spent: float,
) -> float:
    """Keep a plan if it is certified and the best; return what the referee says it risks."""
    controls = fleet.controls(found.sets, points)
    risk = risk_of(controls)
    pairs = zip(found.sets, points, strict=True)
    cost = sum(float(fleet.problems[m].program.cost @ z) for m, z in pairs)
    if risk <= fleet.scenario.risk_bound and cost < best.cost:
        best.controls, best.cost, best.sets, best.spent = controls, cost, found.sets, spent
        fleet.known = fleet.parted(found.sets, points)
    return risk


def _next_price(tried: list[tuple[float, float]], budget: float) -> float:
    """Return the price at which the budget is expected to be just used.

    Risk falls with its price about in proportion; between two prices on both sides of the budget,
    along a straight line in logarithms.
    """
    price, risk = tried[-1]
    if 0.0 <= 1.0 - risk / budget <= _CLOSE:
        return price
    budget *= 1.0 - 0.5 * _CLOSE
    above = [(p, r) for p, r in tried if r > budget]
    below = [(p, r) for p, r in tried if 0.0 < r <= budget]
    if above and below:
        (p1, r1), (p2, r2) = max(above), min(below)
        if p1 < p2 and r1 > r2:
            share = np.log(r1 / budget) / np.log(r1 / r2)
            # A jump of the risk between them draws all prices to one side: keep off the ends.
            return float(p1 * (p2 / p1) ** np.clip(share, 0.15, 0.85))
    return float(price * np.clip((max(risk, 1e-12) / budget) ** _STEEPNESS, 0.2, 5.0))


def _without_plan(fleet: Fleet, best: _Best, risk_of: RiskOf) -> Draft:
    """Say why there is no plan; the search for the reason may find one after all."""
    if fleet.limits.reached:
        return Draft(Status.LIMIT, (), (), (), (), {}, _ENDED)
    answer = why_not(fleet.scenario, fleet.limits)
    if answer.controls and risk_of(answer.controls) <= fleet.scenario.risk_bound:
        best.controls, best.sets = answer.controls, answer.sets
        best.cost = sum(
            vehicle.cost_weight * float(np.abs(controls).sum())
            for vehicle, controls in zip(fleet.scenario.vehicles, answer.controls, strict=True)
        )
    status = Status.INFEASIBLE if answer.is_proven else Status.LIMIT
    sets = (tuple(range(fleet.scenario.num_vehicles)),) if answer.is_proven else ()
    return Draft(status, (), sets, (), (), {}, answer.explanation or _ENDED)
