"""Plans for vehicles in one wind."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import radmpc
from radmpc.errors import ScenarioError
from radmpc.model.dynamics import double_integrator
from radmpc.model.noise.shared import SharedDisturbance
from radmpc.model.scenario import Scenario
from radmpc.model.vehicle import Goal, Vehicle

GUST = np.vstack([0.5 * np.eye(2), np.eye(2)])


def passing(*sources: tuple[str, np.ndarray] | None, **more: object) -> Scenario:
    """Two that swap places, in the winds that each meets."""
    system = double_integrator(1.0, 2)
    noise = np.diag([2e-3, 2e-3, 5e-4, 5e-4])
    ends = [([0.0, 0.0], [6.0, 0.5]), ([6.0, 0.2], [0.0, 0.1])]
    vehicles = [
        Vehicle(
            name,
            system,
            start,
            Goal(np.array(goal) - 0.3, np.array(goal) + 0.3, np.zeros(2)),
            0.4,
            1.0,
            noise,
            noise,
            shared=() if source is None else (SharedDisturbance(*source, 0.01),),
        )
        for name, (start, goal), source in zip("ab", ends, sources, strict=True)
    ]
    return Scenario("passing", 1.0, 6, 0.05, vehicles, **more)  # type: ignore[arg-type]


def test_a_gust_that_both_feel_costs_nothing_and_one_for_each_does():
    found = {
        name: radmpc.plan(scenario, "ira", rng=0).require()
        for name, scenario in {
            "still air": passing(None, None),
            "one gust": passing(("wind", GUST), ("wind", GUST)),
            "two gusts": passing(("west", GUST), ("east", GUST)),
        }.items()
    }
    cost = {name: plan.cost for name, plan in found.items()}
    assert cost["one gust"] == pytest.approx(cost["still air"], rel=2e-3)
    assert cost["two gusts"] > 1.1 * cost["one gust"]
    assert all(plan.risk.certified <= 0.05 for plan in found.values())


@pytest.mark.slow
@pytest.mark.parametrize("avoidance", ["steps", "intervals"])
def test_no_plan_is_cheaper_than_what_is_proven_in_opposite_gusts(avoidance):
    scenario = passing(("wind", GUST), ("wind", -GUST), avoidance=avoidance)
    result = radmpc.plan(scenario, "certified", rng=0, time_limit=30.0)
    plan = result.require()
    assert result.is_certified
    assert plan.certified_lower_bound is not None
    assert plan.certified_lower_bound <= plan.cost * (1.0 + 1e-9)
    ira = radmpc.plan(scenario, "ira", rng=0).require()
    assert plan.cost <= ira.cost * (1.0 + 2e-3)


@pytest.mark.parametrize("planner", ["radmpc", "multi-vehicle", "dmpc", "rmpc-rrt"])
def test_planners_of_one_vehicle_at_a_time_refuse_shared_gusts_in_one_line(planner):
    scenario = passing(("wind", GUST), ("wind", GUST))
    with pytest.raises(ScenarioError, match="take certified, ira or distance") as caught:
        radmpc.plan(scenario, planner, rng=0)
    assert "\n" not in str(caught.value)


def test_a_mission_refuses_shared_gusts_in_one_line():
    plan = radmpc.plan(passing(("wind", GUST), ("wind", GUST)), "ira", rng=0).require()
    with pytest.raises(ScenarioError, match="cannot be flown under way") as caught:
        radmpc.Mission(plan)
    assert caught.value.path == ("vehicles", 0, "shared")


def test_a_fleet_in_one_gust_is_planned_in_sets():
    scenario = passing(("wind", GUST), ("wind", GUST))
    away = np.array([0.0, 30.0])
    far = tuple(
        replace(
            v,
            name=v.name.upper(),
            start=v.start + np.append(away, [0.0, 0.0]),
            goal=Goal(v.goal.lower + away, v.goal.upper + away, v.goal.speed),
        )
        for v in scenario.vehicles
    )
    fleet = replace(scenario, vehicles=(*scenario.vehicles, *far))
    result = radmpc.plan(fleet, "certified", rng=0)
    assert result.is_certified
    assert len(result.require().sets) == 2
