from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from visiting import scene

from radmpc import Goal, Scenario, ScenarioError, Visit, certify, plan
from radmpc.io.native.mapping import from_dict, to_dict
from radmpc.model.plan import Plan

FIRST, LAST = 3, 8


def arriving(within: tuple[int, int] | None, time_weight: float, *via: Visit) -> Scenario:
    given = scene(*via, horizon=LAST)
    (one,) = given.vehicles
    one = replace(one, goal=replace(one.goal, within=within))
    return replace(given, vehicles=(one,), time_weight=time_weight)


def arrival_of(planned: Plan) -> int | None:
    means = planned.trajectories[0].means
    return planned.scenario.vehicles[0].goal.arrival(means[:, :2], means[:, 2:])


@pytest.mark.parametrize("time_weight", [0.0, 0.5, 3.0, 100.0])
def test_no_step_of_arrival_is_cheaper_at_fixed_margins(time_weight: float) -> None:
    found = plan(arriving((FIRST, LAST), time_weight), "dlp")
    each = [plan(arriving((k, k), time_weight), "dlp").cost for k in range(FIRST, LAST + 1)]
    costs = [cost for cost in each if cost is not None]
    assert len(costs) == 6
    assert found.cost == pytest.approx(min(costs), rel=1e-3)
    assert found.plan is not None
    assert arrival_of(found.plan) == FIRST + int(np.argmin(costs))
    assert certify(found.plan).problems == ()


def test_time_that_is_dear_means_the_earliest_arrival_and_free_time_the_least_effort() -> None:
    hurried = plan(arriving((1, LAST), 1000.0), "certified(0)").plan
    idle = plan(arriving((1, LAST), 0.0), "dlp").plan
    due = plan(arriving(None, 0.0), "dlp").plan
    assert hurried is not None
    assert idle is not None
    assert due is not None
    assert arrival_of(hurried) == FIRST
    assert plan(arriving((1, FIRST - 1), 0.0), "dlp").plan is None
    assert idle.cost == pytest.approx(due.cost, rel=1e-3)


@pytest.mark.nightly
def test_certified_weighs_time_against_effort_on_the_way_through_a_box() -> None:
    box = Visit.at([2.0, 2.0], 0.5)
    found = plan(arriving((FIRST, LAST), 3.0, box))
    assert found.is_certified
    assert found.plan is not None
    assert certify(found.plan).problems == ()
    each = [plan(arriving((k, k), 3.0, box), "certified(0)") for k in (4, 5)]
    least = min(one.cost for one in each if one.cost is not None)
    assert found.cost is not None
    assert found.certified_lower_bound is not None
    assert found.cost <= least * (1.0 + 2e-3)
    assert found.certified_lower_bound <= least * (1.0 + 1e-9)


def test_a_second_costs_what_is_asked_whatever_the_step() -> None:
    given = arriving((LAST, LAST), 2.0)
    still = plan(given, "dlp").plan
    free = plan(replace(given, time_weight=0.0), "dlp").plan
    assert still is not None
    assert free is not None
    assert still.cost == pytest.approx(free.cost + 2.0 * LAST * given.dt)


def test_the_referee_tells_who_does_not_stay_and_what_time_costs() -> None:
    found = plan(arriving((FIRST, LAST), 0.5), "dlp").plan
    assert found is not None
    made = arrival_of(found)
    assert made is not None

    def judged(**changes: object) -> tuple[str, ...]:
        return certify(replace(found, scenario=replace(found.scenario, **changes))).problems

    assert judged() == ()
    (one,) = found.scenario.vehicles
    late = replace(one, goal=replace(one.goal, within=(1, made - 1)))
    problems = judged(vehicles=(late,))
    assert any(f"is not in its goal from step {made - 1} on: at step" in p for p in problems)
    (cost,) = judged(time_weight=1.5)
    assert cost == (
        f"plan: states a cost of {found.cost:.9g}, its controls cost {found.cost + made:.9g}"
    )


@pytest.mark.parametrize("name", ["dmpc", "radmpc", "multi-vehicle", "rmpc-rrt"])
def test_planners_due_at_the_horizon_refuse_windows_of_arrival(name: str) -> None:
    with pytest.raises(ScenarioError, match=r"^vehicles\[0\]\.goal\.within: the planner"):
        plan(arriving((FIRST, LAST), 0.0), name)


def test_windows_of_arrival_and_prices_of_time_are_checked() -> None:
    for within, told in (
        ((3, 9), "vehicles[0].goal.within: must end at the horizon of 8 steps at the latest"),
        ((0, 3), "within: must be two steps, 1 <= first <= last, got [0, 3]"),
        ((3,), "within: must be two steps, the first and the last"),
    ):
        with pytest.raises(ScenarioError) as refusal:
            arriving(within, 0.0)
        assert told in str(refusal.value)
    with pytest.raises(ScenarioError, match="time_weight: must be >= 0, got -1"):
        arriving((3, 8), -1.0)
    content = to_dict(arriving((3, 8), 2.0))
    assert content["objective"] == {"effort": 1, "time": 2.0}
    assert from_dict(content).time_weight == 2.0
    assert from_dict(content).vehicles[0].goal.within == (3, 8)
    for objective, told in (
        ({"time": -1.0}, "objective.time: must be >= 0, got -1"),
        ({"effort": 2, "time": 1.0}, "objective.effort: must be 1, time is priced against it"),
    ):
        with pytest.raises(ScenarioError) as refusal:
            from_dict({**content, "objective": objective})
        assert told in str(refusal.value)


def test_a_goal_finds_where_a_path_comes_to_stay() -> None:
    goal = Goal.at([5.0, 0.0], 1.0, 0.5, within=[2, 6])
    along = np.array([0.0, 4.5, 7.0, 5.5, 5.0, 5.0, 5.0])
    path = np.stack([along, np.zeros(7)], axis=1)
    speeds = np.zeros((7, 2))
    assert goal.arrival(path, speeds) == 3
    speeds[4] = 1.0
    assert goal.arrival(path, speeds) == 5
    assert goal.arrival(path, None) == 3
    assert replace(goal, within=(1, 2)).arrival(path, speeds) is None
    assert replace(goal, within=None).arrival(path, speeds) == 6
