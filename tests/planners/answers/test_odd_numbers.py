"""Noise that is next to nothing, and vehicles that stay."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from radmpc.experiments.families import circle, paper
from radmpc.model.scenario import Avoidance
from radmpc.model.vehicle import Goal
from radmpc.planners.certified.turned.half_spaces import Hazards
from radmpc.planners.certified.turned.paths import timed_anyhow
from radmpc.planning import plan
from radmpc.program.build import condensed_models


@pytest.mark.slow
@pytest.mark.sampled(3)
@pytest.mark.parametrize("planner", ["certified", "distance"])
@pytest.mark.parametrize("variance", [1e-104, 1e-40, 1e-20])
def test_noise_that_is_next_to_nothing_is_planned_with(planner: str, variance: float):
    scenario = circle(2)
    vehicles = tuple(
        replace(v, initial_covariance=0.0, disturbance_covariance=variance)
        for v in scenario.vehicles
    )
    result = plan(replace(scenario, vehicles=vehicles), planner)
    assert result.is_certified
    assert result.cost == pytest.approx(7.1666667, rel=1e-5)


def test_a_vehicle_that_cannot_but_stay_has_its_times_all_the_same():
    scenario = circle(2)
    first, second = scenario.vehicles
    place = first.start_position
    staying = replace(first, goal=Goal.at(place))
    scenario = replace(scenario, horizon=1, vehicles=(staying, second))
    hazards = Hazards.of(scenario, condensed_models(scenario))
    assert hazards.reaches[0] == 0.0
    path = timed_anyhow(hazards, 0, np.array([place, place]), np.random.default_rng(0))
    np.testing.assert_array_equal(path, [place, place])


@pytest.mark.parametrize("avoidance", ["steps", "intervals"])
def test_where_effort_is_free_any_plan_costs_nothing(avoidance: Avoidance):
    scenario = paper(2, 0)
    vehicles = tuple(replace(v, cost_weight=0.0) for v in scenario.vehicles)
    result = plan(replace(scenario, vehicles=vehicles, avoidance=avoidance), "certified")
    assert result.is_certified
    assert result.cost == 0.0
