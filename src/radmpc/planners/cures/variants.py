"""What may be changed of a scenario to cure it: the candidates, the mildest of a kind first."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from radmpc.errors import ScenarioError
from radmpc.model.dynamics import lqr_gain
from radmpc.model.obstacle import MovingShape, Obstacle, TrackShape
from radmpc.model.scenario import Scenario
from radmpc.model.vehicle import Vehicle
from radmpc.ranges import FILE_STEPS

__all__ = [
    "LIMIT_FACTORS",
    "MOST_RISK",
    "WEIGHTS",
    "helps_sentence",
    "longer_horizons",
    "longer_text",
    "regulated",
    "softened",
    "vehicle_with_noise",
    "with_horizon",
    "with_noise",
]

LIMIT_FACTORS = (1.1, 1.2, 1.5, 2.0, 3.0, 5.0, 10.0, 20.0, 50.0, 100.0)
"""What limits are multiplied by, one after the other [-]."""

WEIGHTS = (1.0, 10.0, 100.0, 1e3, 1e4, 1e5)
"""Weights R of the control that are tried for feedback, with Q = 1 [-]: a softer gain each."""

MOST_RISK = 0.25
"""Δ above which plans are of no use [-]."""

_LONGER = (1.25, 1.6, 2.2)
"""Multiples of the horizon that are tried [-]."""


def longer_horizons(scenario: Scenario) -> tuple[int, ...]:
    """Return horizons that may be tried, the shortest first.

    Parameters
    ----------
    scenario : Scenario
        With the present one.

    Returns
    -------
    tuple of int
        Empty where outlines are given step by step, for this horizon alone, and where files hold no
        longer one.
    """
    if any(isinstance(obstacle.shape, MovingShape) for obstacle in scenario.obstacles):
        return ()
    horizon = scenario.horizon
    longer = (max(horizon + 1, round(factor * horizon)) for factor in _LONGER)
    return tuple(sorted({min(each, FILE_STEPS) for each in longer if horizon < FILE_STEPS}))


def with_horizon(scenario: Scenario, horizon: int) -> Scenario | None:
    """Return a scenario with another horizon; None where a state grows too far by then.

    Parameters
    ----------
    scenario : Scenario
        The scenario; windows that end with its horizon end with the other one, too.
    horizon : int
        Steps.
    """
    vehicles = (_until(vehicle, scenario.horizon, horizon) for vehicle in scenario.vehicles)
    try:
        return replace(scenario, horizon=horizon, vehicles=tuple(vehicles))
    except ScenarioError:
        return None


def _until(vehicle: Vehicle, last: int, horizon: int) -> Vehicle:
    """Return a vehicle whose windows end at a horizon where they ended at the last one."""
    if not _has_window_until(vehicle, last):
        return vehicle

    def moved(window: tuple[int, int] | None) -> tuple[int, int] | None:
        return (window[0], horizon) if window is not None and window[1] == last else window

    goal = replace(vehicle.goal, within=moved(vehicle.goal.within))
    via = tuple(replace(visit, between=moved(visit.between)) for visit in vehicle.via)
    return replace(vehicle, goal=goal, via=via)


def _has_window_until(vehicle: Vehicle, last: int) -> bool:
    """Whether any of its windows ends at a step."""
    windows = [vehicle.goal.within, *(visit.between for visit in vehicle.via)]
    return any(window is not None and window[1] == last for window in windows)


def longer_text(scenario: Scenario, horizon: int) -> str:
    """Return the advice to lengthen the horizon, and windows that end with it.

    Parameters
    ----------
    scenario : Scenario
        With the present one.
    horizon : int
        Steps.
    """
    with_it = any(_has_window_until(vehicle, scenario.horizon) for vehicle in scenario.vehicles)
    windows = ", and windows that end with it" if with_it else ""
    return f"lengthen the horizon to {horizon} steps ({horizon * scenario.dt:g} s){windows}"


def regulated(vehicle: Vehicle, weight: float) -> Vehicle | None:
    """Return a vehicle under a linear-quadratic regulator with Q = 1.

    Parameters
    ----------
    vehicle : Vehicle
        The vehicle.
    weight : float
        R of its control [-].

    Returns
    -------
    Vehicle or None
        None where there is no such regulator.
    """
    system = vehicle.system
    try:
        gain = lqr_gain(system, np.eye(system.num_states), weight * np.eye(system.num_controls))
        return replace(vehicle, gain=gain)
    except ScenarioError:
        return None


def softened(vehicle: Vehicle, weight: float, horizon: int) -> Vehicle | None:
    """Return a vehicle under a regulator with Q = 1 that is softer than what it has.

    Parameters
    ----------
    vehicle : Vehicle
        The vehicle.
    weight : float
        R of its control [-].
    horizon : int
        Number of steps T.

    Returns
    -------
    Vehicle or None
        None where that is no softer, or takes all control.
    """
    candidate = regulated(vehicle, weight)
    if candidate is None:
        return None
    left = candidate.control_bounds(candidate.covariances(horizon)).min()
    if left < 0.0:
        return None
    if vehicle.gain is None:
        return candidate
    before = vehicle.control_bounds(vehicle.covariances(horizon)).min()
    return candidate if left > before + 1e-9 else None


def vehicle_with_noise(vehicle: Vehicle, factor: float) -> Vehicle:
    """Return a vehicle with all its variances multiplied: its own, shared, and measured ones.

    Parameters
    ----------
    vehicle : Vehicle
        The vehicle.
    factor : float
        Of variances, above 0 [-].
    """
    measurement = vehicle.measurement
    if measurement is not None:
        measurement = replace(measurement, covariance=factor * measurement.covariance)
    return replace(
        vehicle,
        initial_covariance=factor * vehicle.initial_covariance,
        disturbance_covariance=factor * vehicle.disturbance_covariance,
        measurement=measurement,
        shared=tuple(replace(one, covariance=factor * one.covariance) for one in vehicle.shared),
    )


def with_noise(scenario: Scenario, factor: float) -> Scenario:
    """Return a scenario with all variances multiplied, those of obstacles' tracks included.

    Parameters
    ----------
    scenario : Scenario
        The scenario.
    factor : float
        Of variances, above 0 [-].
    """
    vehicles = tuple(vehicle_with_noise(vehicle, factor) for vehicle in scenario.vehicles)
    obstacles = tuple(_known_better(obstacle, factor) for obstacle in scenario.obstacles)
    return replace(scenario, vehicles=vehicles, obstacles=obstacles)


def _known_better(obstacle: Obstacle, factor: float) -> Obstacle:
    """Return an obstacle whose track is known as much better."""
    if not isinstance(obstacle.shape, TrackShape) or obstacle.spread is None:
        return obstacle
    shape = replace(
        obstacle.shape,
        covariance=factor * obstacle.shape.covariance,
        disturbance_covariance=factor * obstacle.shape.disturbance_covariance,
    )
    # Without a step it is laid out anew.
    return replace(obstacle, shape=shape, dt=None)


def helps_sentence(cures: Sequence[str]) -> str:
    """Return what was tried and does, in a sentence; empty where nothing did.

    Parameters
    ----------
    cures : sequence of str
        Each in the imperative, without a full stop.
    """
    return f"What helps, as tried: {'; or '.join(cures)}." if cures else ""
