"""What `radmpc check` prints of a valid scenario."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from radmpc.console.commands import check as command
from radmpc.console.files import demo_text
from radmpc.console.reports import progress
from radmpc.console.reports.progress import progress_text
from radmpc.data import template
from radmpc.io.native.scenario_file import load_scenario
from radmpc.preflight import concerns_of

from .conftest import CROSSING, Run

SCENES = Path(__file__).parent.parent / "data" / "scenes"


def test_a_table_tells_what_each_vehicle_meets(run: Run, crossing: Path) -> None:
    result = run("check", crossing)
    assert result.exit_code == 0
    lines = result.stdout.splitlines()
    assert lines[0].startswith("valid: crossing")
    head, east, west = lines[-3:]
    for word in ("least time", "kept back", "saturates", "at the end", "start risk", "narrowest"):
        assert word in head
    assert east.split()[:5] == ["east", "5", "of", "6", "steps"]
    assert east[head.index("at the end") :].startswith("0.127 m")
    assert east.endswith("wide")
    assert west.startswith("west")


def test_warnings_stand_before_the_table_and_do_not_change_the_exit_code(run: Run) -> None:
    result = run("check", SCENES / "goal-too-near-fleet.yaml")
    assert result.exit_code == 0
    lines = result.stdout.splitlines()
    assert lines[1].startswith("no plan: The goal of vehicle 'usv4'")
    assert lines[2].startswith("warning: Vehicles 'usv1'")
    assert lines.index("") < next(i for i, line in enumerate(lines) if "least time" in line)
    assert lines[-3].split()[-5:] == ["1.5", "m,", "2", "std:", "mole"]


def test_the_table_tells_of_goals_that_are_due_before_the_horizon(run: Run, crossing: Path) -> None:
    on_time = run("check", crossing).stdout
    assert "due at" not in on_time
    horizon, name = load_scenario(crossing).horizon, load_scenario(crossing).vehicles[0].name
    window = f"vehicles.{name}.goal.within=[1,{horizon - 1}]"
    early = run("check", crossing, "--set", window).stdout
    assert f" of {horizon} steps, due at {horizon - 1} " in early


def test_a_terminal_that_is_too_narrow_gets_a_block_per_vehicle(
    run: Run, crossing: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(command, "width", lambda: 60)
    result = run("check", crossing)
    lines = result.stdout.splitlines()
    assert "east" in lines
    assert "  least time       5 of 6 steps" in lines
    assert max(len(line) for line in lines[1:]) <= 60


def test_the_same_is_printed_as_json(run: Run) -> None:
    result = run("check", SCENES / "goal-too-near-fleet.yaml", "--json")
    assert result.exit_code == 0
    told = json.loads(result.stdout)
    assert told["valid"] is True
    assert told["least_risk"] == pytest.approx(0.02555, rel=1e-3)
    first = told["warnings"][0]
    assert (first["kind"], first["vehicles"], first["rules_out"]) == ("endpoint", ["usv4"], True)
    usv4 = told["vehicles"][3]
    assert usv4["least_steps_with_feedback"] == 19
    assert usv4["kept_back"]["kept"] == pytest.approx(0.0753, abs=1e-4)
    assert usv4["narrowest"]["beside"] == ["mole"]
    assert usv4["goal_risk"] == told["endpoints"][0]["risk"]
    assert told["endpoints"][0]["members"] == ["usv4"]


def test_what_cannot_be_told_is_said_to_be_unknown(run: Run, tmp_path: Path) -> None:
    path = tmp_path / "late.yaml"
    path.write_text(CROSSING.replace("horizon: 6", "horizon: 2"), encoding="utf-8")
    result = run("check", path)
    assert result.exit_code == 0
    assert result.stdout.count("5 steps away at least, horizon 2 steps (2 s)") == 2
    *_, west, _, note = result.stdout.splitlines()
    assert west.endswith("?")
    assert note == "?: no path to the goal is known that the vehicle can fly in time"
    told = json.loads(run("check", path, "--json").stdout)
    assert told["vehicles"][0]["saturation"] is None
    assert told["vehicles"][0]["narrowest"]["found"] == "unknown"


def test_what_is_not_computed_in_space_is_said_not_to_be(
    run: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "drones.yaml"
    path.write_text(template("drones"), encoding="utf-8")
    for columns in (200, 60):
        monkeypatch.setattr(command, "width", lambda columns=columns: columns)
        result = run("check", path)
        assert "?" not in result.stdout
        assert result.stdout.count("not computed") == 3
        assert result.stdout.splitlines()[-1].startswith("not computed: what the vehicle can reach")
    places = [v["narrowest"] for v in json.loads(run("check", path, "--json").stdout)["vehicles"]]
    assert [place["found"] for place in places] == ["unknown", "wide", "wide", "unknown"]
    assert [place["why"] for place in places] == ["too large", None, None, "too large"]
    assert places[0]["clearance"] is None


def test_the_shipped_scenario_has_nothing_to_warn_of(run: Run, tmp_path: Path) -> None:
    path = tmp_path / "harbor.yaml"
    path.write_text(demo_text(), encoding="utf-8")
    assert json.loads(run("check", path, "--json").stdout)["warnings"] == []


def test_an_error_in_a_file_is_no_json(run: Run, tmp_path: Path) -> None:
    path = tmp_path / "bad.yaml"
    shutil.copy(SCENES / "goal-too-near.yaml", path)
    path.write_text(path.read_text("utf-8").replace("dt: 5.0", "dt: -5"), encoding="utf-8")
    result = run("check", path, "--json")
    assert result.exit_code == 2
    assert result.stdout == ""


def test_a_check_tells_on_a_terminal_what_it_looks_at(
    run: Run, crossing: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    told: list[str] = []

    @contextmanager
    def noted() -> Iterator[Callable[..., None]]:
        yield lambda stage, done, total: told.append(progress_text(stage, done, total))

    monkeypatch.setattr(progress, "progress_line", noted)
    quiet = run("check", crossing)
    assert told == []
    assert quiet.stderr == ""
    outlook, concerns = command._watched(load_scenario(crossing))
    assert told == [
        "looking at vehicles 0/2",
        "looking at vehicles 1/2",
        "looked at vehicles, trying what helps 2/2",
    ]
    assert [seen.name for seen in outlook.vehicles] == ["east", "west"]
    assert concerns == concerns_of(outlook)


def test_the_table_tells_tiny_risks_where_the_bound_is_tiny_too(run: Run, tmp_path: Path) -> None:
    near = CROSSING.replace("min: [4.5, 7.0], max: [5.5, 8.0]", "min: [8.5, 6.2], max: [9.5, 7.0]")
    (tmp_path / "near.yaml").write_text(near, encoding="utf-8")
    for bound, tells in (("1e-300", True), ("0.05", False)):
        words = ("check", "near.yaml", "--set", f"risk_bound={bound}")
        risk = json.loads(run(*words, "--json").stdout)["vehicles"][0]["goal_risk"]
        assert risk < 1e-12
        report = run(*words).stdout
        head, east, _ = report.splitlines()[-3:]
        assert east[head.index("goal risk") :].split()[0] == (f"{risk:.2g}" if tells else "-")
        assert ("runs a risk of" in report) == tells
