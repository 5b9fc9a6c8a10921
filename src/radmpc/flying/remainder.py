"""The steps that are left of a mission as a scenario of their own."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TypeVar

import numpy as np

from radmpc.arrays import Vector, field_names, frozen
from radmpc.flying.knowing import best_of, known_after
from radmpc.model.noise.belief import Belief
from radmpc.model.obstacle import MovingShape, Obstacle, TrackShape
from radmpc.model.scenario import Scenario
from radmpc.model.vehicle import Vehicle
from radmpc.referee.conditional.scales import Scale

__all__ = ["changed", "later", "left_of", "surrounded"]

Record = TypeVar("Record")


def left_of(
    scenario: Scenario,
    passed: int,
    states: Sequence[Vector],
    risk_bound: float,
    scale: Scale | None = None,
) -> Scenario:
    """Return the scenario of the steps that are left, from measured states.

    Parameters
    ----------
    scenario : Scenario
        Of all steps.
    passed : int
        Steps that have been flown, below its horizon.
    states : sequence of (n,) or (2 n + s,) array
        What is known: measured states, known without error, or see `radmpc.flying.knowing`.
    risk_bound : float
        What the rest may risk [-].
    scale : Scale or None
        What is known by now of the factor up to which its covariances are; None is what was.

    Returns
    -------
    Scenario
        With the goals that vehicles have: the plan that is flown has decided the assignment.
        Moving obstacles are where they are by then, or may be: nothing of their places has been
        measured. Visits and windows of arrival are those of all steps: see
        `radmpc.flying.visiting`.
    """
    known = known_after(scenario, passed, states)
    triples = zip(scenario.vehicles, states, known, strict=True)
    vehicles = tuple(_begun(*each) for each in triples)
    left = changed(
        scenario,
        horizon=scenario.horizon - passed,
        risk_bound=risk_bound,
        vehicles=vehicles,
        obstacles=tuple(later(o, passed) for o in scenario.obstacles),
        goals=(),
    )
    return left if scale is None or scale.samples is None else _scaled(left, scale)


def surrounded(left: Scenario, scenario: Scenario, passed: int, times: float) -> Scenario:
    """Return the steps that are left with another scenario's goals and surroundings.

    Parameters
    ----------
    left : Scenario
        With what is known of vehicles.
    scenario : Scenario
        Of the same fleet, with what else there is.
    passed : int
        Steps since it began.
    times : float
        What covariances have been multiplied by since then [-].
    """
    pairs = zip(scenario.vehicles, left.vehicles, strict=True)
    obstacles = (_scaled_obstacle(later(o, passed), times) for o in scenario.obstacles)
    return changed(
        scenario,
        horizon=left.horizon,
        risk_bound=left.risk_bound,
        covariance_samples=left.covariance_samples,
        vehicles=tuple(_known_as(vehicle, other) for vehicle, other in pairs),
        obstacles=tuple(obstacles),
        goals=(),
    )


def _known_as(vehicle: Vehicle, other: Vehicle) -> Vehicle:
    """Return a vehicle of which the same is known as of another, with the same noise."""
    return changed(
        vehicle,
        start=other.start,
        initial_covariance=other.initial_covariance,
        disturbance_covariance=other.disturbance_covariance,
        measurement=other.measurement,
        belief=other.belief,
        shared=other.shared,
    )


def _begun(vehicle: Vehicle, state: Vector, known: Belief | None) -> Vehicle:
    """Return a vehicle that begins with what is known of it after some steps."""
    if known is None:
        return changed(vehicle, start=state, initial_covariance=0.0 * vehicle.initial_covariance)
    n, best = vehicle.start.size, best_of(vehicle, state)
    unknown = known.covariance[:n, :n].copy()
    if known.common is not None:
        unknown += known.common[:n] @ known.common[:n].T
    return changed(vehicle, start=best[:n].copy(), initial_covariance=unknown, belief=known)


def _scaled(scenario: Scenario, scale: Scale) -> Scenario:
    """Return a scenario with what is known by now of its covariances."""
    times = float(scale.factor)
    return changed(
        scenario,
        covariance_samples=scale.samples,
        vehicles=tuple(_scaled_vehicle(vehicle, times) for vehicle in scenario.vehicles),
        obstacles=tuple(_scaled_obstacle(obstacle, times) for obstacle in scenario.obstacles),
    )


def _scaled_vehicle(vehicle: Vehicle, times: float) -> Vehicle:
    """Return a vehicle with all of its covariances multiplied."""
    sensor, belief = vehicle.measurement, vehicle.belief
    if sensor is not None:
        sensor = changed(sensor, covariance=times * sensor.covariance)
    if belief is not None:
        common = None if belief.common is None else np.sqrt(times) * belief.common
        belief = changed(belief, covariance=times * belief.covariance, common=common)
    return changed(
        vehicle,
        initial_covariance=times * vehicle.initial_covariance,
        disturbance_covariance=times * vehicle.disturbance_covariance,
        measurement=sensor,
        belief=belief,
        shared=tuple(changed(part, covariance=times * part.covariance) for part in vehicle.shared),
    )


def _scaled_obstacle(obstacle: Obstacle, times: float) -> Obstacle:
    """Return an obstacle with the covariances of its track multiplied."""
    shape, spread = obstacle.shape, obstacle.spread
    if not isinstance(shape, TrackShape) or spread is None:
        return obstacle
    moves = times * shape.disturbance_covariance
    return changed(
        obstacle,
        shape=changed(shape, covariance=times * shape.covariance, disturbance_covariance=moves),
        spread=changed(spread, positions=times * spread.positions, crossed=times * spread.crossed),
    )


def changed(value: Record, **fields: object) -> Record:
    """Return a copy of a frozen value with other fields, unchecked.

    What is measured was checked, and checking all of a scenario takes longer than a linear program.
    Fields that stay are frozen already.

    Parameters
    ----------
    value : Record
        A scenario or a part of one.
    **fields
        What differs, of the right kind; arrays are frozen.
    """
    kind = type(value)
    made = object.__new__(kind)
    for name in field_names(kind):
        if name in fields:
            for entry in _parts(fields[name]):
                if isinstance(entry, np.ndarray):
                    frozen(entry)
        object.__setattr__(made, name, fields[name] if name in fields else getattr(value, name))
    return made


def _parts(field: object) -> tuple[object, ...]:
    """Return what may be an array: a field, or the entries of one."""
    return field if isinstance(field, tuple) else (field,)


def later(obstacle: Obstacle, passed: int) -> Obstacle:
    """Return an obstacle as it is some steps later.

    Parameters
    ----------
    obstacle : Obstacle
        At rest, or with an outline per step.
    passed : int
        The steps.
    """
    if isinstance(obstacle.shape, TrackShape) and obstacle.dt is not None:
        track = obstacle.shape.later(passed, obstacle.dt)
        # The outlines stay those of the plan that is flown, to the last digit.
        left = len(obstacle.steps) - 1 - passed
        spread = None if obstacle.spread is None else obstacle.spread.since(passed, left)
        return replace(obstacle, shape=track, steps=obstacle.steps[passed:], spread=spread)
    if not isinstance(obstacle.shape, MovingShape):
        return obstacle
    shape = MovingShape(obstacle.shape.outlines[passed:])
    return replace(obstacle, shape=shape, steps=obstacle.steps[passed:])
