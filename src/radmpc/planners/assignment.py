"""Who goes to which of the goals that vehicles share.

What each vehicle needs to each goal in empty space is a lower bound: the assignment of the least
sum is planned first. Others follow while their sum is below the best plan: of a small fleet all, in
the order of their sums; of a larger one, which scipy assigns, swaps of vehicles that were in each
other's way.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from itertools import combinations, permutations

import numpy as np
from scipy.sparse import csr_array

from radmpc.arrays import Matrix
from radmpc.model.limits import outside_norms
from radmpc.model.plan import Status
from radmpc.model.relations.goals import places_of
from radmpc.model.scenario import Scenario
from radmpc.planners.draft import Draft
from radmpc.planners.planner import Planner, Run
from radmpc.planners.verdict import Judge
from radmpc.program.build import condensed_models, cost_of_time
from radmpc.program.limits.hard import hard_rows
from radmpc.records import dataclass, replace
from radmpc.solvers.lp.choosing import bounded_lp
from radmpc.solvers.lp.outcome import LpOutcome
from radmpc.solvers.solution import relative_gap
from radmpc.wording import count_text

__all__ = ["assigned", "least_costs"]

Places = tuple[int, ...]

_ALL = 720
"""Assignments up to which all are looked at in the order of their sums [-]: 6 vehicles, 6 goals."""

_TRIED = 8
"""Assignments that are planned at most [-]."""

_TIME_SHARE = 0.5
"""Share of the time left that each plan may take [-]."""

_SHARE_USED = "the share of the time limit for one assignment was used up"


@dataclass(frozen=True, slots=True, eq=False)
class _Found:
    """A planned assignment: who goes where, what came of it, what it costs."""

    places: Places
    scenario: Scenario
    draft: Draft
    cost: float


def assigned(
    scenario: Scenario, planner: Planner, run: Run, judge_of: Callable[[Scenario], Judge]
) -> tuple[Scenario, Draft]:
    """Plan a fleet whose goals are shared.

    Parameters
    ----------
    scenario : Scenario
        With `goals`.
    planner, run
        As in `Decomposition.plan`.
    judge_of : callable
        Makes the referee's verdict of a scenario.

    Returns
    -------
    Scenario and Draft
        With the goals that were assigned; its lower bounds hold for every assignment.
    """
    costs = least_costs(scenario)
    bests: list[_Found] = []
    tried: dict[Places, Draft] = {}
    for places in _candidates(costs, bests):
        if len(tried) >= _TRIED or (tried and run.limits.reached):
            break
        if bests and _sum(costs, places) >= bests[-1].cost * (1.0 - planner.gap):
            continue
        found = _planned(scenario, places, planner, run, judge_of)
        tried[places] = found.draft
        if not bests or found.cost < bests[-1].cost:
            bests.append(found)
    return bests[-1].scenario, _told(scenario, bests[-1], tried, costs, planner.gap)


def least_costs(scenario: Scenario) -> Matrix:
    """Return what each vehicle needs to each goal in empty space, (N, G); inf out of reach.

    Parameters
    ----------
    scenario : Scenario
        With `goals`.
    """
    found = np.full((scenario.num_vehicles, len(scenario.goals)), np.inf)
    for k, goal in enumerate(scenario.goals):
        # Programs keep to polytopes within norms, and plans are turned beyond these.
        aimed = (replace(vehicle, goal=goal) for vehicle in scenario.vehicles)
        vehicles = tuple(map(outside_norms, aimed))
        there = replace(scenario, vehicles=vehicles, goals=())
        for i, model in enumerate(condensed_models(there)):
            rows, lower, upper = hard_rows(model)
            most = np.tile(model.control_bounds.ravel(), 2)
            if np.any(most < 0.0):
                continue
            lp = bounded_lp(
                np.full(most.size, model.vehicle.cost_weight), np.zeros(most.size), most
            )
            lp.add_rows(csr_array(np.hstack([rows, -rows])), lower, upper)
            outcome, least = lp.solve()
            if outcome is LpOutcome.OPTIMAL:
                found[i, k] = least
    return found


def _sum(costs: Matrix, places: Sequence[int]) -> float:
    """Return what an assignment costs at least."""
    return float(costs[np.arange(len(places)), list(places)].sum())


def _num_assignments(costs: Matrix) -> float:
    """Return how many assignments there are."""
    count, goals = costs.shape
    return float(np.prod(np.arange(goals - count + 1, goals + 1, dtype=np.float64)))


def _candidates(costs: Matrix, bests: Sequence[_Found]) -> Iterator[Places]:
    """Yield assignments, the least sum first; of large fleets swaps of the last of the best."""
    count, goals = costs.shape
    if _num_assignments(costs) <= _ALL:
        yield from sorted(permutations(range(goals), count), key=lambda p: (_sum(costs, p), p))
        return
    from scipy.optimize import linear_sum_assignment  # noqa: PLC0415 - few share goals

    # What is out of reach counts more than all else together.
    reachable = np.where(np.isfinite(costs), costs, 0.0)
    much = 1.0 + count * float(reachable.max(initial=0.0))
    _, columns = linear_sum_assignment(np.where(np.isfinite(costs), costs, much))
    yield tuple(columns.tolist())
    seen = {tuple(columns.tolist())}
    while bests:
        fresh = [p for p in _swapped(bests[-1]) if p not in seen]
        if not fresh:
            return
        chosen = min(fresh, key=lambda p: (_sum(costs, p), p))
        seen.add(chosen)
        yield chosen


def _swapped(found: _Found) -> Iterator[Places]:
    """Yield assignments in which two that were planned together have swapped their goals."""
    for members in found.draft.sets:
        for i, j in combinations(members, 2):
            places = list(found.places)
            places[i], places[j] = places[j], places[i]
            yield tuple(places)


def _planned(
    scenario: Scenario,
    places: Places,
    planner: Planner,
    run: Run,
    judge_of: Callable[[Scenario], Judge],
) -> _Found:
    """Plan an assignment."""
    pairs = zip(scenario.vehicles, places, strict=True)
    vehicles = tuple(replace(vehicle, goal=scenario.goals[k]) for vehicle, k in pairs)
    there = replace(scenario, vehicles=vehicles)
    limits = run.limits
    if limits.seconds_left < float("inf"):
        limits = limits.within(_TIME_SHARE * limits.seconds_left)
    one = replace(run, limits=limits, judge=judge_of(there))
    draft = planner.decomposition.plan(there, planner, one)
    is_late = draft.stopped_by is not None and draft.stopped_by == limits.within(0.0).reason
    if is_late and not run.limits.reached:
        # The limit that was asked for is not reached, and nobody is to read that it was.
        draft = replace(draft, stopped_by=_SHARE_USED)
    cost = float("inf")
    if draft.controls:
        cost = sum(
            model.vehicle.cost_weight * float(np.abs(each).sum()) + cost_of_time(model, each)
            for model, each in zip(condensed_models(there), draft.controls, strict=True)
        )
    return _Found(places, there, draft, cost)


def _told(
    scenario: Scenario, best: _Found, tried: dict[Places, Draft], costs: Matrix, gap: float
) -> Draft:
    """Return the best draft, with bounds that hold for every assignment, and who goes where."""
    draft = best.draft
    others = _least_untried(costs, tried)
    bounds = []
    for name in ("lower_bound", "certified_lower_bound"):
        floors = [others]
        for places, one in tried.items():
            known = getattr(one, name)
            is_ruled_out = one.status is Status.INFEASIBLE
            floors.append(np.inf if is_ruled_out else max(known or 0.0, _sum(costs, places)))
        has_any = getattr(draft, name) is not None
        bounds.append(min(*floors, best.cost) if has_any and best.cost < np.inf else None)
    status = draft.status
    if status is Status.OPTIMAL:
        proven = max(bound or 0.0 for bound in bounds)
        status = status if relative_gap(best.cost, proven) <= gap * 1.001 else Status.FEASIBLE
    if status is Status.INFEASIBLE and others < np.inf:
        status = Status.LIMIT
    text = _text(scenario, best, len(tried), costs)
    told = text if draft.explanation is None else f"{text} {draft.explanation}"
    return replace(
        draft,
        status=status,
        lower_bound=bounds[0],
        certified_lower_bound=bounds[1],
        explanation=told,
    )


def _text(scenario: Scenario, best: _Found, count: int, costs: Matrix) -> str:
    """Return who goes where, and what that is worth, in a sentence."""
    given = places_of(scenario.goals, [vehicle.goal for vehicle in scenario.vehicles])
    planned = count_text(count, "assignment")
    if best.places == given:
        return f"Goals stay as given, the best of {planned} planned."
    names = [vehicle.name for vehicle in scenario.vehicles]
    who = ", ".join(f"{n} to {k + 1}" for n, k in zip(names, best.places, strict=True))
    worth = ""
    taken = [k for k in given if k is not None]
    if len(taken) == len(names) and best.cost < np.inf:
        least = _sum(costs, taken)
        if least == np.inf:
            worth = "; as given, not all are within reach"
        elif least > best.cost:
            worth = f"; as given, any plan costs {least:.4g} at least, this one {best.cost:.4g}"
    return f"Goals were assigned: {who} ({planned} planned){worth}."


def _least_untried(costs: Matrix, tried: dict[Places, Draft]) -> float:
    """Return what any assignment that was not planned costs at least."""
    count, goals = costs.shape
    if _num_assignments(costs) <= _ALL:
        sums = [_sum(costs, p) for p in permutations(range(goals), count) if p not in tried]
        return min(sums, default=float("inf"))
    return _sum(costs, next(iter(tried)))
