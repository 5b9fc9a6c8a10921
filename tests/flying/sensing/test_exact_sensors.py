"""Sensors that leave nothing open but rounding, which is neither noise nor of any variance."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import radmpc
from radmpc.model.noise.filtering import learning_of
from radmpc.model.noise.fleet import fleet_learning
from radmpc.model.noise.measurement import Measurement
from radmpc.model.noise.shared import SharedDisturbance

STEPS = 4
SUMS = [[0.93, 0.48, 0.69, 1.07], [0.86, -0.68, 1.23, 0.76]]


def craft(name: str = "a", sees: object = SUMS, y: float = 0.0, **more: object) -> radmpc.Vehicle:
    """Return a vehicle whose velocity alone is not known, until a sensor tells it exactly."""
    system = radmpc.double_integrator(1.3, dimension=2)
    values = {"initial_covariance": [0.0, 0.0, 8e-9, 8e-9], "disturbance_covariance": 0.0, **more}
    return radmpc.Vehicle(
        name=name,
        system=system,
        start=[0.3, y],
        goal=radmpc.Goal.at([4.0, y], 0.5),
        radius=0.3,
        control_limit=3.0,
        measurement=Measurement(sees, 0.0),
        **values,
    )


def scene(*fleet: radmpc.Vehicle, **more: object) -> radmpc.Scenario:
    rock = radmpc.Obstacle.box("rock", [1.8, 0.9], [2.2, 1.5])
    return radmpc.Scenario("exact", 1.3, STEPS, 0.01, fleet, [rock], **more)


def blown(**more: object) -> tuple[radmpc.Vehicle, ...]:
    wind = SharedDisturbance("wind", [[0.5], [0.2], [1.0], [0.3]], 1e-6, 0.5)
    fleet = (craft("a", shared=(wind,), **more), craft("b", y=6.0, shared=(wind,), **more))
    return fleet


@pytest.mark.parametrize(
    "scenario",
    [scene(craft()), scene(craft(sees=np.eye(4))), scene(craft(), covariance_samples=6)],
    ids=["sums", "all", "unsure"],
)
def test_what_was_seen_exactly_is_no_noise_and_missions_go_on(scenario: radmpc.Scenario) -> None:
    result = radmpc.plan(scenario, rng=0)
    mission = radmpc.Mission(result, warm=True)
    flight = radmpc.fly(mission, radmpc.Model(result.record.scenario, 3))
    assert not any(tick.alarms for tick in flight.ticks)
    assert not any("failed" in tick.reason for tick in flight.ticks)


def test_nothing_is_left_open_and_nothing_is_learned_anew() -> None:
    learning = learning_of(craft().system, craft().noise, STEPS)
    assert not any(unknown.any() for unknown in learning.unknown)
    assert [each.any() for each in learning.corrections] == [True] + [False] * STEPS


def test_a_sum_that_was_seen_tells_nothing_when_it_is_seen_again() -> None:
    still = radmpc.LinearSystem(np.eye(2), np.eye(2), (0, 1), None)
    vehicle = replace(
        craft(),
        system=still,
        start=[0.0, 0.0],
        goal=radmpc.Goal.at([1.0, 0.0], 0.5, None),
        initial_covariance=[[0.03, 0.01], [0.01, 0.07]],
        disturbance_covariance=0.0,
        measurement=Measurement([[0.37, 0.91]], 0.0),
    )
    learning = learning_of(still, vehicle.noise, STEPS)
    assert [each.any() for each in learning.corrections] == [True] + [False] * STEPS
    assert np.linalg.matrix_rank(learning.unknown[-1], 1e-12) == 1
    assert np.array_equal(learning.unknown[-1], learning.unknown[0])


def test_a_sensor_that_is_only_nearly_exact_still_leaves_something_open() -> None:
    vehicle = replace(craft(), measurement=Measurement(np.eye(4), 1e-18))
    left = learning_of(vehicle.system, vehicle.noise, 0).unknown[0]
    assert np.allclose(np.diag(left)[2:4], 1e-18, rtol=1e-6)


def test_of_one_wind_no_more_is_learned_than_there_is() -> None:
    learning = fleet_learning(blown(disturbance_covariance=0.0), STEPS)
    assert learning is not None
    for unknown in learning.unknown:
        values = np.linalg.eigvalsh(unknown)
        assert values[0] >= -1e-12 * max(values[-1], 0.0)
