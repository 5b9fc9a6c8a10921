"""Fly, identify, plan and fly again by one command, in simulators of others."""

from __future__ import annotations

import json
from dataclasses import replace
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from boats import sea
from typer.testing import CliRunner

from radmpc.cli import app
from radmpc.io.native.plan_file import save_plan
from radmpc.model.dynamics import lqr_gain
from radmpc.model.goal import Goal
from radmpc.model.scenario import Scenario
from radmpc.planning import plan

needs_rotorpy = pytest.mark.skipif(
    find_spec("rotorpy") is None, reason="needs: pip install 'radmpc[rotorpy]'"
)
needs_irsim = pytest.mark.skipif(
    find_spec("irsim") is None, reason="needs: pip install 'radmpc[irsim]'"
)


def supposed(deviation: float, dimension: int, dt: float, radius: float) -> Scenario:
    """Return two vehicles that meet head-on, in noise that somebody supposed."""
    scenario = sea(dimension=dimension, radius=radius, dt=dt, horizon=14)
    ones = np.ones(dimension)
    gain = lqr_gain(scenario.vehicles[0].system, np.eye(2 * dimension), 4.0 * np.eye(dimension))
    beside = [0.0] * (dimension - 1)
    length = 12.0 * dt
    vehicles = [
        replace(
            vehicle,
            start=[begin, *beside, 0.0, *beside],
            goal=Goal.at([length - begin, *beside], 0.5),
            control_limit=1.0 / dt,
            gain=gain,
            initial_covariance=np.r_[1e-4 * ones, 1e-6 * ones],
            disturbance_covariance=deviation**2 * np.r_[0.25 * ones, ones],
        )
        for vehicle, begin in zip(scenario.vehicles, (0.0, length), strict=True)
    ]
    return replace(scenario, vehicles=tuple(vehicles))


def calibrated(folder: Path, scenario: Scenario, *words: str) -> Any:
    """Return what the command tells, which must have found nothing wrong with the new plan."""
    save_plan(plan(scenario, rng=0, time_limit=20).require(), folder / "hopeful.json")
    named = "-o", str(folder / "known.yaml"), "--plan", str(folder / "known.json"), "--json"
    result = CliRunner().invoke(app, ["calibrate", str(folder / "hopeful.json"), *words, *named])
    # Else the interval of the collision rate lay above the new plan's certificate.
    assert result.exit_code == 0, result.output
    return json.loads(result.stdout)


@needs_rotorpy
@pytest.mark.nightly
def test_quadrotors_collide_more_than_certified_until_their_own_noise_is_planned_with(
    tmp_path: Path,
) -> None:
    words = "--with", "rotorpy", "--option", "gust=0.6", "--missions", "30"
    told = calibrated(tmp_path, supposed(0.01, 3, 0.5, 0.3), *words)
    before, after = told["before"], told["after"]
    assert not before["holds"]
    assert before["doubted"] == 30
    assert after["holds"]
    assert after["certified"] <= 0.1
    assert after["rate"] < 0.5 * before["rate"]
    assert after["doubted"] <= 3


@needs_irsim
@pytest.mark.nightly
def test_wheels_that_slip_speak_against_the_model_until_their_own_noise_is_planned_with(
    tmp_path: Path,
) -> None:
    told = calibrated(tmp_path, supposed(0.003, 2, 1.0, 0.5), "--with", "irsim", "--missions", "30")
    before, after = told["before"], told["after"]
    assert before["doubted"] == 30
    assert after["rate"] <= after["certified"] <= 0.1
    # Noise that grows with speed is none of one covariance.
    assert after["doubted"] < 30
