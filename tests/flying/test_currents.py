"""Missions in the world as it is measured: currents are flown."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

import radmpc
from radmpc.experiments.families import paper
from radmpc.flying.mission import Mission
from radmpc.flying.model import Model
from radmpc.model.scenario import Scenario
from radmpc.preflight.pace import Pace


def with_each(scenario: Scenario, **values: object) -> Scenario:
    """Return the scenario with every vehicle changed."""
    vehicles = tuple(replace(v, **values) for v in scenario.vehicles)
    return replace(scenario, vehicles=vehicles)


def test_a_mission_in_a_current_stays_near_its_plan() -> None:
    current = np.array([0.02, -0.01, 0.0, 0.0])
    plan = radmpc.plan(with_each(paper(2, 1), drift=current)).require()
    still = with_each(
        plan.scenario, initial_covariance=np.zeros((4, 4)), disturbance_covariance=np.zeros((4, 4))
    )
    mission, model = Mission(plan, planner=None), Model(still, 0)
    states, _ = model.reset()
    for step in range(plan.scenario.horizon):
        for trajectory, state in zip(plan.trajectories, states, strict=True):
            np.testing.assert_allclose(state, trajectory.means[step], atol=1e-9)
        states, contacts = model.advance(mission.step(states).segments)
        assert not contacts
    for trajectory, state in zip(plan.trajectories, states, strict=True):
        np.testing.assert_allclose(state, trajectory.means[-1], atol=1e-9)


def test_the_closed_form_of_a_pace_leaves_currents_to_others() -> None:
    vehicle = paper(1, 0).vehicles[0]
    assert Pace.of(vehicle) is not None
    assert Pace.of(replace(vehicle, drift=np.array([0.1, 0.0, 0.0, 0.0]))) is None
