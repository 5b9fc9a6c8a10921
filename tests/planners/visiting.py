"""One vehicle past a box, with visits."""

from __future__ import annotations

import numpy as np

from radmpc import Goal, Obstacle, Scenario, Vehicle, Visit
from radmpc.model.dynamics import double_integrator, lqr_gain

SYSTEM = double_integrator(1.0, 2)
GAIN = lqr_gain(SYSTEM, np.eye(4), np.eye(2))


def vehicle(name: str, start: list[float], goal: list[float], *via: Visit) -> Vehicle:
    return Vehicle(
        name=name,
        system=SYSTEM,
        start=start,
        goal=Goal.at(goal, 0.5),
        radius=0.3,
        control_limit=6.0,
        initial_covariance=1e-3,
        disturbance_covariance=1e-3,
        gain=GAIN,
        via=via,
    )


def scene(*via: Visit, horizon: int = 6, others: tuple[Vehicle, ...] = ()) -> Scenario:
    """Return one vehicle and a box in its way, and perhaps others."""
    one = vehicle("a", [0.0, 0.0], [9.0, 0.0], *via)
    block = Obstacle.box("block", [4.0, -0.3], [4.6, 1.0])
    return Scenario("visits", 1.0, horizon, 0.01, (one, *others), (block,))
