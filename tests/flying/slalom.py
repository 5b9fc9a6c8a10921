"""A vehicle without inertia between blocks on both sides, under dead-beat feedback."""

from __future__ import annotations

import numpy as np

from radmpc.flying.leg import leg_of
from radmpc.model.dynamics import LinearSystem
from radmpc.model.obstacle import Obstacle
from radmpc.model.plan import Plan
from radmpc.model.scenario import Scenario
from radmpc.model.vehicle import Goal, Vehicle

BOUND = 0.1


def slalom(risk_bound: float = BOUND, gates: int = 3) -> Scenario:
    eye = np.eye(2)
    blocks = []
    for number in range(gates):
        x = 1.5 + 2.0 * number
        low, high = (-40.0, 0.25) if number % 2 == 0 else (-0.25, 40.0)
        blocks.append(Obstacle.box(f"g{number}", [x - 0.6, low], [x + 0.6, high]))
    vehicle = Vehicle(
        name="skier",
        system=LinearSystem(eye, eye, (0, 1), None),
        start=[0.0, 0.0],
        goal=Goal.at([1.0 + 2.0 * gates, 0.0], 0.05, None),
        radius=0.2,
        control_limit=1.6,
        initial_covariance=0.0,
        disturbance_covariance=0.12**2,
        gain=-eye,
        control_sigmas=2.0,
    )
    horizon = 2 + 2 * gates
    return Scenario(
        "slalom", 1.0, horizon, risk_bound, (vehicle,), tuple(blocks), avoidance="steps"
    )


CAREFUL = [
    [0.004, 0.0],
    [0.0, 0.734],
    [1.035, 0.0],
    [1.36, -0.067],
    [0.842, -1.36],
    [1.36, 1.36],
    [0.989, 0.067],
    [1.36, -0.684],
]
"""Controls of the cheapest plan that runs 0.06 at most, to a millimeter per step."""


def careful_plan() -> Plan:
    """Return a plan that runs 0.06 of a bound of 0.1."""
    return leg_of(slalom(), [np.array(CAREFUL)], 0).plan
