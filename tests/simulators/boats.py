"""A small sea for tests."""

from __future__ import annotations

import numpy as np

from radmpc.arrays import Vector
from radmpc.flying.tick import Segment, segments
from radmpc.model.dynamics import double_integrator, lqr_gain
from radmpc.model.goal import Goal
from radmpc.model.obstacle import Obstacle
from radmpc.model.scenario import Avoidance, Scenario
from radmpc.model.vehicle import Vehicle


def sea(
    *,
    deviation: float = 0.05,
    avoidance: Avoidance = "intervals",
    horizon: int = 12,
    dimension: int = 2,
    dt: float = 2.0,
    radius: float = 1.2,
    obstacles: tuple[Obstacle, ...] = (),
) -> Scenario:
    """Return two vehicles that meet head-on; the deviation is that of a step's velocity [m/s]."""
    system = double_integrator(dt, dimension)
    ones = np.ones(dimension)
    gain = lqr_gain(system, np.diag(np.r_[ones, 4.0 * ones]), 60.0 * np.eye(dimension))
    noise = deviation**2 * np.r_[4.0 * ones, ones]
    third = [0.0] * (dimension - 2)
    vehicles = [
        Vehicle(
            name=name,
            system=system,
            radius=radius,
            start=[begin, 0.0, *third],
            goal=Goal.at([end, side, *third], 2.0),
            control_limit=0.3,
            speed_limit=1.5,
            initial_covariance=np.r_[0.01 * ones, 0.0004 * ones],
            disturbance_covariance=noise,
            gain=gain,
        )
        for name, begin, end, side in (("east", 0.0, 14.0, 1.0), ("west", 14.0, 0.0, -1.0))
    ]
    return Scenario("sea", dt, horizon, 0.1, vehicles, obstacles, avoidance)


def asked(scenario: Scenario, states: tuple[Vector, ...], control: list[float]) -> list[Segment]:
    """Return segments of one control for all."""
    return list(segments(scenario, states, [np.array(control)] * scenario.num_vehicles))
