"""Scenes in other units of length and time, and plans carried over to them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from radmpc.model.dynamics import double_integrator
from radmpc.model.obstacle import Obstacle
from radmpc.model.plan import Plan
from radmpc.model.scenario import Scenario, Workspace
from radmpc.model.vehicle import Vehicle
from radmpc.model.visits import Visit


def in_units(scenario: Scenario, length: float, time: float) -> Scenario:
    """The same scene of double integrators and boxes, in units that make numbers so many times as
    large; costs are the same numbers."""
    dt = time * scenario.dt
    return replace(
        scenario,
        dt=dt,
        vehicles=tuple(_vehicle(v, dt, length, time) for v in scenario.vehicles),
        obstacles=tuple(
            Obstacle.box(o.name, length * o.shape.lower, length * o.shape.upper)
            for o in scenario.obstacles
        ),
        workspace=None
        if scenario.workspace is None
        else Workspace(length * scenario.workspace.lower, length * scenario.workspace.upper),
        time_weight=scenario.time_weight / time,
    )


def state_factors(dimension: int, length: float, time: float) -> np.ndarray:
    """What positions and velocities are multiplied by."""
    return np.repeat([length, length / time], dimension)


def _vehicle(vehicle: Vehicle, dt: float, length: float, time: float) -> Vehicle:
    states = state_factors(vehicle.system.dimension, length, time)
    speed, push = length / time, length / time**2
    goal = vehicle.goal
    return replace(
        vehicle,
        system=double_integrator(dt, vehicle.system.dimension),
        start=states * vehicle.start,
        goal=replace(
            goal,
            lower=length * goal.lower,
            upper=length * goal.upper,
            speed=None if goal.speed is None else speed * goal.speed,
        ),
        radius=length * vehicle.radius,
        control_limit=push * vehicle.control_limit,
        initial_covariance=np.outer(states, states) * vehicle.initial_covariance,
        disturbance_covariance=np.outer(states, states) * vehicle.disturbance_covariance,
        speed_limit=None if vehicle.speed_limit is None else speed * vehicle.speed_limit,
        gain=None if vehicle.gain is None else push * vehicle.gain / states,
        cost_weight=vehicle.cost_weight / push,
        via=tuple(
            Visit(
                length * v.lower,
                length * v.upper,
                speed=None if v.speed is None else speed * v.speed,
                between=v.between,
            )
            for v in vehicle.via
        ),
        control_norm=None if vehicle.control_norm is None else push * vehicle.control_norm,
        speed_norm=None if vehicle.speed_norm is None else speed * vehicle.speed_norm,
    )


def plan_in_units(plan: Plan, length: float, time: float) -> Plan:
    """The same plan in such units."""
    dimension = plan.scenario.dimension
    states, push = state_factors(dimension, length, time), length / time**2
    return replace(
        plan,
        scenario=in_units(plan.scenario, length, time),
        trajectories=tuple(
            replace(
                t,
                controls=push * t.controls,
                means=states * t.means,
                covariances=np.outer(states, states) * t.covariances,
                gain=None if t.gain is None else push * t.gain / states,
            )
            for t in plan.trajectories
        ),
    )
