"""Misspelled planners, and files that are something else: the line says what was meant."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from cli.conftest import Run, assert_one_line


def refused(run: Run, *words: object) -> str:
    """Return the line of a command that refuses what it was given."""
    result = run(*words)
    assert result.exit_code == 2
    return assert_one_line(result.stderr)


@pytest.mark.parametrize(
    ("words", "option"),
    [
        (("plan", "--planner", "certifed"), "--planner"),
        (("sweep", "--over", "risk_bound=0.1", "--planner", "certifed"), "--planner"),
        (("compare", "--planners", "dlp,certifed"), "--planners"),
    ],
)
def test_a_misspelled_planner_is_told_with_its_option_and_the_nearest_name(
    run: Run, crossing: Path, words: tuple[str, ...], option: str
) -> None:
    line = refused(run, words[0], crossing, *words[1:])
    assert line.startswith(f"radmpc: {option}: planner must be one of milp, ")
    assert line.endswith("got 'certifed'; did you mean 'certified'?")


def test_a_name_that_resembles_none_has_no_guess(run: Run, crossing: Path) -> None:
    assert refused(run, "plan", crossing, "--planner", "xyzzy").endswith("got 'xyzzy'")


def test_a_guess_at_a_command_ends_in_a_question_before_the_way_to_help(run: Run) -> None:
    line = refused(run, "plna")
    assert re.search(r"'plna'\. Did you mean 'plan'\? See '[a-z]+ --help'$", line), line
    assert re.search(r"No such command 'xyzzy'; see '[a-z]+ --help'$", refused(run, "xyzzy"))


@pytest.fixture
def others(tmp_path: Path, crossing_plan: bytes, run: Run) -> Path:
    """A folder with a plan and its flight."""
    (tmp_path / "a.plan.json").write_bytes(crossing_plan)
    run("fly", "a.plan.json", "--replan", "none", "-o", "a.flight.jsonl")
    return tmp_path


@pytest.mark.usefixtures("others")
def test_a_plan_or_a_flight_where_a_scenario_is_wanted_is_called_one(run: Run) -> None:
    for command in ("plan", "compare", "check"):
        assert refused(run, command, "a.plan.json") == (
            "radmpc: a.plan.json: is a plan, not a scenario: give the scenario that was planned"
        )
        assert refused(run, command, "a.flight.jsonl") == (
            "radmpc: a.flight.jsonl: is a flight, not a scenario: "
            "give the scenario that was planned"
        )
    told = refused(run, "sweep", "a.plan.json", "--over", "risk_bound=0.1")
    assert "is a plan, not a scenario" in told


def test_a_text_that_is_no_problem_is_of_no_known_format(run: Run, tmp_path: Path) -> None:
    text = "# Read me\n\nA key: a value: another\n"
    for name, told in (("README.md", "is of no format known here (dynobench, "),
                       ("broken.yaml", ":3: not valid YAML: ")):  # fmt: skip
        (tmp_path / name).write_text(text, encoding="utf-8")
        assert told in refused(run, "import", name, "-o", "a.yaml")
