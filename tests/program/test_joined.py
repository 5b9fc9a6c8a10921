"""Many things to keep out of, laid side by side."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from radmpc.experiments.families import paper
from radmpc.model.obstacle import Obstacle
from radmpc.program import joined
from radmpc.program.build import build_program, condensed_models

TRIANGLE = np.array([[0.0, 0.0], [3.0, 0.0], [0.0, 2.0]])
HEXAGON = 2.0 * np.array([[1, 0], [0.5, 0.8], [-0.5, 0.8], [-1, 0], [-0.5, -0.8], [0.5, -0.8]])


@pytest.mark.parametrize("avoidance", ["steps", "intervals"])
def test_things_side_by_side_give_the_rows_that_they_give_one_by_one(avoidance, monkeypatch):
    scenario = paper(2, 3)
    middle = np.mean([v.start[list(v.system.position)] for v in scenario.vehicles], axis=0)
    beside = scenario.vehicles[0].start[list(scenario.vehicles[0].system.position)]
    # Contact by its faces, so that the direction over its corner joins them.
    tight = beside + scenario.vehicles[0].radius
    shapes = [
        Obstacle.polygon("triangle", TRIANGLE + middle),
        Obstacle.moving(
            "moving", [HEXAGON + middle + [k, -k] for k in range(scenario.horizon + 1)]
        ),
        Obstacle.polygon("hexagon", HEXAGON + middle + 5.0),
        Obstacle.box("corner", tight, tight + 2.0),
    ]
    scenario = replace(scenario, avoidance=avoidance, obstacles=tuple(shapes))
    models = condensed_models(scenario)
    at_once = build_program(scenario, models, risk_bound=scenario.risk_bound)
    monkeypatch.setattr(joined, "_AT_ONCE", 1)
    one_by_one = build_program(scenario, models, risk_bound=scenario.risk_bound)
    assert {item.other for item in at_once.avoidances} >= {"triangle", "moving", "hexagon"}
    alternatives = np.diff(at_once.avoidance_starts)
    of_corner = [item.other == "corner" for item in at_once.avoidances]
    assert alternatives[of_corner].max() > 4
    assert at_once.avoidances == one_by_one.avoidances
    assert at_once.risk_items == one_by_one.risk_items
    assert at_once.initial == one_by_one.initial
    assert at_once.num_presolved == one_by_one.num_presolved
    assert at_once.initial_risk == pytest.approx(one_by_one.initial_risk, abs=1e-15)
    for name in ("alternative_starts", "avoidance_starts"):
        np.testing.assert_array_equal(getattr(at_once, name), getattr(one_by_one, name))
    for name in ("offsets", "deviations", "events", "risk_items"):
        np.testing.assert_array_equal(getattr(at_once.rows, name), getattr(one_by_one.rows, name))
    difference = abs(at_once.rows.normals - one_by_one.rows.normals)
    assert difference.max() == 0.0
