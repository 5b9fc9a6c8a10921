"""What is too large, too many or too long is refused at once, with the limit."""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely

from radmpc.errors import FileFormatError, ScenarioError
from radmpc.geometry import convex_pieces, halfspaces
from radmpc.importing.formats import import_scenario
from radmpc.importing.rounding import rounded
from radmpc.io.native.scenario_file import load_scenario
from radmpc.io.text.files import read_text
from radmpc.model.consistency import growth
from radmpc.model.dynamics import LinearSystem, double_integrator, lqr_gain

INSTANCES = Path(__file__).parents[2] / "instances"
DYNOBENCH: dict[str, Any] = {
    "environment": {
        "min": [0, 0],
        "max": [9, 9],
        "obstacles": [{"type": "box", "center": [4, 4], "size": [1, 1]}],
    },
    "robots": [{"type": "double_integrator_0", "start": [1, 1, 0, 0], "goal": [2, 2, 0, 0]}],
}
SCENARIO: dict[str, Any] = {
    "format": "radmpc/scenario/1",
    "name": "one",
    "dt": 1.0,
    "horizon": 4,
    "risk_bound": 0.05,
    "obstacles": [{"name": "o", "min": [5, 5], "max": [6, 6]}],
    "vehicles": [
        {
            "name": "a",
            "start": [0, 0],
            "goal": {"center": [1, 1]},
            "radius": 0.4,
            "control_limit": 2.0,
        }
    ],
}


def written(folder: Path, content: object, name: str = "file.json") -> Path:
    path = folder / name
    path.write_text(json.dumps(content), encoding="utf-8")
    return path


def changed(vehicle: dict[str, object] | None = None, **fields: object) -> dict[str, Any]:
    return {**SCENARIO, **fields, "vehicles": [SCENARIO["vehicles"][0] | (vehicle or {})]}


def many(kind: str, count: int) -> list[dict[str, object]]:
    return [SCENARIO[kind][0] | {"name": str(i)} for i in range(count)]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("content", "message"),
    [
        (SCENARIO | {"vehicles": many("vehicles", 10_001)}, "vehicles: must have at most 10,000"),
        (changed(obstacles=many("obstacles", 10_001)), "obstacles: must have at most 10,000 ent"),
        (
            changed(obstacles=[{"name": "o", "vertices": [[0, 0]] * 2001}]),
            r"obstacles\[0\].vertices: must have at most 2,000 entries, got 2,001",
        ),
        (
            changed({"dynamics": {"A": [[0.0] * 51] * 51, "B": [[0.0]] * 51, "position": [0, 1]}}),
            r"vehicles\[0\].dynamics.A: must have at most 50 entries, got 51",
        ),
        (changed(dt=1e-300), r"dt: must lie between 1e-06 and 1e\+06 s, got 1e-300"),
        (changed(dt=1e8), r"dt: must lie between 1e-06 and 1e\+06 s, got 100000000.0"),
        (
            changed({"feedback": {"gain": [[-1e9, 0, 0, 0], [0, 0, 0, 0]]}}),
            r"vehicles\[0\].feedback: must not let a state grow more than 1e\+12 times within 4",
        ),
        (
            changed({"dynamics": {"A": [[1, 0], [0, 1e9]], "B": [[1], [0]], "position": [0, 1]}}),
            r"vehicles\[0\].dynamics: must not let a state grow more than 1e\+12 times within 4",
        ),
    ],
)
def test_a_scenario_beyond_a_limit_is_refused(
    tmp_path: Path, content: dict[str, Any], message: str
) -> None:
    with pytest.raises(FileFormatError, match=message):
        load_scenario(written(tmp_path, content))


@pytest.mark.parametrize("path", ["/dev/zero", "/dev/urandom"])
def test_a_device_without_end_is_refused(path: str) -> None:
    if not os.path.exists(path):
        pytest.skip("no such device here")
    with pytest.raises(FileFormatError, match=f"{path}: must be at most 4 MiB"):
        load_scenario(path)


def test_no_more_of_a_file_is_read_than_it_may_have(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("12345", encoding="utf-8")
    assert read_text(tmp_path / "file", 5) == "12345"
    with pytest.raises(FileFormatError, match="file: must be at most"):
        read_text(tmp_path / "file", 4)


def test_a_long_thin_room_is_imported_in_a_moment(tmp_path: Path) -> None:
    room = {**DYNOBENCH["environment"], "max": [999_999_999, 9]}
    # Laid out in cells, it would not fit into any memory.
    imported = import_scenario(written(tmp_path, DYNOBENCH | {"environment": room}))
    assert imported.scenario.num_vehicles == 1


@pytest.mark.slow
def test_more_vehicles_than_a_scenario_may_have_are_not_imported(tmp_path: Path) -> None:
    path = written(tmp_path, DYNOBENCH | {"robots": DYNOBENCH["robots"] * 10_001})
    with pytest.raises(FileFormatError, match=r"vehicles: must be at most 10,000, got 10,001"):
        import_scenario(path)


@pytest.mark.parametrize(
    ("quadrotor", "message"),
    [
        ({"radius": 1e-320}, r"quadrotors.q.radius: must lie between 1e-06 and 1e\+06 m, got 1e-"),
        ({"radius": -1.0}, r"quadrotors.q.radius: must be > 0 m, got -1.0"),
        ({"radius": float("nan")}, r"quadrotors.q.radius: must be a finite number, got nan"),
        ({"max_vel": [1e-300] * 3}, r"quadrotors.q.max_vel: must lie between 1e-06 and 1e\+06 m/s"),
        ({"max_acc": [1e9] * 3}, r"quadrotors.q.max_acc: must lie between 1e-06 and 1e\+06 m/s²"),
    ],
)
def test_a_quadrotor_that_cannot_be_is_not_imported(
    tmp_path: Path, quadrotor: dict[str, object], message: str
) -> None:
    kind = {"max_vel": [1, 1, 1], "max_acc": [2, 2, 2], "radius": 0.2} | quadrotor
    content = {
        "quadrotors": {"q": kind},
        "world": [{"dimension": [-5, -5, 0, 5, 5, 5]}],
        "agents": [{"type": "q", "start": [0, 0, 1], "goal": [1, 0, 1]}],
    }
    with pytest.raises(FileFormatError, match=message):
        import_scenario(written(tmp_path, content))


def test_a_scenario_that_could_not_be_read_again_is_not_imported(tmp_path: Path) -> None:
    content = {
        "quadrotors": {"q": {"max_vel": [1e5] * 3, "max_acc": [1e5] * 3, "radius": 0.2}},
        "world": [{"dimension": [-5, -5, 0, 1e9, 5, 5]}],
        "agents": [{"type": "q", "start": [0, 0, 1], "goal": [1e9, 0, 1]}],
    }
    with pytest.raises(FileFormatError, match=r"leads to a scenario that cannot be: workspace.max"):
        import_scenario(written(tmp_path, content))


def test_a_map_that_is_not_there_is_told_with_the_line_that_names_it(tmp_path: Path) -> None:
    path = tmp_path / "room.scen"
    path.write_text("version 1\n0\tno.map\t8\t3\t0\t0\t7\t0\t3.41\n", encoding="utf-8")
    with pytest.raises(FileFormatError, match=r"room.scen:2: tasks\[0\].map: must stand beside"):
        import_scenario(path)


@pytest.mark.slow
def test_a_polygon_of_many_corners_is_split_in_few_steps(monkeypatch: pytest.MonkeyPatch) -> None:
    joined, union = [], shapely.union
    monkeypatch.setattr(shapely, "union", lambda a, b: joined.append(1) or union(a, b))
    angles = np.linspace(0.0, 2.0 * np.pi, 1000, endpoint=False)
    radii = np.where(np.arange(1000) % 2, 6.0, 5.0)
    star = np.column_stack([radii * np.cos(angles), radii * np.sin(angles)])
    assert len(convex_pieces(star)) == 501
    # A few per corner, where asking every pair again after each would be a million.
    assert len(joined) <= 3 * len(star)


def test_a_normal_too_short_to_scale_is_refused() -> None:
    with pytest.raises(ScenarioError, match="every normal must be different from zero"):
        halfspaces([[1e-300, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]], [1e9, 1, 1, 1])


def test_a_step_so_short_that_the_regulator_overflows_is_none() -> None:
    with pytest.raises(ScenarioError, match=r"dt: must lie between 1e-06 and 1e\+06 s"):
        double_integrator(1e-300, 2)
    nothing = LinearSystem(np.eye(4), 1e-300 * np.eye(4)[:, 2:], (0, 1), (2, 3))
    with pytest.raises(ScenarioError, match=r"no stabilizing gain|must be finite"):
        lqr_gain(nothing, np.eye(4), np.diag([1.0, 2.0]))


def test_growth_is_the_largest_factor_on_the_way() -> None:
    system = double_integrator(2.0, 2)
    assert growth(system, None, 1) == pytest.approx(2.0)
    assert growth(system, None, 3) == pytest.approx(18.0)
    unstable = np.array([[1e9, 0, 0, 0], [0, 0, 0, 0]])
    assert growth(system, unstable, 1000) == float("inf")


def test_numbers_that_an_importer_computes_have_no_tails(tmp_path: Path) -> None:
    assert rounded(np.array([-0.2 + 0.05, 0.1 + 0.2])).tolist() == [-0.15, 0.3]
    forest = import_scenario(INSTANCES / "db-CBS" / "forest.yaml").scenario
    corners = [value for obstacle in forest.obstacles for value in obstacle.at(0)[0].offsets]
    assert all(len(repr(float(value))) <= 7 for value in corners)


def test_numbers_that_a_file_states_are_imported_bit_for_bit(tmp_path: Path) -> None:
    stated = 1.2345678901234567
    robot = DYNOBENCH["robots"][0] | {"start": [stated, stated, 0, 0]}
    room = DYNOBENCH["environment"] | {"min": [-stated, -stated]}
    path = written(tmp_path, {"environment": room, "robots": [robot]})
    scenario = import_scenario(path).scenario
    assert scenario.vehicles[0].start[0] == stated
    assert scenario.workspace is not None
    assert scenario.workspace.lower.tolist() == [-stated, -stated]
