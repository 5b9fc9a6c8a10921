from __future__ import annotations

import json
from pathlib import Path

import pytest

from radmpc.errors import FileFormatError
from radmpc.importing.formats import import_scenario
from running import first_plan

FOLDER = Path(__file__).parent.parent.parent / "instances" / "lsc_planner"


def mission(**changes: object) -> dict[str, object]:
    kind = {"max_vel": [1.0, 1.0, 0.5], "max_acc": [2.0, 2.0, 3.0], "radius": 0.2}
    agents = [
        {"type": "small", "start": [0.0, 0.0, 1.0], "goal": [2.0, 0.0, 1.0]},
        {"type": "small", "start": [2.0, 2.0, 1.0], "goal": [0.0, 2.0, 1.5]},
    ]
    content: dict[str, object] = {
        "quadrotors": {"small": kind},
        "world": [{"dimension": [-5, -5, 0.0, 5, 5, 2.5]}],
        "agents": agents,
        "obstacles": [],
    }
    return content | changes


def written(folder: Path, content: object) -> Path:
    path = folder / "mission.json"
    path.write_text(json.dumps(content), encoding="utf-8")
    return path


def test_agents_keep_radius_and_limits_of_their_type_and_stay_in_the_world(tmp_path: Path) -> None:
    scenario = import_scenario(written(tmp_path, mission())).scenario
    assert [v.name for v in scenario.vehicles] == ["agent1", "agent2"]
    assert {v.radius for v in scenario.vehicles} == {0.2}
    assert scenario.vehicles[0].speed_limit.tolist() == [0.5] * 3
    assert scenario.vehicles[0].control_limit.tolist() == [2.0] * 3
    assert scenario.workspace is not None
    assert scenario.workspace.upper.tolist() == [5.0, 5.0, 2.5]


@pytest.mark.parametrize("name", ["forest_20agents_3", "empty_20agents_3"])
def test_a_mission_says_that_its_trees_and_walls_are_not_read(name: str) -> None:
    imported = import_scenario(FOLDER / f"{name}.json")
    told = [one for one in imported.warnings if one.startswith("trees and walls are not read: ")]
    assert len(told) == 1
    assert imported.scenario.obstacles == ()


def test_a_mission_of_swarm_simulator_keeps_the_radii_of_its_agents(tmp_path: Path) -> None:
    agents = [
        {"name": "small", "start": [0.0, 0.0, 1.0], "goal": [2.0, 0.0, 1.0], "radius": 0.3},
        {"name": "small", "start": [2.0, 2.0, 1.0], "goal": [0.0, 2.0, 1.5]},
    ]
    content = mission(agents=agents)
    del content["world"], content["obstacles"]
    imported = import_scenario(written(tmp_path, content))
    assert [v.radius for v in imported.scenario.vehicles] == [0.3, 0.2]
    assert imported.choices["radius"] == "from the mission's agents and quadrotors"
    assert imported.scenario.workspace is None
    assert imported.warnings[1].startswith("the file states no world: ")


@pytest.mark.slow
def test_a_published_mission_is_planned_within_the_bound() -> None:
    imported = import_scenario(FOLDER / "multi_simple4.json")
    assert any("downwash" in warning for warning in imported.warnings)
    result = first_plan(imported.scenario, time_limit=60.0)
    assert result.is_certified


@pytest.mark.parametrize(
    ("changes", "expected"),
    [
        ({"agents": []}, "at least one agent"),
        ({"obstacles": [{"type": "spin"}]}, "moving obstacles of LSC missions are not read"),
        ({"world": [{"dimension": [0, 0, 5, 5]}]}, "must have 6 numbers, got 4"),
        ({"world": []}, "world"),
        (
            {"agents": [{"type": "big", "start": [0, 0, 1], "goal": [1, 0, 1]}]},
            "must be one of small, got 'big'",
        ),
        (
            {"agents": [{"name": "big", "start": [0, 0, 1], "goal": [1, 0, 1]}]},
            r"agents\[0\].name: must be one of small, got 'big'",
        ),
        (
            {"agents": [{"start": [0, 0, 1], "goal": [1, 0, 1]}]},
            r"agents\[0\].type: is required",
        ),
        (
            {"agents": [{"type": "small", "radius": -1, "start": [0, 0, 1], "goal": [1, 0, 1]}]},
            r"agents\[0\].radius: must be > 0",
        ),
        (
            {"agents": [{"type": "small", "start": [0, 0], "goal": [1, 0, 1]}]},
            "must have 3 numbers, got 2",
        ),
    ],
)
def test_a_mission_that_cannot_be_read_says_where(
    tmp_path: Path, changes: dict[str, object], expected: str
) -> None:
    with pytest.raises(FileFormatError, match=expected):
        import_scenario(written(tmp_path, mission(**changes)))
