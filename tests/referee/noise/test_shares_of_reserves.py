"""Along intervals, what is certified under Student's tails is no more than planners count."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pytest
from referee_scenes import make_plan

from radmpc import from_dict
from radmpc.program.build import build_program, condensed_models, point_of
from radmpc.referee import certify

APPROACH = {
    "format": "radmpc/scenario/1",
    "name": "approach",
    "dt": 2.0,
    "horizon": 1,
    "risk_bound": 0.01,
    "avoidance": "intervals",
    "covariance_samples": 5,
    "vehicles": [
        {
            "name": "v",
            "start": [3.0, 0.0, -1.0, 0.0],
            "goal": {"min": [-100, -100], "max": [100, 100], "speed": None},
            "radius": 0.3,
            "control_limit": 5,
            "initial_covariance": [0.004, 0.001, 0, 0],
            "disturbance_covariance": [0.09, 0.04, 0, 0],
        }
    ],
}
WALL = {"obstacles": [{"name": "wall", "min": [-1, -9], "max": [0, 9]}]}
ROOM = {"workspace": {"min": [-0.3, -200], "max": [200, 200]}}


@pytest.mark.parametrize("scene", [WALL, ROOM], ids=["an obstacle", "the workspace"])
def test_reserves_are_shared_by_the_tail_that_is_charged(scene: Mapping[str, object]) -> None:
    scenario, controls = from_dict({**APPROACH, **scene}), [np.array([[1.5, 0.0]])]
    models = condensed_models(scenario)
    program = build_program(scenario, models, risk_bound=scenario.risk_bound)
    risks = program.tail.probability(program.clearances(point_of(models, controls)))
    counted = 0.0
    for avoidance in range(program.num_avoidances):
        sums = []
        for alternative in program.alternatives_of(avoidance):
            rows = program.rows_of(alternative)
            events = program.rows.events[rows]
            sums.append(sum(risks[rows][events == event].max() for event in np.unique(events)))
        counted += min(sums)
    certified = certify(make_plan(scenario, controls)).certified
    assert 1e-7 < certified <= (1.0 + 1e-9) * (counted + program.initial_risk)
