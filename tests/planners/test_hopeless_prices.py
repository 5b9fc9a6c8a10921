"""Prices that go nowhere stay numbers, and placing vehicles stops when told to."""

from __future__ import annotations

import numpy as np

from radmpc.experiments.families import circle
from radmpc.planners.certified.turned.paths import Paths
from radmpc.planners.certified.turned.price_control import PriceControl
from radmpc.planners.certified.turned.prioritized import prioritized_ticks
from radmpc.planners.certified.turned.tuning import TUNING
from radmpc.program.build import condensed_models
from radmpc.program.hazards import Hazards

SCENARIO = circle(4)
HAZARDS = Hazards.of(SCENARIO, condensed_models(SCENARIO))


def test_a_price_that_never_helps_stays_finite() -> None:
    control = PriceControl(2.0, 1e-8, 1e-3)
    paths = Paths(HAZARDS).state()
    for number in range(1000):
        control.follow(0.5, 10.0 - 1e-3 * number, paths)
    assert control.price == 2.0 * TUNING.dearest


def test_placing_vehicles_asks_at_every_tick_whether_to_stop() -> None:
    asked = []

    def is_stopped() -> bool:
        asked.append(True)
        return len(asked) > 5

    placed, ticks = prioritized_ticks(HAZARDS, is_stopped)
    assert not placed
    assert len(asked) <= 8 < ticks * SCENARIO.horizon


def test_vehicles_that_are_placed_keep_clear_of_each_other_at_every_tick() -> None:
    placed, _ = prioritized_ticks(HAZARDS, lambda: False)
    assert len(placed) == 4
    for i in range(4):
        for j in range(i):
            apart = np.linalg.norm(placed[i][1:] - placed[j][1:], axis=1)
            assert apart.min() >= HAZARDS.radii[i] + HAZARDS.radii[j]
