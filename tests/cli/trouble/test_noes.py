"""Whoever reads only stderr and the exit code learns why the answer is no."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import pytest

from cli.conftest import Run, assert_one_line
from radmpc.console.commands import calibrating


def no_line(run: Run, *words: object) -> str:
    """Return the line on stderr beside exit code 1; the same with and without JSON."""
    lines = set()
    for more in ((), ("--json",)):
        result = run(*words, *more)
        assert result.exit_code == 1, result.output
        lines.add(assert_one_line(result.stderr))
    [line] = lines
    return line


@pytest.fixture
def plan_file(tmp_path: Path, crossing_plan: bytes) -> Path:
    """A plan of the crossing that may be changed."""
    path = tmp_path / "crossing.plan.json"
    path.write_bytes(crossing_plan)
    return path


@pytest.mark.parametrize(
    ("change", "told"),
    [
        (lambda c: c["vehicles"][0]["controls"].__setitem__(0, [0, 0]), "does not hold: vehicle"),
        (lambda c: c["scenario"].update(risk_bound=1e-9), "does not hold: "),
    ],
)
def test_verify_says_on_stderr_what_does_not_hold(
    run: Run, plan_file: Path, change: Callable[[dict], None], told: str
) -> None:
    content = json.loads(plan_file.read_text(encoding="utf-8"))
    change(content)
    plan_file.write_text(json.dumps(content), encoding="utf-8")
    line = no_line(run, "verify", "crossing.plan.json", "--samples", 100)
    assert line.startswith("radmpc: crossing.plan.json: the plan ")
    assert told in line


def test_verify_says_on_stderr_by_how_much_a_certificate_exceeds_its_bound(
    run: Run, crossing: Path
) -> None:
    run("plan", crossing, "--planner", "dlp", "-o", "risky.json")
    line = no_line(run, "verify", "risky.json", "--samples", 100)
    assert "risky.json: the certificate " in line
    assert line.endswith(" exceeds the risk bound 0.05")


def test_verify_says_on_stderr_why_a_file_holds_no_plan(run: Run, infeasible: Path) -> None:
    run("plan", infeasible, "-o", "none.json")
    assert "none.json: no plan: Vehicle 'east' cannot" in no_line(run, "verify", "none.json")


def test_verify_says_on_stderr_what_of_a_flight_does_not_hold(run: Run, plan_file: Path) -> None:
    run("fly", plan_file, "--replan", "none", "-o", "a.jsonl")
    flight = Path("a.jsonl")
    text = flight.read_text(encoding="utf-8")
    flight.write_text(text.replace('"excess": 0.0', '"excess": 1.0', 1), encoding="utf-8")
    assert no_line(run, "verify", "a.jsonl") == (
        "radmpc: a.jsonl: the flight does not hold: line 2 of the file is not as it was written "
        "(and 1 more)"
    )


def test_compare_says_on_stderr_that_nobody_has_a_plan(run: Run, infeasible: Path) -> None:
    words = ("compare", infeasible, "--planners", "certified", "--samples", 100)
    line = "radmpc: no planner has a plan that is certified within the risk bound"
    assert no_line(run, *words) == line


def test_sweep_says_on_stderr_how_many_scenarios_lack_a_plan(run: Run, crossing: Path) -> None:
    line = "radmpc: no plan that is certified within the risk bound for 1 of 2 scenarios"
    assert no_line(run, "sweep", crossing, "--over", "horizon=2,6") == line


def test_calibrate_says_on_stderr_that_there_is_no_new_plan(
    run: Run, plan_file: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(calibrating, "_planned", lambda *given: None)
    words = ("calibrate", plan_file, "--with", "model", "--missions", 5)
    line = no_line(run, *words, "-o", "noise.yaml", "--plan", "new.json")
    assert line == "radmpc: no certified plan with that noise"
