"""Two who stay in range of each other while one makes a detour."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from radmpc.flying.leg import leg_of
from radmpc.model.dynamics import double_integrator, lqr_gain
from radmpc.model.obstacle import Obstacle
from radmpc.model.plan import Plan
from radmpc.model.relations.keep import Keep
from radmpc.model.scenario import Scenario
from radmpc.model.vehicle import Goal, Vehicle

WITHIN = 4.2
NAMES = ("lead", "wing")


def escorted(
    avoidance: str = "steps", horizon: int = 6, noise: float = 1.5e-3, **more: object
) -> Scenario:
    """Return two side by side; a rock pushes the second away from the first."""
    system = double_integrator(1.0, 2)
    fleet = [
        Vehicle(
            name=name, system=system, start=[0.0, y], goal=Goal.at([1.5 * horizon, y], 0.5),
            radius=0.3, control_limit=4.0, initial_covariance=noise, disturbance_covariance=noise,
            gain=lqr_gain(system, 0.1 * np.eye(4), np.eye(2)), **more,
        )
        for name, y in zip(NAMES, (0.0, 3.4), strict=True)
    ]  # fmt: skip
    rock = Obstacle.box("rock", [3.8, 1.4], [5.2, 3.6])
    keep = [Keep(NAMES, WITHIN)]
    return Scenario("escort", 1.0, horizon, 0.05, fleet, [rock], avoidance=avoidance, keep=keep)


def within(scenario: Scenario, reach: float) -> Scenario:
    return replace(scenario, keep=(Keep(NAMES, reach),))


def abreast(avoidance: str, reach: float, risk_bound: float = 0.49) -> Plan:
    """Return a plan of two who fly abreast through empty space."""
    scenario = replace(escorted(avoidance, noise=4e-3), obstacles=(), risk_bound=risk_bound)
    push = np.zeros((scenario.horizon, 2))
    push[0, 0], push[-1, 0] = 1.8, -1.8
    return leg_of(within(scenario, reach), [push, push], 0).plan
