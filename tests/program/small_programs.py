"""Programs of a few vehicles."""

from __future__ import annotations

import numpy as np

from radmpc.model.dynamics import double_integrator
from radmpc.model.scenario import Scenario
from radmpc.model.vehicle import Goal, Vehicle
from radmpc.program.build import build_program, condensed_models


def mover(name="a", start=(0.0, 0.0), goal=(8.0, 0.0), **more):
    d = len(start)
    options = {
        "radius": 0.5,
        "control_limit": np.full(d, 2.0),
        "speed_limit": np.full(d, 3.0),
        "initial_covariance": 0.01,
        "disturbance_covariance": 0.01,
    }
    return Vehicle(
        name=name,
        system=double_integrator(1.0, d),
        start=np.concatenate([start, np.zeros(d)]),
        goal=Goal(np.array(goal) - 0.1, np.array(goal) + 0.1, np.full(d, 0.05)),
        **(options | more),
    )


def scene_of(*vehicles, **more):
    return Scenario(
        name="s", dt=1.0, horizon=more.pop("horizon", 8), risk_bound=0.05, vehicles=vehicles, **more
    )


def built(scenario):
    return build_program(scenario, condensed_models(scenario), risk_bound=scenario.risk_bound)
