"""Noise that is next to nothing, and effort that counts for nothing."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from radmpc.experiments.families import circle
from radmpc.io.native.scenario_file import load_scenario
from radmpc.model.plan import Status
from radmpc.planning import plan

SCENES = Path(__file__).parents[1] / "data" / "scenes"


@pytest.mark.slow
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


@pytest.mark.slow
def test_a_vehicle_whose_effort_counts_for_nothing_is_hurried_all_the_same():
    result = plan(load_scenario(SCENES / "effort-for-nothing.json"), time_limit=3.0)
    assert result.status is not Status.OPTIMAL
    assert result.explanation is not None
