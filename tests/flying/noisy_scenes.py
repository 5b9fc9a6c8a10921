"""Scenes beside a wall whose noise is not all new, known or told exactly."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from adversary import AWAY, SIGMA

from radmpc.model.dynamics import LinearSystem
from radmpc.model.noise.measurement import Measurement
from radmpc.model.noise.shared import SharedDisturbance
from radmpc.model.obstacle import Obstacle
from radmpc.model.scenario import Scenario
from radmpc.model.vehicle import Goal, Vehicle

BOUND, STEPS = 0.05, 3
SENSOR = Measurement(np.eye(2), 16.0 * SIGMA**2)
WALL = Obstacle.box("wall", [-1e3, -50.0], [1e3, 0.0])


def beside(wall: Obstacle = WALL, **noise: object) -> Scenario:
    """A vehicle without inertia beside a wall."""
    eye = np.eye(2)
    vehicle = Vehicle(
        name="v",
        system=LinearSystem(eye, eye, (0, 1), None),
        start=[0.0, AWAY],
        goal=Goal.at([0.0, 0.0], 1e3, None),
        radius=0.1,
        control_limit=1e3,
        initial_covariance=9.0 * SIGMA**2 if noise else 0.0,
        disturbance_covariance=SIGMA**2,
        **noise,
    )
    return Scenario("wall", 1.0, STEPS, BOUND, (vehicle,), (wall,), avoidance="steps")


def steered(scene: Callable[[], Scenario], steps: int = 5) -> Scenario:
    """Return a scene of more steps near the wall, all steered, its bound one that waiting keeps."""
    scenario = scene()
    gain = np.array([[-0.6, 0.1], [0.0, -0.5]])
    vehicles = tuple(replace(v, gain=gain) for v in scenario.vehicles)
    vehicles = (replace(vehicles[0], start=[0.0, 0.6]), *vehicles[1:])
    return replace(scenario, vehicles=vehicles, horizon=steps, risk_bound=0.49)


def estimated() -> Scenario:
    return beside(measurement=SENSOR)


def gusty() -> Scenario:
    return beside(disturbance_correlation=0.9)


def gusty_and_estimated() -> Scenario:
    return beside(disturbance_correlation=0.9, measurement=SENSOR)


def beside_a_berg() -> Scenario:
    outline = [[-1e3, -50.0], [1e3, -50.0], [1e3, 0.0], [-1e3, 0.0]]
    spread = np.array([0.0, 4.0, 0.0, 0.5]) * SIGMA**2
    return beside(Obstacle.tracked("berg", outline, [0.0, 0.0, 0.0, 0.0], spread))


def blown(**noise: object) -> Scenario:
    """In a wind that lasts, which shakes more than what is new."""
    wind = SharedDisturbance("wind", np.eye(2), 3.0 * SIGMA**2, 0.9)
    return beside(shared=(wind,), **noise)


def blown_and_gusty() -> Scenario:
    return blown(disturbance_correlation=0.6)


def blown_as_another_sees() -> Scenario:
    """In a wind that only somebody far away can tell from noise."""
    scenario = blown()
    [vehicle] = scenario.vehicles
    blind = replace(vehicle, disturbance_covariance=4.0 * SIGMA**2)
    seeing = replace(
        vehicle, name="w", start=[500.0, 500.0], disturbance_covariance=1e-4 * SIGMA**2
    )
    goal = Goal.at([500.0, 500.0], 1e3, None)
    return replace(scenario, vehicles=(blind, replace(seeing, goal=goal)))


def blown_and_estimated() -> Scenario:
    return blown(measurement=SENSOR)


def estimated_as_another_sees() -> Scenario:
    """Three that one wind blows, of which two estimate where they are."""
    scenario = blown_as_another_sees()
    blind, seeing = scenario.vehicles
    third = replace(seeing, name="x", start=[900.0, 900.0], disturbance_correlation=0.5)
    third = replace(third, goal=Goal.at([900.0, 900.0], 1e3, None), measurement=SENSOR)
    return replace(scenario, vehicles=(replace(blind, measurement=SENSOR), seeing, third))


def estimated_in_a_new_wind_and_unsure() -> Scenario:
    scenario = estimated_as_another_sees()
    vehicles = tuple(
        replace(v, shared=(replace(v.shared[0], correlation=0.0),)) for v in scenario.vehicles
    )
    return replace(scenario, vehicles=vehicles, covariance_samples=6)


def blown_and_unsure() -> Scenario:
    return replace(blown_as_another_sees(), covariance_samples=6)


def unsure() -> Scenario:
    return replace(beside(), covariance_samples=6)


def estimated_and_unsure_beside_a_berg() -> Scenario:
    [berg] = beside_a_berg().obstacles
    return replace(beside(berg, measurement=SENSOR), covariance_samples=4)


SCENES = [
    estimated,
    gusty,
    gusty_and_estimated,
    beside_a_berg,
    blown,
    blown_and_gusty,
    blown_as_another_sees,
    blown_and_unsure,
    blown_and_estimated,
    estimated_as_another_sees,
    estimated_in_a_new_wind_and_unsure,
    unsure,
    estimated_and_unsure_beside_a_berg,
]
