"""The same scenario in other units."""

from __future__ import annotations

from typing import TypeVar

import numpy as np

from radmpc.arrays import Matrix, Vector
from radmpc.geometry import Polytope
from radmpc.model.dynamics import LinearSystem
from radmpc.model.goal import Goal
from radmpc.model.noise.belief import Belief
from radmpc.model.noise.measurement import Measurement
from radmpc.model.obstacle import (
    BoxShape,
    HalfspaceShape,
    LineShape,
    MovingShape,
    Obstacle,
    PolygonShape,
    Shape,
)
from radmpc.model.obstacle_track import TrackShape, TrackSpread
from radmpc.model.scenario import Scenario
from radmpc.model.vehicle import Vehicle
from radmpc.model.visits import Visit
from radmpc.model.workspace import Workspace
from radmpc.planners.units.choosing import Units
from radmpc.records import replace

__all__ = ["scenario_in_units"]

_Number = TypeVar("_Number", float, Vector)


def scenario_in_units(scenario: Scenario, units: Units) -> Scenario:
    """Return a scenario in other units.

    Parameters
    ----------
    scenario : Scenario
        The fleet.
    units : Units
        What its numbers are multiplied by.

    Raises
    ------
    ScenarioError
        If a number is larger then than scenarios take.
    """
    length, room = units.length, scenario.workspace
    systems: dict[tuple[int, float], LinearSystem] = {}
    return replace(
        scenario,
        dt=units.time * scenario.dt,
        vehicles=tuple(
            _vehicle(vehicle, units, control, systems)
            for vehicle, control in zip(scenario.vehicles, units.controls, strict=True)
        ),
        obstacles=tuple(_obstacle(obstacle, units) for obstacle in scenario.obstacles),
        workspace=None if room is None else Workspace(length * room.lower, length * room.upper),
        time_weight=units.cost * scenario.time_weight / units.time,
        keep=tuple(replace(keep, within=length * keep.within) for keep in scenario.keep),
        goals=tuple(_goal(goal, units) for goal in scenario.goals),
    )


def _vehicle(
    vehicle: Vehicle, units: Units, control: float, systems: dict[tuple[int, float], LinearSystem]
) -> Vehicle:
    """Return a vehicle; those of one system have one system."""
    states, speed = units.states(vehicle), units.length / units.time
    squares, key = np.outer(states, states), (id(vehicle.system), control)
    if key not in systems:
        systems[key] = _system(vehicle.system, states, control)
    sensor, belief = vehicle.measurement, vehicle.belief
    return replace(
        vehicle,
        system=systems[key],
        start=states * vehicle.start,
        goal=_goal(vehicle.goal, units),
        radius=units.length * vehicle.radius,
        control_limit=control * vehicle.control_limit,
        initial_covariance=squares * vehicle.initial_covariance,
        disturbance_covariance=squares * vehicle.disturbance_covariance,
        speed_limit=_times(speed, vehicle.speed_limit),
        gain=None if vehicle.gain is None else control * vehicle.gain / states,
        cost_weight=units.cost * vehicle.cost_weight / control,
        drift=None if vehicle.drift is None else states * vehicle.drift,
        measurement=None if sensor is None else _sensor(sensor, states),
        shared=tuple(replace(s, matrix=states[:, None] * s.matrix) for s in vehicle.shared),
        via=tuple(_visit(visit, units) for visit in vehicle.via),
        control_norm=_times(control, vehicle.control_norm),
        speed_norm=_times(speed, vehicle.speed_norm),
        belief=None if belief is None else _belief(belief, states),
    )


def _system(system: LinearSystem, states: Vector, control: float) -> LinearSystem:
    """Return dynamics."""
    A: Matrix = states[:, None] * system.A / states
    return replace(system, A=A, B=states[:, None] * system.B / control)


def _sensor(sensor: Measurement, states: Vector) -> Measurement:
    """Return a sensor; what it reads stays in its own units."""
    return replace(sensor, matrix=sensor.matrix / states)


def _belief(belief: Belief, states: Vector) -> Belief:
    """Return what is known of a vehicle; what others share stays in its own units."""
    both, common = np.concatenate([states, states]), belief.common
    if common is not None:
        rest = np.ones(len(common) - both.size)
        common = np.concatenate([both, rest])[:, None] * common
    return replace(
        belief,
        disturbance=states * belief.disturbance,
        covariance=np.outer(both, both) * belief.covariance,
        common=common,
    )


def _goal(goal: Goal, units: Units) -> Goal:
    """Return a goal."""
    lower, upper = units.length * goal.lower, units.length * goal.upper
    speed = _times(units.length / units.time, goal.speed)
    return replace(goal, lower=lower, upper=upper, speed=speed)


def _visit(visit: Visit, units: Units) -> Visit:
    """Return a visit."""
    lower, upper = units.length * visit.lower, units.length * visit.upper
    speed = _times(units.length / units.time, visit.speed)
    return replace(visit, lower=lower, upper=upper, speed=speed)


def _obstacle(obstacle: Obstacle, units: Units) -> Obstacle:
    """Return an obstacle, its pieces as they were made."""
    length, spread, dt = units.length, obstacle.spread, obstacle.dt
    if spread is not None:
        area = length**2
        spread = TrackSpread(area * spread.positions, area * spread.crossed)
    return replace(
        obstacle,
        shape=_shape(obstacle.shape, units),
        steps=tuple(tuple(_piece(p, length) for p in pieces) for pieces in obstacle.steps),
        spread=spread,
        dt=None if dt is None else units.time * dt,
    )


def _piece(piece: Polytope, length: float) -> Polytope:
    """Return a convex piece."""
    return replace(piece, offsets=length * piece.offsets, vertices=length * piece.vertices)


def _shape(shape: Shape, units: Units) -> Shape:
    """Return what an obstacle was made from."""
    length = units.length
    if isinstance(shape, PolygonShape):
        return PolygonShape(length * shape.vertices, tuple(length * h for h in shape.holes))
    if isinstance(shape, LineShape):
        return LineShape(length * shape.points)
    if isinstance(shape, BoxShape):
        return BoxShape(length * shape.lower, length * shape.upper)
    if isinstance(shape, HalfspaceShape):
        return HalfspaceShape(shape.normals, length * shape.offsets)
    if isinstance(shape, MovingShape):
        return MovingShape(tuple(length * outline for outline in shape.outlines))
    states = np.repeat([length, length / units.time], shape.dimension)
    squares = np.outer(states, states)
    return TrackShape(
        length * shape.outline,
        states * shape.start,
        squares * shape.covariance,
        squares * shape.disturbance_covariance,
    )


def _times(factor: float, value: _Number | None) -> _Number | None:
    """Return a number times a factor; None stays None."""
    return None if value is None else factor * value
