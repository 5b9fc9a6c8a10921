"""A vehicle without inertia beside a wall, and a planner that stakes all on the next step."""

from __future__ import annotations

import numpy as np
from scipy.special import ndtri

from radmpc.flying.leg import leg_of
from radmpc.model.dynamics import LinearSystem
from radmpc.model.obstacle import Obstacle
from radmpc.model.plan import Plan
from radmpc.model.scenario import Scenario
from radmpc.model.vehicle import Goal, Vehicle

SIGMA = 0.05
AWAY = 5.0
STEPS = 10


def beside_a_wall(risk_bound: float = 0.05) -> Scenario:
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
    wall = Obstacle.box("wall", [-1e3, -50.0], [1e3, 0.0])
    return Scenario("wall", 1.0, STEPS, risk_bound, (vehicle,), (wall,), avoidance="steps")


def staking(scenario: Scenario, seconds: float | None = None) -> Plan:
    """Return a plan that runs all its risk in its first step; of less effort at every tick."""
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
