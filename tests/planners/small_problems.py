"""Vehicles and scenarios that are planned in a moment."""

from __future__ import annotations

import numpy as np

from radmpc.model.dynamics import double_integrator
from radmpc.model.scenario import Scenario
from radmpc.model.vehicle import Goal, Vehicle


def mover(name, start, goal, **more):
    options = {"radius": 0.4, "control_limit": np.full(2, 2.0), "speed_limit": np.full(2, 3.0)}
    return Vehicle(
        name=name,
        system=double_integrator(1.0, 2),
        start=np.concatenate([start, np.zeros(2)]),
        goal=Goal(np.array(goal) - 0.1, np.array(goal) + 0.1, np.full(2, 0.05)),
        **({"initial_covariance": 1e-3, "disturbance_covariance": 1e-3} | options | more),
    )


def scene_of(*vehicles, **more):
    options = {"dt": 1.0, "horizon": 8, "risk_bound": 0.05, "avoidance": "steps"}
    return Scenario(name="s", vehicles=vehicles, **(options | more))
