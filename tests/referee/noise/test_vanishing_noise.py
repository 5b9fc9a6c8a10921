"""Noise that feedback takes away altogether leaves rounding, on either side of zero."""

from __future__ import annotations

import numpy as np
from referee_scenes import make_plan

from radmpc import from_dict
from radmpc.referee import certify
from radmpc.referee.propagation import propagate

DT = 1.3

SCENE = {
    "format": "radmpc/scenario/1",
    "name": "deadbeat",
    "dt": DT,
    "horizon": 8,
    "risk_bound": 1e-4,
    "avoidance": "steps",
    "obstacles": [{"name": "wall", "min": [0.7, -0.8], "max": [0.8, 0.8]}],
    "vehicles": [
        {
            "name": "v",
            "start": [0.0, -0.7],
            "goal": {"min": [-9, -9], "max": [9, 9]},
            "radius": 0.4,
            "control_limit": 10.0,
            "initial_covariance": [1.1e-8, 1.1e-8, 1.8e-9, 1.8e-9],
            "disturbance_covariance": 0.0,
            "feedback": {
                "gain": [
                    [-1.0 / DT**2, -0.0, -1.5 / DT, -0.0],
                    [-0.0, -1.0 / DT**2, -0.0, -1.5 / DT],
                ]
            },
            "control_sigmas": 1.0,
        }
    ],
}


def test_variances_below_zero_by_rounding_are_none_and_warn_of_nothing() -> None:
    scenario, controls = from_dict(SCENE), [np.zeros((8, 2))]
    motion = propagate(scenario, controls)
    assert np.trace(motion.position_covariances, axis1=2, axis2=3).min() < 0.0
    assert certify(make_plan(scenario, controls)).certified == 0.0
