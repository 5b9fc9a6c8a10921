"""Two that cross each other on diagonals, where limits of norms say less than those of axes."""

from __future__ import annotations

import numpy as np

from radmpc.model.dynamics import double_integrator, lqr_gain
from radmpc.model.noise.measurement import Measurement
from radmpc.model.scenario import Scenario
from radmpc.model.vehicle import Goal, Vehicle

CONTROL, SPEED = 1.9, 2.3


def crossing(avoidance: str = "steps", horizon: int = 6, **more: object) -> Scenario:
    """Return two who need most of what the norms of their controls and speeds leave."""
    d = 2
    system = double_integrator(1.0, d)
    noise = [4e-4] * d + [1e-4] * d
    fleet = [
        Vehicle(
            name=name, system=system, start=start, goal=Goal.at(goal, 0.3, 0.3), radius=0.4,
            control_limit=1.7, control_norm=CONTROL, speed_limit=2.2, speed_norm=SPEED,
            initial_covariance=noise, disturbance_covariance=noise,
            gain=lqr_gain(system, 0.1 * np.eye(4), np.eye(2)), **more,
        )
        for name, start, goal in (
            ("a", [0.0, 0.0], [8.0, 8.0]), ("b", [8.8, -0.4], [0.8, 7.6]),
        )
    ]  # fmt: skip
    return Scenario("norms", 1.0, horizon, 0.05, fleet, avoidance=avoidance)


def sensed(avoidance: str = "steps") -> Scenario:
    """Return the same who measure where they are."""
    return crossing(avoidance, measurement=Measurement(np.eye(4), 1e-4))
