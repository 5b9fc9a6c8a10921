"""What `identify` tells of logs with an axis that never moves, and of vehicles that differ."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from cli.conftest import Run
from radmpc.console.reports.noise import tails_sentence
from radmpc.identification.tails import Tails
from radmpc.io.text.document import read_document
from simulator import Truth, as_csv, fly


def test_an_axis_that_never_moves_adds_nothing_to_the_block(run: Run, tmp_path: Path) -> None:
    [track] = fly(Truth(steps=300, drift=(0.2, 0.0, 0.0, 0.0)), 1)
    parts = {name: np.array(getattr(track, name)) for name in track.parts()}
    for part in parts.values():
        part[:, 1] = 0.0
    (tmp_path / "wind.csv").write_text(as_csv((track.changed(parts),)), encoding="utf-8")
    result = run("identify", "wind.csv", "-o", "noise.yaml")
    assert "y never changes: its noise cannot be told, and is taken as 0" in result.stdout
    fields = read_document("noise.yaml").value["defaults"]
    assert fields["drift"]["velocity"] == [pytest.approx(0.4, abs=0.05), 0.0]
    rows = np.array(fields["disturbance_covariance"])
    assert not rows[[1, 3]].any()
    assert not rows[:, [1, 3]].any()


def test_feedback_along_an_axis_that_never_moves_has_no_ends(run: Run, tmp_path: Path) -> None:
    [track] = fly(Truth(steps=300), 1, "references")
    parts = {name: np.array(getattr(track, name)) for name in track.parts()}
    for name, part in parts.items():
        part[:, 1::2] = 7.0 if name == "positions" else 0.0
    (tmp_path / "wind.csv").write_text(as_csv((track.changed(parts),)), encoding="utf-8")
    [group] = json.loads(run("identify", "wind.csv", "--json").stdout)["groups"]
    assert group["gain"]["value"][1] == [0.0, 0.0, 0.0, 0.0]
    assert group["gain"]["high"][1] == [None, None, None, None]
    assert "feedback ay" not in run("identify", "wind.csv").stdout


def test_vehicles_with_time_constants_of_their_own_have_one_each(run: Run, tmp_path: Path) -> None:
    slow = as_csv(fly(Truth(steps=1500, color=0.95), 1))
    fast = as_csv(fly(Truth(steps=1500, color=0.3, scale=3.0), 2)).replace(",v1,", ",fast,")
    (tmp_path / "wind.csv").write_text(slow + fast.split("\n", 1)[1], encoding="utf-8")
    result = run("identify", "wind.csv")
    assert "differ beyond chance: each has its own numbers" in result.stdout
    assert result.stdout.count("time constant  ") == 2
    assert "one time constant does not describe it" not in result.stdout


def test_measurement_noise_that_may_be_none_has_an_upper_end_alone(
    run: Run, tmp_path: Path
) -> None:
    truth = Truth(steps=1500, seen=(0.05, 0.0, 0.0, 0.0))
    (tmp_path / "wind.csv").write_text(as_csv(fly(truth, 1)), encoding="utf-8")
    [group] = json.loads(run("identify", "wind.csv", "--json").stdout)["groups"]
    ends = group["measurement"]
    assert 0.0 < ends["low"][0][0] < 0.05 < ends["high"][0][0]
    assert ends["low"][1][1] is None
    assert 0.0 < ends["value"][1][1] < ends["high"][1][1]
    lines = run("identify", "wind.csv").stdout.splitlines()
    [sure] = [line for line in lines if line.startswith("measurement of x,")]
    [unsure] = [line for line in lines if line.startswith("measurement of y,")]
    assert " to " in sure
    assert f"not identifiable, at most {ends['high'][1][1] ** 0.5:.3g}" in unsure


def test_the_interval_of_degrees_of_freedom_is_told_in_the_digits_of_their_number() -> None:
    told = tails_sentence(Tails(0.0, 60.0, 2.22, 2.2, 2.26))
    assert "about 2.2 degrees of freedom (2.2 to 2.3;" in told
