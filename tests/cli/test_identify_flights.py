"""Noise that logs of `radmpc fly` tell, over many missions."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from radmpc.io.native.scenario_file import load_scenario
from simulator import Truth, as_csv, fly

from .conftest import CROSSING, Run

WIND = """\
shared_disturbances:
  - {name: wind, covariance: [0.003, 0.003], on: {default: [[0.5, 0], [0, 0.5], [1, 0], [0, 1]]}}
"""


@pytest.fixture
def in_wind(run: Run, tmp_path: Path) -> Path:
    """A log of forty flights of two vehicles in one wind, without feedback."""
    scenario = tmp_path / "wind.yaml"
    scenario.write_text(CROSSING + WIND, encoding="utf-8")
    assert run("plan", scenario, "-o", "wind.json", "--set", "risk_bound=0.3").exit_code == 0
    words = ("--replan", "none", "--missions", 40, "-o", "a.jsonl", "--log", "a.mcap")
    run("fly", "wind.json", *words)
    return scenario


def test_what_vehicles_share_over_many_missions_is_found(run: Run, in_wind: Path) -> None:
    result = run("identify", "a.mcap", "--scenario", in_wind, "-o", "b.yaml")
    assert result.exit_code == 0, result.output
    assert "of the variance is common to vehicles at equal times" in result.stdout
    [shared] = {part.name for v in load_scenario("b.yaml").vehicles for part in v.shared}
    assert shared == "shared"


def test_rounding_is_no_feedback(run: Run, in_wind: Path) -> None:
    del in_wind
    result = run("identify", "a.mcap", "--json")
    gain = np.array(json.loads(result.stdout)["groups"][0]["gain"]["value"])
    np.testing.assert_array_equal(gain, np.zeros((2, 4)))
    run("identify", "a.mcap", "-o", "b.yaml")
    assert "gain" not in Path("b.yaml").read_text(encoding="utf-8")


def test_a_shared_part_that_logs_do_not_tell_is_not_dropped_in_silence(
    run: Run, tmp_path: Path
) -> None:
    log = as_csv(fly(Truth(), 1, "commands"))
    (tmp_path / "wind.csv").write_text(log, encoding="utf-8")
    scenario = tmp_path / "wind.yaml"
    half_steps = CROSSING.replace("dt: 1.0", "dt: 0.5")
    scenario.write_text(half_steps + WIND, encoding="utf-8")
    result = run("identify", "wind.csv", "--scenario", scenario, "-o", "b.yaml")
    assert result.exit_code == 0, result.output
    assert "shared disturbances are left out" in " ".join(result.stdout.split())
