from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import radmpc
from radmpc.console.settings import axes_of, changes_of
from radmpc.errors import ScenarioError
from radmpc.io.native.changes import changed, key_path

SCENARIO = """\
format: radmpc/scenario/1
name: pair
dt: 1.0
horizon: 4
risk_bound: 0.05
avoidance: steps
defaults: {radius: 0.4, control_limit: 2.0, initial_covariance: 0.0, disturbance_covariance: 0.001}
vehicles:
  - {name: east, start: [1, 5], goal: {center: [3, 5], half_width: 0.5}}
  - {name: tug.2, start: [9, 9], goal: {center: [7, 9], half_width: 0.5}}
"""


@pytest.fixture
def path(tmp_path: Path) -> Path:
    file = tmp_path / "pair.yaml"
    file.write_text(SCENARIO, encoding="utf-8")
    return file


def test_changed_values_stand_in_place_of_those_of_the_file(path: Path) -> None:
    scenario = radmpc.load_scenario(
        path,
        {
            "risk_bound": 0.02,
            "defaults.radius": 0.3,
            "vehicles.east.start": np.array([2.0, 5.0]),
            "vehicles[tug.2].radius": 0.7,
            "vehicles[1].cost_weight": 2,
            "workspace": {"min": [0, 0], "max": [20, 20]},
        },
    )
    assert scenario.risk_bound == 0.02
    assert [vehicle.radius for vehicle in scenario.vehicles] == [0.3, 0.7]
    assert scenario.vehicles[0].start[0] == 2.0
    assert scenario.vehicles[1].cost_weight == 2.0
    assert scenario.workspace is not None
    assert radmpc.load_scenario(path).risk_bound == 0.05


def test_null_takes_a_key_away(path: Path) -> None:
    with_workspace = path.read_text(encoding="utf-8") + "workspace: {min: [0, 0], max: [9, 9]}\n"
    path.write_text(with_workspace, encoding="utf-8")
    assert radmpc.load_scenario(path).workspace is not None
    assert radmpc.load_scenario(path, {"workspace": None}).workspace is None


FULL = (
    SCENARIO
    + """\
obstacles:
  - {name: reef, min: [4, 0], max: [6, 2]}
  - {name: pier, min: [4, 8], max: [6, 9]}
objective: {effort: 1.0}
keep: [{vehicles: [east, tug.2], within: 30}]
shared_disturbances: [{name: gust, covariance: 0.1, on: {default: 0.01}}]
"""
)


@pytest.mark.parametrize(
    "key",
    [
        "obstacles", "objective", "keep", "shared_disturbances", "avoidance", "vehicles.east.via",
        "defaults.initial_covariance", "defaults.cost_weight", "goals", "assign", "workspace",
        "obstacles.reef.holes", "vehicles.east.goal.half_width", "source",
    ],
)  # fmt: skip
def test_null_takes_any_optional_key_away(path: Path, key: str) -> None:
    path.write_text(FULL, encoding="utf-8")
    found = radmpc.load_scenario(path, {key: None})
    assert found.obstacles if key != "obstacles" else not found.obstacles
    assert found.keep if key != "keep" else not found.keep
    assert (found.avoidance == "intervals") == (key == "avoidance")
    assert (found.vehicles[0].shared == ()) == (key == "shared_disturbances")


def test_null_takes_entries_of_lists_away(path: Path) -> None:
    path.write_text(FULL, encoding="utf-8")
    alone = radmpc.load_scenario(
        path, {"keep[0]": None, "vehicles.east": None, "obstacles.pier": None}
    )
    assert [v.name for v in alone.vehicles] == ["tug.2"]
    assert [o.name for o in alone.obstacles] == ["reef"]
    none = radmpc.load_scenario(path, {"obstacles.reef": None, "obstacles[1]": None, "dt": 0.5})
    assert none.obstacles == ()
    later = radmpc.load_scenario(path, {"obstacles.pier": None, "obstacles": []})
    assert later.obstacles == ()


def test_null_that_files_have_stays_one(path: Path) -> None:
    given = SCENARIO.replace("{radius: 0.4,", "{radius: 0.4, feedback: {lqr: {Q: 1, R: 1}},")
    path.write_text(given, encoding="utf-8")
    found = radmpc.load_scenario(
        path, {"vehicles.east.feedback": None, "vehicles.east.goal.speed": None}
    )
    assert found.vehicles[0].gain is None
    assert found.vehicles[1].gain is not None
    assert found.vehicles[0].goal.speed is None


def test_half_a_box_is_told_without_what_null_took_away(path: Path) -> None:
    with pytest.raises(radmpc.FileFormatError, match=r"or min and max; got half_width$"):
        radmpc.load_scenario(path, {"vehicles.east.goal.center": None})


def test_null_leaves_a_vehicle_the_goal_of_the_defaults(path: Path) -> None:
    given = SCENARIO.replace("{radius: 0.4,", "{goal: {center: [5, 5]}, radius: 0.4,")
    path.write_text(given, encoding="utf-8")
    found = radmpc.load_scenario(path, {"vehicles.east.goal": None})
    assert found.vehicles[0].goal.lower.tolist() == [5.0, 5.0]
    assert found.vehicles[1].goal.lower.tolist() == [6.5, 8.5]


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"dt": None}, "dt: is required (as set; the file is "),
        (
            {"vehicles.east.start": None},
            "vehicles[0].start: is required, here or in defaults (as set",
        ),
        ({"vehicles.east.goal": None}, "vehicles[0].goal: is required, here or in defaults"),
        ({"vehicles.west": None}, "there is no 'west', only east, tug.2"),
        ({"vehicles.east.start[0]": None}, "vehicles[0].start[0]: must be a number, got null"),
        ({"workspce": None}, "workspce: unknown key, did you mean 'workspace'?"),
        ({"vehicles.east": None, "vehicles[1].radius": -1}, "vehicles[1].radius: must be > 0 m"),
    ],
)
def test_what_cannot_be_taken_away_is_told(
    path: Path, changes: dict[str, object], words: str
) -> None:
    with pytest.raises(ScenarioError) as error:
        radmpc.load_scenario(path, changes)
    assert words in str(error.value)
    assert "\n" not in str(error.value)


def test_errors_behind_an_entry_taken_away_keep_their_lines(path: Path) -> None:
    path.write_text(
        SCENARIO.replace("start: [9, 9]", "radius: -1, start: [9, 9]"), encoding="utf-8"
    )
    with pytest.raises(radmpc.FileFormatError, match=r"pair\.yaml:10: vehicles\[1\]\.radius: "):
        radmpc.load_scenario(path, {"vehicles.east": None})


def test_the_content_that_is_changed_stays_as_it_is() -> None:
    content = {"vehicles": [{"name": "east", "radius": 1.0}], "dt": 1.0}
    new, places = changed(content, {"vehicles.east.radius": 2.0})
    assert content == {"vehicles": [{"name": "east", "radius": 1.0}], "dt": 1.0}
    assert new == {"vehicles": [{"name": "east", "radius": 2.0}], "dt": 1.0}
    assert places.all == (("vehicles", 0, "radius"),)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        (
            {"risk_bound": 2},
            "risk_bound: must lie between 0 and 0.5, both excluded, got 2.0 (as set",
        ),
        ({"vehicles.east.radius": -1}, "vehicles[0].radius: must be > 0 m, got -1.0 (as set"),
        ({"vehicles.west.radius": 1}, "there is no 'west', only east, tug.2"),
        ({"vehicles[2].radius": 1}, "must name one of 2 entries from 0, got 2"),
        ({"horizon.steps": 1}, "horizon.steps: 4 has no part 'steps'"),
        ({"risk_bond": 0.1}, "risk_bond"),
        (
            {"defaults.disturbance_covariance": 0.0, "defaults.disturbance.covariance": 0.01},
            "defaults.disturbance: needs only one of: disturbance, disturbance_covariance; "
            "got both (as set; the file is ",
        ),
        (
            {"defaults.measurement.covariance": 0.01},
            "defaults.measurement: needs exactly one of: of, matrix; got none of them (as set; ",
        ),
        ({"vehicles..radius": 1}, "a key must be as in 'risk_bound' or 'vehicles.tug.radius'"),
        ({"dt": float("nan")}, "must be a finite number"),
    ],
)
def test_what_cannot_be_changed_is_told_with_its_key(
    path: Path, changes: dict[str, object], words: str
) -> None:
    with pytest.raises(ScenarioError) as error:
        radmpc.load_scenario(path, changes)
    assert words in str(error.value)
    assert "\n" not in str(error.value)


LONG = 10 * "very_" + 500 * "long"


@pytest.mark.parametrize(
    "key",
    [
        LONG,
        f"{LONG}.radius",
        f"vehicles.{LONG}.radius",
        f"vehicles.east.{LONG}",
        f"horizon.{LONG}",
        f"vehicles[{5000 * '1'}].radius",
        f"vehicles[{500 * '1'}].radius",
        f"vehicles.{LONG}..radius",
    ],
)
def test_a_long_key_that_cannot_be_changed_is_told_in_a_short_line(path: Path, key: str) -> None:
    with pytest.raises(ScenarioError) as error:
        radmpc.load_scenario(path, {key: 1})
    message = str(error.value).replace(str(path), "file")
    assert "..." in message
    assert len(message) < 400


@pytest.mark.parametrize(
    ("read", "value"),
    [(changes_of, "[0"), (axes_of, "[0"), (changes_of, "1")],
)
def test_options_tell_long_keys_in_a_short_line(
    read: Callable[[list[str]], object], value: str
) -> None:
    word = f"{LONG}={value}"
    with pytest.raises(ScenarioError) as error:
        read([word, word] if value == "1" else [word])
    assert str(error.value).startswith("--")
    assert len(str(error.value)) < 200


def test_errors_of_the_file_itself_keep_its_lines(path: Path) -> None:
    path.write_text(SCENARIO.replace("dt: 1.0", "dt: -1.0"), encoding="utf-8")
    with pytest.raises(radmpc.FileFormatError, match=r"pair\.yaml:3: dt: "):
        radmpc.load_scenario(path, {"risk_bound": 0.02})
    assert radmpc.load_scenario(path, {"dt": 0.5}).dt == 0.5


def test_names_with_dots_stand_in_brackets() -> None:
    assert key_path("vehicles[tug.2].goal.center") == ("vehicles", "tug.2", "goal", "center")
    assert key_path("obstacles[0].min") == ("obstacles", 0, "min")
