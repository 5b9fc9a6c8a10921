"""Vehicles beside a wall under feedback: what the path between steps does, planned and flown."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from physical import fly
from referee_scenes import make_plan
from scipy.stats import binomtest

from radmpc.model.dynamics import double_integrator, lqr_gain
from radmpc.model.obstacle import Obstacle
from radmpc.model.scenario import Scenario
from radmpc.model.vehicle import Goal, Vehicle
from radmpc.planning import plan
from radmpc.referee import certify, simulate

BOUND = 0.01
MISSIONS = 20_000
SYSTEM = double_integrator(1.0, 2)

# Gain, and the room at which hovering beside the wall runs 0.0094 at the steps alone [m].
FEEDBACKS = {
    "dead-beat": (np.array([[-1.0, 0.0, -1.5, 0.0], [0.0, -1.0, 0.0, -1.5]]), 0.0784155),
    "soft": (np.array([[-0.3, 0.0, -0.9, 0.0], [0.0, -0.3, 0.0, -0.9]]), 0.2681123),
    "quick": (lqr_gain(SYSTEM, np.eye(4), 0.1 * np.eye(2)), 0.1244774),
    "slow": (lqr_gain(SYSTEM, np.eye(4), np.eye(2)), 0.1980307),
}


def beside_a_wall(name: str) -> Scenario:
    """A vehicle whose velocity is disturbed by 0.1 m/s a step, and that may move away."""
    gain, room = FEEDBACKS[name]
    vehicle = Vehicle(
        name="a",
        system=SYSTEM,
        start=np.zeros(4),
        goal=Goal(np.array([-1.0, 0.0]), np.zeros(2), None),
        radius=0.3,
        control_limit=np.full(2, 5.0),
        initial_covariance=np.zeros((4, 4)),
        disturbance_covariance=np.diag([0.0, 0.0, 0.01, 0.01]),
        gain=gain,
    )
    wall = Obstacle.box("wall", [0.3 + room, -50.0], [2.0, 50.0])
    return Scenario("hover", 1.0, 12, BOUND, (vehicle,), (wall,))


@pytest.mark.slow
@pytest.mark.sampled(2)
@pytest.mark.parametrize("name", FEEDBACKS)
def test_hovering_that_is_safe_at_the_steps_is_charged_for_what_happens_between(name):
    scenario = beside_a_wall(name)
    hovering = make_plan(scenario, [np.zeros((12, 2))])
    at_steps = replace(hovering, scenario=replace(scenario, avoidance="steps"))
    assert certify(at_steps).certified == pytest.approx(0.0094, rel=1e-4)
    flown = fly(hovering, MISSIONS, seed=1)
    low = binomtest(flown.collisions, MISSIONS).proportion_ci(1 - 2e-4, "exact").low
    assert flown.saturated == 0
    assert certify(hovering).certified >= low
    # Stiff feedback throws the vehicle about between the steps, more than ten times Δ.
    expected = {"dead-beat": 0.102, "soft": 0.0093, "quick": 0.0262, "slow": 0.0126}[name]
    assert binomtest(flown.collisions, MISSIONS, expected).pvalue > 1e-5
    simulated = simulate(hovering, MISSIONS, rng=2)
    assert binomtest(simulated.collisions, MISSIONS, expected).pvalue > 1e-5


@pytest.mark.slow
@pytest.mark.sampled(1)
@pytest.mark.parametrize("name", FEEDBACKS)
def test_a_plan_beside_a_wall_is_flown_within_its_bound(name):
    result = plan(beside_a_wall(name), rng=0)
    assert result.is_certified, result.explanation
    planned = result.require()
    for flown in (fly(planned, MISSIONS, seed=1), simulate(planned, MISSIONS, rng=2)):
        assert binomtest(flown.collisions, MISSIONS, BOUND, alternative="greater").pvalue > 1e-4
