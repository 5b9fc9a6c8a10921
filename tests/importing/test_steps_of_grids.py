"""How many steps grid worlds get, and how long these are, for as many vehicles as there are."""

from __future__ import annotations

from pathlib import Path

import pytest

from radmpc.importing.formats import import_scenario
from radmpc.model.scenario import Scenario


def imported(folder: Path, count: int, height: int) -> Scenario:
    """Return vehicles that cross a grid world, straight on or around a wall."""
    agents = [f"- {{name: a{i}, start: [0, {2 * i}], goal: [31, {2 * i}]}}\n" for i in range(count)]
    blocked = [[15, y] for y in range(height)]
    text = f"agents:\n{''.join(agents)}map:\n  dimensions: [32, 50]\n  obstacles: {blocked}\n"
    path = folder / "problem.yaml"
    path.write_text(text, encoding="utf-8")
    return import_scenario(path).scenario


@pytest.mark.sampled(2)
@pytest.mark.parametrize(
    ("count", "is_walled", "horizon"), [(8, True, 30), (25, True, 45), (25, False, 30)]
)
def test_many_who_go_around_obstacles_get_more_steps(
    tmp_path: Path, count: int, horizon: int, *, is_walled: bool
) -> None:
    assert imported(tmp_path, count, 20 if is_walled else 1).horizon == horizon


def test_many_who_go_around_obstacles_get_time_for_each_other(tmp_path: Path) -> None:
    few, many = (imported(tmp_path, count, 40) for count in (24, 25))
    # The vehicle of the longest way is the same: both last a multiple of its time.
    ratio = (many.dt * many.horizon) / (few.dt * few.horizon)
    assert ratio == pytest.approx(1.6 / 1.3, rel=0.01)


def test_steps_around_obstacles_are_short_enough_for_corners(tmp_path: Path) -> None:
    # A wall across all but one row makes the way of a few twice as long.
    scenario = imported(tmp_path, 2, 48)
    stride = scenario.dt * float(scenario.vehicles[0].speed_limit[0])
    assert stride <= 8.0 * scenario.vehicles[0].radius
    assert 30 < scenario.horizon <= 72
