"""The hunt among flights: what it plays, and that it finds what is wrong."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

import radmpc
from hunt_flights import play, summary
from hunting.flights_console import KEYS
from hunting.flights_scenes import draw_flown_scene
from hunting.flights_ticks import tick_problems
from hunting.flights_world import World
from radmpc.cli import app


@pytest.mark.slow
def test_a_scene_is_flown_in_all_ways_and_nothing_is_wrong() -> None:
    found = play(0, 3, 5.0)
    assert (found.kinds, found.notes) == ("", "")
    assert found.missions > 15
    assert "no contradiction" in summary([found])[-1]


def _alone() -> radmpc.Vehicle:
    eye = np.eye(2)
    return radmpc.Vehicle(
        name="a",
        system=radmpc.LinearSystem(eye, eye, (0, 1), None),
        start=[0.0, 0.0],
        goal=radmpc.Goal.at([1.0, 0.0], 0.5, None),
        radius=0.2,
        control_limit=1.0,
        initial_covariance=1e-4,
        disturbance_covariance=1e-4,
    )


def test_scenes_are_their_seeds() -> None:
    first, again = (draw_flown_scene(1, 2) for _ in range(2))
    assert repr(first) == repr(again)
    assert np.array_equal(first.vehicles[0].start, again.vehicles[0].start)


def test_decisions_that_make_wealth_are_found_out() -> None:
    plan = radmpc.plan(radmpc.Scenario("one", 1.0, 2, 0.1, [_alone()]), rng=0).require()
    mission, world = radmpc.Mission(plan, planner=None), World(plan.scenario, 1)
    bank = mission.balance.bank
    tick = mission.step(world.reset()[0])
    assert tick_problems(mission, tick, bank) == []
    assert tick_problems(mission, tick, bank + 1e-3)
    assert tick_problems(mission, replace(tick, wealth=0.5 * tick.wealth), bank)
    assert tick_problems(mission, replace(tick, choice="candidate", price=0.2), bank)
    fast = replace(tick.segments[0], control=np.array([1.1, 0.0]))
    assert tick_problems(mission, replace(tick, segments=(fast,)), bank)


@pytest.mark.slow
def test_the_hunt_knows_what_the_command_prints(tmp_path: Path) -> None:
    plan = radmpc.plan(radmpc.Scenario("one", 1.0, 2, 0.1, [_alone()]), rng=0).require()
    radmpc.save_plan(plan, tmp_path / "a.plan.json")
    words = ["fly", str(tmp_path / "a.plan.json"), "--replan", "none", "--json"]
    assert set(json.loads(CliRunner().invoke(app, words).stdout)) == KEYS
