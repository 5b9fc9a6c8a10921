"""The world as it is measured, put on random scenarios: what may be added, and how it is drawn."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from types import MappingProxyType

import numpy as np

from radmpc.model.noise.measurement import Measurement
from radmpc.model.noise.shared import SharedDisturbance
from radmpc.model.obstacle import Obstacle
from radmpc.model.scenario import Scenario

__all__ = ["FEATURES", "with_noise"]

Feature = Callable[[np.random.Generator, Scenario], Scenario]


def with_noise(rng: np.random.Generator, scenario: Scenario) -> tuple[Scenario, str]:
    """Return a scenario with one or more of the features, and their names.

    Parameters
    ----------
    rng : Generator
        Decides everything.
    scenario : Scenario
        What they are added to.
    """
    names = list(FEATURES)
    chosen = [name for name in names if rng.random() < 0.5] or [str(rng.choice(names))]
    for name in chosen:
        scenario = FEATURES[name](rng, scenario)
    return scenario, "+".join(chosen)


def _current(rng: np.random.Generator, scenario: Scenario) -> Scenario:
    """Let one current carry everybody, and a wind push who has inertia."""
    d, dt = scenario.dimension, scenario.dt
    current, wind = rng.uniform(-0.3, 0.3, d), rng.uniform(-0.05, 0.05, d)
    fleet = []
    for vehicle in scenario.vehicles:
        drift = np.zeros(vehicle.system.num_states)
        drift[list(vehicle.system.position)] = dt * current
        if vehicle.system.velocity is not None:
            drift[list(vehicle.system.velocity)] = dt * wind
        fleet.append(replace(vehicle, drift=drift))
    return replace(scenario, vehicles=tuple(fleet))


def _gusts(rng: np.random.Generator, scenario: Scenario) -> Scenario:
    """Let disturbances last for a few steps, for everybody as long as they do."""
    fleet = tuple(
        replace(vehicle, disturbance_correlation=float(rng.uniform(0.2, 0.9)))
        for vehicle in scenario.vehicles
    )
    return replace(scenario, vehicles=fleet)


def _receivers(rng: np.random.Generator, scenario: Scenario) -> Scenario:
    """Let vehicles steer by receivers of 5 to 30 cm, which tell positions or all states."""
    fleet = []
    for vehicle in scenario.vehicles:
        n = vehicle.system.num_states
        states = range(n) if rng.random() < 0.3 else vehicle.system.position
        variance = float(np.exp(rng.uniform(np.log(0.05), np.log(0.3)))) ** 2
        fleet.append(replace(vehicle, measurement=Measurement.of(list(states), n, variance)))
    return replace(scenario, vehicles=tuple(fleet))


def _freighter(rng: np.random.Generator, scenario: Scenario) -> Scenario:
    """Let something pass by of which place and velocity are known within some decimeters."""
    d, duration = scenario.dimension, scenario.dt * scenario.horizon
    starts = np.array([vehicle.start_position for vehicle in scenario.vehicles])
    goals = np.array([vehicle.goal.center for vehicle in scenario.vehicles])
    # Through the middle of somebody's way at half time, from somewhere.
    i = int(rng.integers(len(starts)))
    meeting = 0.5 * (starts[i] + goals[i]) + rng.normal(0.0, 0.7, d)
    velocity = rng.normal(0.0, 2.0 / duration, d)
    half = rng.uniform(0.3, 0.9, d)
    signs = np.stack(np.meshgrid(*[[-1.0, 1.0]] * d, indexing="ij"), axis=-1).reshape(-1, d)
    deviations = np.concatenate(
        [np.full(d, rng.uniform(0.05, 0.4)), np.full(d, rng.uniform(0.01, 0.08))]
    )
    mixing = np.eye(2 * d)
    if rng.random() < 0.4:
        mixing = rng.standard_normal((2 * d, 2 * d)) / np.sqrt(2 * d)
    jolt = float(rng.uniform(0.0, 0.05))
    track = Obstacle.tracked(
        "freighter",
        signs * half,
        [*(meeting - 0.5 * duration * velocity), *velocity],
        deviations[:, None] * (mixing @ mixing.T) * deviations,
        [*[0.25 * jolt**2] * d, *[jolt**2] * d],
    )
    return replace(scenario, obstacles=(*scenario.obstacles, track))


def _wind(rng: np.random.Generator, scenario: Scenario) -> Scenario:
    """Let one wind blow on all, on each in its way, new at every step or for a while."""
    d, dt = scenario.dimension, scenario.dt
    covariance = float(np.exp(rng.uniform(np.log(0.01), np.log(0.1)))) ** 2 * np.eye(d)
    rho = float(rng.choice([0.0, rng.uniform(0.3, 0.9)]))
    fleet = []
    for vehicle in scenario.vehicles:
        matrix = np.zeros((vehicle.system.num_states, d))
        matrix[list(vehicle.system.position)] = np.eye(d)
        if vehicle.system.velocity is not None:
            matrix[list(vehicle.system.velocity)] = np.eye(d) / dt
        matrix *= rng.uniform(-1.0, 1.0) if rng.random() < 0.3 else rng.uniform(0.5, 1.5)
        part = SharedDisturbance("wind", matrix, covariance, rho)
        fleet.append(replace(vehicle, shared=(part,)))
    return replace(scenario, vehicles=tuple(fleet))


def _unsure(rng: np.random.Generator, scenario: Scenario) -> Scenario:
    """Let all covariances have been estimated from 3 to 300 steps."""
    samples = round(float(np.exp(rng.uniform(np.log(3.0), np.log(300.0)))))
    return replace(scenario, covariance_samples=samples)


FEATURES: Mapping[str, Feature] = MappingProxyType(
    {
        "current": _current,
        "gusts": _gusts,
        "receivers": _receivers,
        "freighter": _freighter,
        "wind": _wind,
        "unsure": _unsure,
    }
)
"""What may be added, by name: each with probability one half."""
