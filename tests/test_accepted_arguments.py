"""Arguments of any kind that means the same are taken, and values are told in one short line."""

from __future__ import annotations

import logging
import re
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest

import radmpc
from radmpc import Goal, Obstacle
from radmpc.arguments import value_text
from radmpc.experiments.families import circle, paper
from radmpc.wording import count_text

SCENE = circle(2)
PLAN = radmpc.plan(SCENE, "dlp").require()
ROCK = Obstacle.box("rock", [0.0, 0.0], [1.0, 1.0])


def test_numbers_of_numpy_are_numbers_and_become_those_of_python() -> None:
    made = replace(SCENE, horizon=np.int64(10), dt=np.float32(1.0), pair_faces=np.int32(4))
    assert [type(v) for v in (made.horizon, made.dt, made.pair_faces)] == [int, float, int]
    assert type(replace(SCENE.vehicles[0], radius=np.float32(0.5)).radius) is float
    assert radmpc.from_dict(radmpc.to_dict(made)).horizon == 10
    assert radmpc.simulate(PLAN, np.int64(7), rng=np.int64(1)).samples == 7
    assert radmpc.plan(made, rng=np.int64(3), time_limit=np.float64(5.0)).record.seed == 3


def test_sequences_of_any_kind_make_a_scenario() -> None:
    made = replace(SCENE, vehicles=list(SCENE.vehicles), obstacles=iter([ROCK]))
    assert made.vehicles == SCENE.vehicles
    assert made.obstacles == (ROCK,)


def test_whatever_submits_is_an_executor() -> None:
    with ThreadPoolExecutor(1) as pool:
        assert radmpc.plan(SCENE, "distance", executor=pool).is_certified


def test_a_class_of_executors_is_no_executor() -> None:
    with pytest.raises(radmpc.ArgumentTypeError, match=r"None, got the class ThreadPoolExecutor$"):
        radmpc.plan(SCENE, executor=ThreadPoolExecutor)  # type: ignore[arg-type] # a slip


def test_a_number_of_three_hundred_digits_is_not_written_out() -> None:
    with pytest.raises(radmpc.ArgumentTypeError, match=r"got 10000\.0: write 10000$"):
        radmpc.simulate(PLAN, 1e4)  # type: ignore[arg-type] # a slip
    with pytest.raises(radmpc.ArgumentTypeError, match=r"must be an integer >= 1, got 1e\+308$"):
        radmpc.simulate(PLAN, 1e308)  # type: ignore[arg-type] # a slip


@pytest.mark.parametrize(
    ("value", "text"),
    [
        ("x" * 100, r"'x+\.\.\.x+'"),
        (np.float64(0.5), "0.5"),
        (np.int64(3), "3"),
        (Fraction(1, 2), r"Fraction\(1, 2\)"),
        (np.zeros((3, 3)), "an? ndarray"),
        ([np.zeros((9, 9))] * 9, r"\[array.*\.\.\."),
        ({"a": 1}, "a dict"),
        (Goal, "the class Goal"),
    ],
)
def test_a_value_is_told_in_one_short_line(value: object, text: str) -> None:
    assert re.fullmatch(text, value_text(value))
    assert len(value_text(value)) <= 60


def test_a_name_with_a_nul_is_no_file_to_write_either() -> None:
    with pytest.raises(radmpc.FileFormatError, match="is no file name"):
        radmpc.save_plan(PLAN, "a\0b")


@pytest.mark.parametrize(
    ("number", "text"), [(0, "0 steps"), (1, "1 step"), (2, "2 steps"), (100, "100 steps")]
)
def test_one_of_a_kind_is_told_in_the_singular(number: int, text: str) -> None:
    assert count_text(number, "step") == text


def test_a_scenario_of_one_vehicle_is_shown_in_the_singular() -> None:
    scene = paper(1, 0)
    rocks = "1 obstacle" if len(scene.obstacles) == 1 else f"{len(scene.obstacles)} obstacles"
    assert f", 1 vehicle, {rocks}, " in repr(scene)


def test_the_log_of_a_search_counts_one_set_in_the_singular(
    caplog: pytest.LogCaptureFixture,
) -> None:
    with caplog.at_level(logging.INFO, logger="radmpc"):
        assert radmpc.plan(circle(2)).is_certified
    lines = [record.getMessage() for record in caplog.records]
    assert any("plan: 1 set; " in line for line in lines)
