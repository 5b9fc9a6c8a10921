from __future__ import annotations

import random
from pathlib import Path

import numpy as np
import pytest
from refusing import refusal

from radmpc.errors import FileFormatError, ScenarioError
from radmpc.importing.formats import ImportOptions, import_scenario
from radmpc.importing.grid.cells import rectangles
from radmpc.model.scenario import Scenario
from running import first_plan

FOLDER = Path(__file__).parent.parent.parent / "instances" / "libMultiRobotPlanning"
PUBLISHED = FOLDER / "map_8by8_obst12_agents4_ex1.yaml"

SMALL = """\
agents:
- {name: a, start: [0, 0], goal: [3, 2]}
- {name: b, start: [3, 0], goal: [0, 2]}
map:
  dimensions: [4, 3]
  obstacles: [[1, 1], [2, 1]]
"""

MAP = ["....@@..", "..@@@@..", "..TT@@..", "........", ".OOOOO..", "........"]
TASKS = [
    (0, 0, 0, 7, 0),
    (3, 1, 0, 1, 5),
    (0, 0, 0, 6, 5),
    (5, 7, 5, 0, 5),
    (5, 6, 5, 1, 5),
]


def written(folder: Path, text: str, name: str = "problem.yaml") -> Path:
    path = folder / name
    path.write_text(text, encoding="utf-8")
    return path


def scen(folder: Path, tasks: list[tuple[int, ...]] = TASKS, rows: list[str] = MAP) -> Path:
    cells = "\n".join(rows)
    written(folder, f"type octile\nheight {len(rows)}\nwidth 8\nmap\n{cells}\n", "room.map")
    lines = [
        "\t".join(map(str, (bucket, "maps/dao/room.map", 8, 6, *ends, 3.41)))
        for bucket, *ends in tasks
    ]
    return written(folder, "version 1\n" + "\n".join(lines) + "\n", "room.scen")


def covered(scenario: Scenario) -> list[tuple[int, int]]:
    """Cells under obstacles; one that two obstacles cover stands twice."""
    cells = []
    for obstacle in scenario.obstacles:
        corners = obstacle.at(0)[0].vertices
        (x0, y0), (x1, y1) = corners.min(axis=0).astype(int), corners.max(axis=0).astype(int)
        cells += [(x, y) for x in range(x0, x1) for y in range(y0, y1)]
    return sorted(cells)


def test_obstacles_are_exactly_the_blocked_cells_of_a_published_grid() -> None:
    scenario = import_scenario(PUBLISHED).scenario
    blocked = [(5, 0), (5, 6), (0, 6), (3, 1), (1, 3), (2, 2), (7, 4), (6, 6), (0, 5), (2, 5)]
    assert covered(scenario) == sorted([*blocked, (3, 3), (5, 1)])
    assert [o.name for o in scenario.obstacles] == [f"r{i}" for i in range(1, 10)]


def test_vehicles_start_and_end_in_the_middle_of_their_cells() -> None:
    scenario = import_scenario(PUBLISHED).scenario
    assert [v.name for v in scenario.vehicles] == ["agent0", "agent1", "agent2", "agent3"]
    assert scenario.vehicles[0].start_position.tolist() == [1.5, 7.5]
    np.testing.assert_allclose(scenario.vehicles[0].goal.center, [1.5, 0.5])


def test_hulls_stay_within_the_map_and_fit_between_two_blocked_cells(tmp_path: Path) -> None:
    imported = import_scenario(written(tmp_path, SMALL))
    scenario = imported.scenario
    assert scenario.workspace is not None
    assert scenario.workspace.lower.tolist() == [0.25, 0.25]
    assert scenario.workspace.upper.tolist() == [3.75, 2.75]
    for vehicle in scenario.vehicles:
        sigma = np.sqrt(vehicle.covariances(scenario.horizon)[-1, 0, 0])
        assert 2.0 * vehicle.radius + 8.0 * sigma <= 1.0
    assert imported.warnings == ()


def test_a_radius_that_is_asked_for_moves_the_workspace_with_it(tmp_path: Path) -> None:
    scenario = import_scenario(written(tmp_path, SMALL), ImportOptions(radius=0.4)).scenario
    assert scenario.workspace is not None
    np.testing.assert_allclose(scenario.workspace.lower, 0.4)
    # Between wall and obstacle 0.1 m is left on either side: four standard deviations.
    sigma = np.sqrt(scenario.vehicles[0].covariances(scenario.horizon)[-1, 0, 0])
    assert sigma == pytest.approx(0.1 / 4.0, rel=0.05)


def test_a_grid_in_which_no_way_is_free_says_so_on_import(tmp_path: Path) -> None:
    text = SMALL.replace("[[1, 1], [2, 1]]", "[[1, 0], [1, 1], [1, 2]]")
    imported = import_scenario(written(tmp_path, text))
    assert "between start and goal of 'a' a hull of 0.25 m finds no path" in imported.warnings[0]
    assert "it might" not in imported.warnings[0]


@pytest.mark.parametrize("share", [0.0, 0.1, 0.3, 0.6, 1.0])
def test_rectangles_cover_every_blocked_cell_once_and_no_other(share: float) -> None:
    rng = np.random.default_rng(7)
    blocked = rng.random((31, 23)) < share
    count = np.zeros(blocked.shape, dtype=int)
    for x0, y0, x1, y1 in rectangles(blocked):
        count[x0:x1, y0:y1] += 1
    np.testing.assert_array_equal(count, blocked.astype(int))


def test_rectangles_are_few() -> None:
    blocked = np.zeros((64, 64), dtype=bool)
    blocked[10:50, 20:40] = True
    blocked[20:24, 40:60] = True
    blocked[0, :] = blocked[-1, :] = blocked[:, 0] = blocked[:, -1] = True
    assert len(rectangles(blocked)) == 6
    rng = np.random.default_rng(7)
    noisy = rng.random((40, 40)) < 0.4
    assert len(rectangles(noisy)) < 0.6 * noisy.sum()
    room = np.array([list(row) for row in MAP]).T
    assert len(rectangles(np.isin(room, list("@TO")))) <= 4


@pytest.mark.slow
def test_a_published_grid_is_planned_within_the_bound() -> None:
    result = first_plan(import_scenario(PUBLISHED).scenario, time_limit=60.0)
    assert result.is_certified


def test_tasks_are_read_with_the_map_beside_them(tmp_path: Path) -> None:
    imported = import_scenario(scen(tmp_path))
    scenario = imported.scenario
    assert covered(scenario) == sorted(
        (x, y) for y, row in enumerate(MAP) for x, cell in enumerate(row) if cell in "@TO"
    )
    assert [v.start_position.tolist() for v in scenario.vehicles] == [
        [0.5, 0.5],
        [1.5, 0.5],
        [7.5, 5.5],
    ]
    assert imported.choices["map"] == "room.map"
    assert "2 ignored" in imported.choices["tasks"]
    assert scenario.source is not None
    assert scenario.source["format"] == "MovingAI"


def test_eight_tasks_are_taken_unless_asked_otherwise(tmp_path: Path) -> None:
    tasks = [(0, x, 3, 7 - x, 5) for x in range(8)] + [(1, 0, 0, 1, 1), (1, 1, 0, 0, 1)]
    path = scen(tmp_path, tasks)
    imported = import_scenario(path)
    assert len(imported.scenario.vehicles) == 8
    assert imported.choices["agents"] == "the first 8 of 10"
    imported = import_scenario(path, ImportOptions(agents=2))
    assert [v.name for v in imported.scenario.vehicles] == ["agent1", "agent2"]
    assert imported.choices["agents"] == "the first 2 of 10, as asked"
    with pytest.raises(FileFormatError, match=r"agents: must be at most 10, got 11"):
        import_scenario(path, ImportOptions(agents=11))
    with pytest.raises(ScenarioError, match=r"agents: must be at least 1 vehicle, got 0"):
        ImportOptions(agents=0)


def test_as_many_vehicles_of_any_problem_are_taken_as_asked(tmp_path: Path) -> None:
    scenario = import_scenario(written(tmp_path, SMALL), ImportOptions(agents=1)).scenario
    assert [v.name for v in scenario.vehicles] == ["a"]


def test_a_map_alone_and_a_missing_map_are_told(tmp_path: Path) -> None:
    path = scen(tmp_path)
    with pytest.raises(FileFormatError, match=r"room.map: is a map without starts and goals: imp"):
        import_scenario(tmp_path / "room.map")
    (tmp_path / "room.map").unlink()
    with pytest.raises(FileFormatError, match=r"room.map: No such file or directory"):
        import_scenario(path)


@pytest.mark.parametrize(
    ("old", "new", "line"),
    [
        ("dimensions: [4, 3]", "dimensions: [4]", r":5: map.dimensions: must be 2 whole numbers"),
        ("dimensions: [4, 3]", "dimensions: [4, 0]", r":5: map.dimensions: must be 2 whole numb"),
        ("[4, 3]", "[90000, 90000]", r":5: map.dimensions: must be at most 4,000,000 cells"),
        ("[2, 1]", "[2, 3]", r":6: map.obstacles\[1\]: must be a cell from \[0, 0\] to \[3, 2\]"),
        ("[2, 1]", "[2, 1, 0]", r":6: map.obstacles\[1\]: must have 2 whole numbers, got 3"),
        ("[2, 1]", "[2, 1.5]", r":6: map.obstacles\[1\]\[1\]: must be a whole number"),
        ("start: [0, 0]", "start: [1, 1]", r":2: agents\[0\].start: must be a free cell, got the"),
        ("goal: [3, 2]", "goal: [4, 2]", r":2: agents\[0\].goal: must be a cell from"),
        ("name: b", "name: a", r":3: agents\[1\].name: must be unique, got 'a' twice"),
        (
            "goal: [0, 2]",
            "potentialGoals: [[0, 2]]",
            r":3: agents\[1\].potentialGoals: is not read: state a 'goal' for each agent",
        ),
        ("[1, 1]", "!!python/tuple [1, 1]", r":6: tags are not allowed"),
    ],
)
def test_a_grid_that_cannot_be_read_is_one_line(
    tmp_path: Path, old: str, new: str, line: str
) -> None:
    assert old in SMALL
    with pytest.raises(FileFormatError, match=line):
        import_scenario(written(tmp_path, SMALL.replace(old, new, 1)))


def test_blocked_cells_are_told_only_where_there_are_any(tmp_path: Path) -> None:
    open_grid = SMALL.replace("[[1, 1], [2, 1]]", "[]")
    assert "obstacles" not in import_scenario(written(tmp_path, open_grid)).choices
    told = import_scenario(written(tmp_path, SMALL)).choices["obstacles"]
    assert told == "2 blocked cells joined into 1 rectangle"


@pytest.mark.parametrize(
    ("old", "new", "line"),
    [
        ("version 1", "version 2", r"room.scen:1: must be 'version 1', got 'version 2'"),
        ("\t3.41", "", r"room.scen:2: must have 9 fields .*, got 8"),
        ("\t8\t6\t0\t0\t", "\t8\t6\t0\tx\t", r"room.scen:2: y: must be a whole number >= 0, got"),
        ("\t8\t6\t0\t0\t", "\t8\t6\t0\t-1\t", r"room.scen:2: y: must be a whole number >= 0"),
        ("\t8\t6\t", "\t9\t6\t", r"room.scen:2: tasks\[0\].size: must be of the map's size \[8, 6"),
        ("\t0\t0\t7\t0", "\t4\t0\t7\t0", r"room.scen:2: tasks\[0\].start: must be a free cell"),
        ("\t0\t0\t7\t0", "\t0\t0\t8\t0", r"room.scen:2: tasks\[0\].goal: must be a cell from"),
        ("3\tmaps/dao/room.map", "3\tother.map", r"room.scen:3: tasks\[1\].map: must be that of"),
    ],
)
def test_tasks_that_cannot_be_read_are_one_line(
    tmp_path: Path, old: str, new: str, line: str
) -> None:
    path = scen(tmp_path)
    text = path.read_text(encoding="utf-8")
    assert old in text
    path.write_text(text.replace(old, new, 1), encoding="utf-8")
    with pytest.raises(FileFormatError, match=line):
        import_scenario(path)


@pytest.mark.parametrize(
    ("old", "new", "line"),
    [
        ("....@@..", "....@@.", r"room.map:5: must have 8 cells, got 7"),
        ("..TT@@..", "..TX@@..", r"room.map:7: cells must be of .GS \(free\) and @OTW .*'X'"),
        ("width 8", "width w", r"room.map:3: must be 'type', 'height N', 'width N' or 'map'"),
        ("height 6", "height 7", r"room.map:4: must have 7 rows below, got"),
        ("height 6", "height 5", r"room.map:4: must have 5 rows below, got"),
        ("width 8\n", "", r"room.map:3: needs the lines 'height N', 'width N' and 'map'"),
        ("width 8", "width 900000", r"room.map:1: must be at most 4,000,000 cells"),
    ],
)
def test_a_map_that_cannot_be_read_is_one_line(
    tmp_path: Path, old: str, new: str, line: str
) -> None:
    path = scen(tmp_path)
    text = (tmp_path / "room.map").read_text(encoding="utf-8")
    assert old in text
    written(tmp_path, text.replace(old, new, 1), "room.map")
    with pytest.raises(FileFormatError, match=line):
        import_scenario(path)


@pytest.mark.parametrize("text", ["", "version 1\n", "version 1\n\n\n"])
def test_tasks_that_are_none_are_one_line(tmp_path: Path, text: str) -> None:
    with pytest.raises(FileFormatError, match=r"room.scen:1: (is empty|needs at least one task)"):
        import_scenario(written(tmp_path, text, "room.scen"))


def test_spoiled_grids_end_in_one_line(tmp_path: Path) -> None:
    rng = random.Random(3)
    path = scen(tmp_path)
    sources = {
        name: (tmp_path / name).read_text(encoding="utf-8") for name in ("room.scen", "room.map")
    }
    bits = ["", "\0", "\n", "\t", "9" * 40, "@", "-", " ", "\ufeff", "\u2028", "height 1\n", "map"]
    num_refused = 0
    for _ in range(200):
        for name, text in sources.items():
            at = rng.randrange(len(text))
            broken = text[:at] + rng.choice(bits) + text[at + rng.choice([0, 1, 9]) :]
            (tmp_path / name).write_bytes(broken.encode("utf-8"))
        line = refusal(path)
        if line is not None:
            num_refused += 1
            assert line.startswith(str(tmp_path))
            assert line.isprintable()
    assert num_refused > 100
