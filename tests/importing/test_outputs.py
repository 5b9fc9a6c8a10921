"""What radmpc writes itself holds no problem of another group: an import says what it is."""

from __future__ import annotations

from pathlib import Path

import pytest

from radmpc.errors import FileFormatError
from radmpc.experiments.families import circle
from radmpc.geodesy import Origin
from radmpc.importing.formats import import_scenario
from radmpc.io.export.exporting import ExportOptions, export_plan, save_exported
from radmpc.io.native.plan_file import save_plan
from radmpc.planning import plan

PLAN = plan(circle(2), "dlp").require()


def refusal(path: Path) -> str:
    with pytest.raises(FileFormatError) as error:
        import_scenario(path)
    return str(error.value)


@pytest.mark.parametrize("name", ["plan.json", "plan.yaml", "plan"])
def test_a_plan_is_called_one(tmp_path: Path, name: str) -> None:
    path = tmp_path / name
    save_plan(PLAN, tmp_path / "a.json")
    (tmp_path / "a.json").rename(path)
    assert refusal(path) == (
        f"{path}: is a plan, not a problem: 'radmpc verify', 'draw', 'fly' and 'export' read it, "
        "and its scenario stands in it"
    )


@pytest.mark.parametrize(
    ("to", "told"),
    [
        ("qgc", "is a mission for an autopilot, not a problem: a plan's own .json holds "),
        ("waypoints", "is a mission for an autopilot, not a problem: a plan's own .json holds "),
        ("csv", "is a table of a plan or of a log, not a problem: 'radmpc identify' reads logs"),
        ("mcap", "is a log, not a problem: 'radmpc identify' reads logs"),
        ("kml", "must be Points, LineStrings and Polygons only, got a Track: paths of plans are "),
        ("geojson", "is a path of a plan: paths are not imported"),
    ],
)
def test_an_exported_plan_is_told_from_a_problem(tmp_path: Path, to: str, told: str) -> None:
    origin = None if to == "csv" else Origin(54.0, 12.0, 0.0)
    suffix = {"qgc": "plan"}.get(to, to)
    exported = export_plan(PLAN, to, tmp_path / f"out.{suffix}", ExportOptions(origin))
    save_exported(exported)
    for path in exported.files:
        message = refusal(path)
        assert message.startswith(f"{path}:")
        assert told in message
        assert "\n" not in message


def test_a_long_log_is_called_one(tmp_path: Path) -> None:
    path = tmp_path / "a.mcap"
    path.write_bytes(bytes(9 * 2**20))
    assert refusal(path) == f"{path}: is a log, not a problem: 'radmpc identify' reads logs"


def test_a_flight_is_called_one(tmp_path: Path) -> None:
    path = tmp_path / "a.jsonl"
    path.write_text('{"format": "radmpc/flight/1"}\n{"step": 0}\n', encoding="utf-8")
    assert refusal(path) == (
        f"{path}: is a flight, not a problem: 'radmpc verify', 'draw' and 'fly' read it"
    )


@pytest.mark.parametrize("name", ["a.csv", "a.mcap", "a.plan"])
def test_a_problem_is_read_whatever_its_ending(tmp_path: Path, name: str) -> None:
    path = tmp_path / name
    path.write_text(
        "{map: {dimensions: [4, 3], obstacles: [[1, 1]]}, "
        "agents: [{name: a, start: [0, 0], goal: [3, 2]}]}",
        encoding="utf-8",
    )
    assert import_scenario(path).scenario.num_vehicles == 1


def test_a_file_that_is_not_there_is_no_log(tmp_path: Path) -> None:
    path = tmp_path / "a.mcap"
    assert refusal(path) == f"{path}: No such file or directory"
