"""Scenario files: every field, every default, and what is said of broken ones."""

import os
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from bare_scenario import BARE, bare

from comparing import differences
from radmpc.errors import FileFormatError, ScenarioError
from radmpc.io.native.scenario_file import (
    decode_scenario,
    encode_scenario,
    load_scenario,
    save_scenario,
)
from radmpc.model.dynamics import double_integrator, lqr_gain
from radmpc.model.obstacle import BoxShape, HalfspaceShape, MovingShape, PolygonShape

FULL = """\
format: radmpc/scenario/1
name: crossing
dt: 1.0                   # [s]
horizon: 1                # steps
risk_bound: 0.05
avoidance: steps
pair_faces: 6
workspace: {min: [0, 0], max: [20, 20]}
obstacles:
  - {name: reef, vertices: [[5, 5], [8, 5], [7, 8]]}
  - {name: pier, min: [10, 0], max: [12, 6]}
  - {name: hull, normals: [[1, 0], [-1, 0], [0, 1], [0, -1]], offsets: [3, -1, 9, -7]}
  - {name: ferry, moving: [[[1, 1], [2, 1], [2, 2]], [[2, 1], [3, 1], [3, 2]]]}
defaults:
  radius: 0.4
  control_limit: 2.0
  speed_limit: 3.0
  initial_covariance: [0.001, 0.001, 0.0001, 0.0001]
  disturbance_covariance: 0.002
  feedback: {gain: [[-0.3, 0, -0.9, 0], [0, -0.3, 0, -0.9]]}
vehicles:
  - {name: a, start: [1, 2], goal: {center: [12, 9], half_width: 0.2, speed: 0.05}}
  - name: b
    start: [12, 9, 0.5, 0]
    goal: {min: [0.8, 1.8], max: [1.2, 2.2]}
    radius: 1
    control_limit: [1, 2]
    feedback: null
    control_sigmas: 2
    cost_weight: 0.5
"""


@pytest.fixture
def full(tmp_path: Path) -> Path:
    path = tmp_path / "full.yaml"
    path.write_text(FULL, encoding="utf-8")
    return path


def test_a_scenario_with_every_field_is_read(full: Path) -> None:
    scenario = load_scenario(full)
    assert (scenario.name, scenario.dt, scenario.horizon) == ("crossing", 1.0, 1)
    assert (scenario.risk_bound, scenario.avoidance, scenario.pair_faces) == (0.05, "steps", 6)
    assert scenario.workspace is not None
    assert scenario.workspace.upper.tolist() == [20.0, 20.0]
    shapes = [type(obstacle.shape) for obstacle in scenario.obstacles]
    assert shapes == [PolygonShape, BoxShape, HalfspaceShape, MovingShape]
    a, _ = scenario.vehicles
    assert a.start.tolist() == [1.0, 2.0, 0.0, 0.0]
    assert (a.goal.lower.tolist(), a.goal.upper.tolist()) == ([11.8, 8.8], [12.2, 9.2])
    assert a.goal.speed is not None
    assert a.goal.speed.tolist() == [0.05, 0.05]
    assert np.diag(a.initial_covariance).tolist() == [0.001, 0.001, 0.0001, 0.0001]
    assert a.disturbance_covariance.tolist() == (0.002 * np.eye(4)).tolist()
    assert (a.control_sigmas, a.cost_weight) == (3.0, 1.0)


def test_a_vehicles_own_field_wins_over_the_defaults(full: Path) -> None:
    a, b = load_scenario(full).vehicles
    assert (a.radius, b.radius) == (0.4, 1.0)
    assert (a.control_limit.tolist(), b.control_limit.tolist()) == ([2.0, 2.0], [1.0, 2.0])
    assert a.gain is not None
    assert b.gain is None
    assert (b.control_sigmas, b.cost_weight) == (2.0, 0.5)
    assert b.start.tolist() == [12.0, 9.0, 0.5, 0.0]


def test_absent_fields_take_their_documented_defaults() -> None:
    scenario = decode_scenario(bare())
    (vehicle,) = scenario.vehicles
    assert (scenario.avoidance, scenario.pair_faces) == ("intervals", None)
    assert scenario.workspace is None
    assert scenario.source is None
    assert scenario.obstacles == ()
    assert vehicle.goal.lower.tolist() == vehicle.goal.upper.tolist() == [1.0, 1.0]
    assert vehicle.goal.speed is not None
    assert vehicle.goal.speed.tolist() == [0.0, 0.0]
    assert not vehicle.initial_covariance.any()
    assert not vehicle.disturbance_covariance.any()
    assert vehicle.speed_limit is None
    assert vehicle.gain is None
    assert vehicle.system.is_double_integrator


def test_a_goal_with_three_coordinates_makes_a_double_integrator_in_space() -> None:
    data = bare(start=[0, 0, 0], goal={"center": [1, 1, 1], "half_width": [0.1, 0.2, 0.3]})
    (vehicle,) = decode_scenario(data).vehicles
    assert vehicle.system.dimension == 3
    assert vehicle.goal.upper.tolist() == [1.1, 1.2, 1.3]
    assert vehicle.control_limit.tolist() == [1.0, 1.0, 1.0]


def test_a_null_goal_speed_leaves_it_free() -> None:
    (vehicle,) = decode_scenario(bare(goal={"center": [1, 1], "speed": None})).vehicles
    assert vehicle.goal.speed is None


def test_dynamics_of_matrices_place_the_position_by_its_indices() -> None:
    dynamics = {"A": np.eye(3).tolist(), "B": [[1, 0], [0, 1], [0, 0]], "position": [2, 0]}
    (vehicle,) = decode_scenario(bare(dynamics=dynamics, start=[5, 7])).vehicles
    assert vehicle.start.tolist() == [7.0, 0.0, 5.0]
    assert vehicle.goal.speed is None
    assert not vehicle.system.is_double_integrator


@pytest.mark.parametrize("Q", [2.0, [2.0] * 4, (2.0 * np.eye(4)).tolist()])
def test_a_regulator_becomes_the_gain_it_leads_to(Q: object) -> None:
    scenario = decode_scenario(bare(feedback={"lqr": {"Q": Q, "R": 1.0}}))
    (vehicle,) = scenario.vehicles
    assert vehicle.gain is not None
    wanted = lqr_gain(double_integrator(0.5, 2), 2.0 * np.eye(4), np.eye(2))
    assert vehicle.gain.tolist() == wanted.tolist()
    (written,) = encode_scenario(scenario)["vehicles"]
    assert written["feedback"] == {"gain": wanted.tolist()}


def test_what_all_vehicles_share_is_written_once(full: Path) -> None:
    content = encode_scenario(load_scenario(full))
    assert content["defaults"]["speed_limit"] == 3.0
    assert content["defaults"]["dynamics"] == {"model": "double_integrator"}
    assert "radius" not in content["defaults"]
    assert content["vehicles"][0]["goal"] == {
        "center": [12.0, 9.0],
        "half_width": 0.2,
        "speed": 0.05,
    }


def test_minus_zero_is_not_shared_with_zero() -> None:
    first = {"name": "a", "start": [0, 0], "goal": {"center": [1, 1]}, "cost_weight": 0.0}
    second = {**first, "name": "b", "cost_weight": -0.0}
    data = {
        **BARE,
        "defaults": {"radius": 1, "control_limit": 1},
        "vehicles": [first, second],
    }
    scenario = decode_scenario(data)
    assert differences(decode_scenario(encode_scenario(scenario)), scenario) == []


def test_a_saved_file_is_readable_by_people(full: Path, tmp_path: Path) -> None:
    save_scenario(load_scenario(full), tmp_path / "saved.yaml")
    lines = (tmp_path / "saved.yaml").read_text(encoding="utf-8").splitlines()
    assert "  - {name: pier, min: [10.0, 0.0], max: [12.0, 6.0]}" in lines
    assert max(len(line) for line in lines) <= 100


def test_a_double_integrator_of_another_dt_is_refused(full: Path) -> None:
    scenario = load_scenario(full)
    with pytest.raises(ScenarioError, match=r"vehicles\[0\].dynamics: .* dt = 0.5 s"):
        replace(scenario, dt=0.5)


def test_a_step_too_long_for_a_double_integrator_is_told_as_the_step() -> None:
    told = r"^dt: must be at most 44721 s for a double integrator, got 1000000\.0$"
    with pytest.raises(ScenarioError, match=told):
        decode_scenario({**bare(), "dt": 1e6})
    with pytest.raises(ScenarioError, match=told):
        double_integrator(1e6, 2)
    assert decode_scenario({**bare(), "dt": 44721.0}).dt == 44721.0
    matrices = {"A": [[1, 0], [0, 1]], "B": [[1, 0], [0, 1]], "position": [0, 1]}
    assert decode_scenario({**bare(dynamics=matrices), "dt": 1e6}).dt == 1e6


def test_a_source_that_is_no_plain_data_cannot_be_written(full: Path) -> None:
    scenario = replace(load_scenario(full), source={"what": object()})
    with pytest.raises(ScenarioError, match=r"source.what: must be plain data"):
        encode_scenario(scenario)


def test_a_source_of_arrays_and_tuples_is_written_as_lists(full: Path) -> None:
    source = {"a": np.array([1.0, 2.0]), "b": (1, "x"), "c": np.float64(0.5)}
    scenario = replace(load_scenario(full), source=source)
    assert encode_scenario(scenario)["source"] == {"a": [1.0, 2.0], "b": [1, "x"], "c": 0.5}


def test_only_yaml_and_json_are_written(full: Path, tmp_path: Path) -> None:
    with pytest.raises(FileFormatError, match=r"must end in .yaml, .yml or .json"):
        save_scenario(load_scenario(full), tmp_path / "scenario.txt")


def test_a_missing_file_is_one_line(tmp_path: Path) -> None:
    with pytest.raises(FileFormatError, match=r"nowhere.yaml: No such file or directory$"):
        load_scenario(tmp_path / "nowhere.yaml")


def test_a_folder_is_no_file(tmp_path: Path) -> None:
    with pytest.raises(FileFormatError, match=r": Is a directory$"):
        load_scenario(tmp_path)


def test_a_name_with_a_nul_is_no_file() -> None:
    with pytest.raises(FileFormatError, match=r"is no file name"):
        load_scenario("a\0b.yaml")


@pytest.mark.skipif(os.name != "posix", reason="names may hold line breaks there")
def test_a_file_name_with_a_line_break_still_makes_one_line(tmp_path: Path) -> None:
    path = tmp_path / "a\nb.yaml"
    path.write_text("")
    with pytest.raises(FileFormatError) as caught:
        load_scenario(path)
    assert str(caught.value).endswith(r"a\nb.yaml:1: is empty")


@pytest.mark.parametrize("suffix", [".yaml", ".json"])
def test_bytes_that_are_no_text_are_named_with_their_line(tmp_path: Path, suffix: str) -> None:
    path = tmp_path / f"image{suffix}"
    path.write_bytes(b"name: x\n\x89PNG\xff\xfe\0")
    with pytest.raises(FileFormatError, match=r":2: must be text in UTF-8, got the byte 0x89$"):
        load_scenario(path)


def test_a_byte_order_mark_is_no_harm(full: Path) -> None:
    full.write_bytes(b"\xef\xbb\xbf" + full.read_bytes())
    assert load_scenario(full).name == "crossing"


def test_windows_line_ends_are_no_harm(full: Path) -> None:
    full.write_bytes(full.read_bytes().replace(b"\n", b"\r\n"))
    assert load_scenario(full).name == "crossing"


def test_long_values_are_cut_in_messages(tmp_path: Path) -> None:
    path = tmp_path / "long.yaml"
    path.write_text(f"format: radmpc/scenario/1\nname: x\ndt: {'9' * 100_000}\n")
    with pytest.raises(FileFormatError, match=r":3: dt: must be a number") as caught:
        load_scenario(path)
    assert len(str(caught.value)) < 500
