"""Who stakes everything on the next step: a vehicle without inertia beside a wall.

It finds out a wrong rule that planners who mean well do not.
"""

from __future__ import annotations

import numpy as np
from scipy.special import ndtri

from radmpc.flying.leg import leg_of
from radmpc.model.dynamics import LinearSystem
from radmpc.model.obstacle import Obstacle
from radmpc.model.plan import Plan
from radmpc.model.scenario import Scenario
from radmpc.model.vehicle import Goal, Vehicle

__all__ = ["staking", "waiting", "wall"]

SIGMA = 0.05
"""Standard deviation of the noise of a step [m]."""

AWAY = 5.0
"""Distance from the wall at which nothing is risked [m]."""

STEPS = 10


def wall(risk_bound: float = 0.1) -> Scenario:
    """Return a vehicle without inertia, and a wall that it need not come near."""
    eye = np.eye(2)
    vehicle = Vehicle(
        name="v",
        system=LinearSystem(eye, eye, (0, 1), None),
        start=[0.0, AWAY],
        goal=Goal.at([0.0, 0.0], 1e3, None),
        radius=0.1,
        control_limit=1e3,
        initial_covariance=0.0,
        disturbance_covariance=SIGMA**2,
    )
    block = Obstacle.box("wall", [-1e3, -50.0], [1e3, 0.0])
    return Scenario("wall", 1.0, STEPS, risk_bound, (vehicle,), (block,), avoidance="steps")


def staking(scenario: Scenario, seconds: float | None = None) -> Plan:
    """Return a plan that runs all of its risk in its first step, and looks better than the last."""
    del seconds
    horizon = scenario.horizon
    x, y = scenario.vehicles[0].start
    clearance = scenario.vehicles[0].radius - SIGMA * ndtri(scenario.risk_bound * (1.0 - 1e-6))
    path = np.full((horizon, 2), [x, AWAY])
    path[0] = [x, clearance]
    # What is left of a plan must look worse than the next one: its last step wastes effort.
    path[-1, 0] += 3.0 * (horizon - 1)
    controls = np.diff(np.vstack([[x, y], path]), axis=0)
    return leg_of(scenario, [controls], 0).plan


def waiting(scenario: Scenario) -> Plan:
    """Return a plan that stays where it is and wastes effort in its last step."""
    controls = np.zeros((scenario.horizon, 2))
    controls[-1, 0] = 1e2
    return leg_of(scenario, [controls], 0).plan
