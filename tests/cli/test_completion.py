from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest
from typer.testing import CliRunner

from radmpc.cli import app
from radmpc.console.completing import (
    BACKENDS,
    FORMATS,
    LOGS,
    PLANNERS,
    complete_backend,
    complete_format,
    complete_log,
    complete_plan,
    complete_planner,
    complete_planners,
    complete_replan,
    complete_scenario,
)
from radmpc.flying import backends
from radmpc.importing.logs import reading
from radmpc.io.export import exporting
from radmpc.planners.presets import COMPARED, DEFAULT, PRESETS

HEAVY = {"highspy", "matplotlib", "numpy", "pydantic", "scipy", "shapely"}


def completed(line: str, cwd: Path) -> list[str]:
    """Ask as bash does, the cursor at the end of the line."""
    words = line.split(" ")
    environment = {
        **os.environ,
        "_RADMPC_COMPLETE": "complete_bash",
        "COMP_WORDS": line,
        "COMP_CWORD": str(len(words) - 1),
    }
    program = "from radmpc.cli import app; app(prog_name='radmpc')"
    done = subprocess.run(
        [sys.executable, "-c", program],
        cwd=cwd,
        env=environment,
        check=True,
        capture_output=True,
        text=True,
    )
    return done.stdout.split()


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Scenarios, plans, and other things."""
    monkeypatch.chdir(tmp_path)
    for name in ("a.yaml", "b.json", "a.plan.json", "notes.txt", ".hidden.yaml", "sub/c.yml"):
        path = tmp_path / name
        path.parent.mkdir(exist_ok=True)
        path.touch()
    return tmp_path


def test_the_words_completed_are_those_that_commands_take() -> None:
    assert tuple(PRESETS) == PLANNERS
    assert exporting.FORMATS == FORMATS
    assert tuple(backends.BACKENDS) == BACKENDS
    assert (*reading._TABLES, *reading._READERS) == LOGS


def test_help_names_what_is_taken_when_nothing_is_given() -> None:
    said = CliRunner().invoke(app, ["plan", "--help"]).stdout
    assert f"[default: {DEFAULT}]" in said
    said = CliRunner().invoke(app, ["compare", "--help"]).stdout
    assert f"[default:{','.join(COMPARED)}]" in re.sub(r"\s+", "", said)
    assert all(name in CliRunner().invoke(app, ["export", "--help"]).stdout for name in FORMATS)


@pytest.mark.slow
def test_the_shell_completes_commands_and_values(folder: Path) -> None:
    assert completed("radmpc ver", folder) == ["verify"]
    assert completed("radmpc plan a.yaml --planner r", folder) == ["rmpc", "radmpc", "rmpc-rrt"]
    assert completed("radmpc export a.plan.json --to g", folder) == ["geojson"]
    assert completed("radmpc verify ", folder) == ["a.plan.json", "b.json", "sub/"]


def test_completion_and_version_load_nothing_heavy(tmp_path: Path) -> None:
    program = "import sys, radmpc.cli; print(*sys.modules)"
    done = subprocess.run(
        [sys.executable, "-c", program], check=True, capture_output=True, text=True
    )
    assert HEAVY & {name.split(".")[0] for name in done.stdout.split()} == set()


def test_names_are_completed_from_their_beginning() -> None:
    assert complete_planner("m") == ["milp", "multi-vehicle"]
    assert complete_planner("x") == []
    assert complete_format("") == list(FORMATS)
    assert complete_backend("") == list(BACKENDS)
    assert complete_replan("no") == ["none"]
    assert complete_replan("") == [*PLANNERS, "none"]


def test_of_a_list_the_last_name_is_completed_and_none_twice() -> None:
    assert complete_planners("ira,r") == ["ira,rmpc", "ira,radmpc", "ira,rmpc-rrt"]
    assert complete_planners("radmpc,ra") == []
    assert complete_planners("cert") == ["certified"]


def test_scenarios_and_plans_are_told_apart_by_their_ends(folder: Path) -> None:
    assert complete_scenario("") == ["a.yaml", "b.json", "sub/"]
    assert complete_plan("") == ["a.plan.json", "b.json", "sub/"]
    assert complete_log("") == ["notes.txt", "sub/"]
    assert complete_scenario("a") == ["a.yaml"]
    assert complete_scenario(".h") == [".hidden.yaml"]


def test_a_folder_that_is_the_only_answer_is_entered(folder: Path) -> None:
    assert complete_scenario("su") == ["sub/c.yml"]
    assert complete_scenario(f"{folder}/sub/") == [f"{folder}/sub/c.yml"]


def test_a_folder_that_is_not_there_completes_to_nothing(folder: Path) -> None:
    assert complete_scenario("nowhere/") == []


def test_the_script_for_a_shell_can_be_shown() -> None:
    environment = {**os.environ, "_TYPER_COMPLETE_TEST_DISABLE_SHELL_DETECTION": "1"}
    done = subprocess.run(
        [sys.executable, "-m", "radmpc", "--show-completion", "bash"],
        env=environment,
        check=True,
        capture_output=True,
        text=True,
    )
    assert "complete -o default -F" in done.stdout
