"""Assignment of vehicles to the goals that they share.

What each vehicle needs to each goal in empty space is a lower bound: the assignment of the least
sum is planned first. Others follow while their sum is below the best plan: of a small fleet all, in
the order of their sums; of a larger one, which scipy assigns, swaps of vehicles that were in each
other's way.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from itertools import combinations, permutations
from math import inf, perm

import numpy as np

from radmpc.arrays import Matrix
from radmpc.model.limits import outside_norms
from radmpc.model.plan import Status
from radmpc.model.relations.goals import places_of
from radmpc.model.scenario import Scenario
from radmpc.planners.draft import Draft
from radmpc.planners.least_effort import least_effort
from radmpc.planners.outcome.best_of_all import BestOfAll
from radmpc.planners.outcome.record import Certifying
from radmpc.planners.planner import Improved, Planner, Run
from radmpc.program.build import condensed_models, cost_of_time
from radmpc.records import dataclass, replace
from radmpc.solvers.solution import Limits, relative_gap
from radmpc.wording import count_text

__all__ = ["assigned", "least_costs"]

GoalIndices = tuple[int, ...]
"""An assignment: of every vehicle, the index of its goal among those that are shared."""

Asked = Callable[[Scenario], tuple[Certifying, Improved]]
"""Returns the referee of a scenario, and who is given its better plans."""

_ALL = 720
"""Assignments up to which all are looked at in the order of their sums [-]: 6 vehicles, 6 goals."""

_TRIED = 8
"""Assignments that are planned at most [-]."""

_TIME_SHARE = 0.5
"""Share of the time left that each plan may take [-]."""

_SHARE_USED = "the share of the time limit for one assignment was used up"


@dataclass(frozen=True, slots=True, eq=False)
class _Planned:
    """A planned assignment: who goes where, what came of it, what it costs, and costs at least.

    The last two bound plans by faces, as a draft's `lower_bound`, and any certified plan.
    """

    goals: GoalIndices
    scenario: Scenario
    draft: Draft
    cost: float
    by_faces: float
    on_any: float


def assigned(
    scenario: Scenario, planner: Planner, run: Run, asked_of: Asked
) -> tuple[Scenario, Draft]:
    """Plan a fleet whose goals are shared.

    Parameters
    ----------
    scenario : Scenario
        With `goals`.
    planner, run
        As in `Decomposition.plan`; of an assignment that costs more than another nobody is told.
    asked_of : callable
        Returns the referee of a scenario with goals assigned, and who is given its better plans.

    Returns
    -------
    Scenario and Draft
        With the goals that were assigned; its lower bounds hold for every assignment.
    """
    costs = least_costs(scenario)
    bests: list[_Planned] = []
    tried: dict[GoalIndices, _Planned] = {}
    telling = BestOfAll(run.found)
    for goals in _candidates(costs, bests):
        if len(tried) >= _TRIED or (tried and run.limits.reached):
            break
        least = _sum(costs, goals)
        if bests and least >= bests[-1].cost * (1.0 - planner.gap):
            continue
        others = _least_by_faces(costs, (*tried, goals), tried)
        told = replace(run, found=telling.while_planning(least, others))
        one = _planned(scenario, goals, least, planner, told, asked_of)
        tried[goals] = one
        if not bests or one.cost < bests[-1].cost:
            bests.append(one)
        telling.settle(_least_by_faces(costs, tuple(tried), tried))
    best = bests[-1]
    if best.cost == inf:
        # One that only ran out of time leaves open whether there is a plan.
        best = next((one for one in tried.values() if one.draft.status is Status.LIMIT), best)
    return best.scenario, _answer(scenario, best, tried, costs, planner.gap)


def least_costs(scenario: Scenario) -> Matrix:
    """Return what each vehicle needs to each goal in empty space, (N, G); inf out of reach.

    Parameters
    ----------
    scenario : Scenario
        With `goals`.
    """
    found = np.zeros((scenario.num_vehicles, len(scenario.goals)))
    for k, goal in enumerate(scenario.goals):
        # Programs keep to polytopes within norms, and plans are turned beyond these.
        aimed = (replace(vehicle, goal=goal) for vehicle in scenario.vehicles)
        there = replace(scenario, vehicles=tuple(map(outside_norms, aimed)), goals=())
        for i, model in enumerate(condensed_models(there)):
            effort = least_effort(model)
            found[i, k] = inf if effort.is_out_of_reach else effort.cost
    return found


def _sum(costs: Matrix, goals: Sequence[int]) -> float:
    """Return what an assignment costs at least."""
    return float(costs[np.arange(len(goals)), list(goals)].sum())


def _are_few(costs: Matrix) -> bool:
    """Whether all assignments are looked at."""
    count, num_goals = costs.shape
    return perm(num_goals, count) <= _ALL


def _candidates(costs: Matrix, bests: Sequence[_Planned]) -> Iterator[GoalIndices]:
    """Yield assignments, the least sum first; of large fleets swaps of the last of the best."""
    count, num_goals = costs.shape
    if _are_few(costs):
        yield from sorted(permutations(range(num_goals), count), key=lambda p: (_sum(costs, p), p))
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


def _swapped(planned: _Planned) -> Iterator[GoalIndices]:
    """Yield assignments in which two that were planned together have swapped their goals."""
    for members in planned.draft.sets:
        for i, j in combinations(members, 2):
            goals = list(planned.goals)
            goals[i], goals[j] = goals[j], goals[i]
            yield tuple(goals)


def _planned(
    scenario: Scenario,
    goals: GoalIndices,
    least: float,
    planner: Planner,
    run: Run,
    asked_of: Asked,
) -> _Planned:
    """Plan an assignment that costs so much at least."""
    pairs = zip(scenario.vehicles, goals, strict=True)
    vehicles = tuple(replace(vehicle, goal=scenario.goals[k]) for vehicle, k in pairs)
    there = replace(scenario, vehicles=vehicles)
    limits = run.limits
    if limits.seconds_left < inf:
        limits = limits.within(_TIME_SHARE * limits.seconds_left)
    referee, improved = asked_of(there)
    one = replace(run, limits=limits, judge=referee.judge, improved=improved)
    draft = planner.decomposition.plan(there, planner, one)
    is_late = draft.stopped_by is not None and draft.stopped_by == limits.within(0.0).reason
    if is_late and not run.limits.reached:
        # The limit that was asked for is not reached, and nobody is to read that it was.
        draft = replace(draft, stopped_by=_SHARE_USED)
    if draft.status is Status.LIMIT and not draft.explanation:
        draft = replace(draft, explanation=_why_none(draft, run.limits, limits))
    cost = inf
    if draft.controls:
        cost = sum(
            model.vehicle.cost_weight * float(np.abs(each).sum()) + cost_of_time(model, each)
            for model, each in zip(condensed_models(there), draft.controls, strict=True)
        )
    is_ruled_out = draft.status is Status.INFEASIBLE
    by_faces = inf if is_ruled_out else max(draft.lower_bound or 0.0, least)
    # What no plan by faces does, another that the referee certifies may do.
    is_ruled_out = is_ruled_out and draft.rules_out_any
    on_any = inf if is_ruled_out else max(draft.certified_lower_bound or 0.0, least)
    return _Planned(goals, there, draft, cost, by_faces, on_any)


def _why_none(draft: Draft, limits: Limits, share: Limits) -> str:
    """Return what ended the search for a plan with some goals, within all limits or its share."""
    ended = draft.stopped_by or limits.reason or (_SHARE_USED if share.reason else "")
    told = f": {ended}" if ended else ""
    return f"No plan was found with these goals, and none was ruled out{told}."


def _answer(
    scenario: Scenario,
    best: _Planned,
    tried: Mapping[GoalIndices, _Planned],
    costs: Matrix,
    gap: float,
) -> Draft:
    """Return the best draft, with bounds that hold for every assignment, and who goes where."""
    draft, every = best.draft, [one.draft for one in tried.values()]
    others = _least_of_others(costs, tuple(tried))
    by_faces = on_any = None
    if best.cost < inf and draft.lower_bound is not None:
        by_faces = min(others, best.cost, *(one.by_faces for one in tried.values()))
    if best.cost < inf and draft.certified_lower_bound is not None:
        on_any = min(others, best.cost, *(one.on_any for one in tried.values()))
    status = draft.status
    if status is Status.OPTIMAL:
        proven = max(by_faces or 0.0, on_any or 0.0)
        status = status if relative_gap(best.cost, proven) <= gap * 1.001 else Status.FEASIBLE
    if status is Status.INFEASIBLE and others < inf:
        status = Status.LIMIT
    text = _text(scenario, best, len(tried), costs)
    stages = dict.fromkeys(stage for one in every for stage in one.seconds)
    return replace(
        draft,
        status=status,
        steps=tuple(step for one in every for step in one.steps),
        events=tuple(event for one in every for event in one.events),
        seconds={name: sum(one.seconds.get(name, 0.0) for one in every) for name in stages},
        lower_bound=by_faces,
        certified_lower_bound=on_any,
        explanation=text if draft.explanation is None else f"{text} {draft.explanation}",
    )


def _text(scenario: Scenario, best: _Planned, count: int, costs: Matrix) -> str:
    """Return who goes where, and what that is worth, in a sentence."""
    given = places_of(scenario.goals, [vehicle.goal for vehicle in scenario.vehicles])
    planned = count_text(count, "assignment")
    if best.goals == given:
        return f"Goals stay as given, the best of {planned} planned."
    names = [vehicle.name for vehicle in scenario.vehicles]
    who = ", ".join(f"{n} to {k + 1}" for n, k in zip(names, best.goals, strict=True))
    worth = ""
    taken = [k for k in given if k is not None]
    if len(taken) == len(names) and best.cost < np.inf:
        least = _sum(costs, taken)
        if least == np.inf:
            worth = "; as given, not all are within reach"
        elif least > best.cost:
            worth = f"; as given, any plan costs {least:.4g} at least, this one {best.cost:.4g}"
    return f"Goals were assigned: {who} ({planned} planned){worth}."


def _least_by_faces(
    costs: Matrix, named: Sequence[GoalIndices], tried: Mapping[GoalIndices, _Planned]
) -> float:
    """Return what plans by faces cost at least of assignments tried, and of those not named."""
    known = (one.by_faces for one in tried.values())
    return min(_least_of_others(costs, named), *known, inf)


def _least_of_others(costs: Matrix, named: Sequence[GoalIndices]) -> float:
    """Return what any assignment costs at least, those named aside; the first has the least sum."""
    count, num_goals = costs.shape
    if _are_few(costs):
        left = set(permutations(range(num_goals), count)).difference(named)
        return min((_sum(costs, p) for p in left), default=inf)
    return _sum(costs, named[0])
