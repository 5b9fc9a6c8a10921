"""Plans that do not fit their own scenario are refused in a line; others are drawn as they are."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from cli.conftest import Run, assert_one_line

PICTURES = [
    *(("--view", view, "-o", "x.svg") for view in ("plan", "distances", "ledger", "risk")),
    ("--view", "couplings", "-o", "x.svg"),
    ("-o", "x.gif"),
]


@pytest.fixture
def plan_file(crossing: Path, crossing_plan: bytes) -> Path:
    """A certified plan of two vehicles."""
    path = crossing.with_name("crossing.plan.json")
    path.write_bytes(crossing_plan)
    return path


def change(path: Path, how: Callable[[dict[str, Any]], object]) -> None:
    """Change what a plan file holds."""
    content = json.loads(path.read_text(encoding="utf-8"))
    how(content)
    path.write_text(json.dumps(content), encoding="utf-8")


def row_with(key: str, value: object) -> Callable[[dict[str, Any]], object]:
    """Put something into the first row of the ledger."""
    return lambda content: content["risk"]["ledger"][0].update({key: value})


def row_less(key: str) -> Callable[[dict[str, Any]], object]:
    """Remove a row of an array of the first vehicle."""
    return lambda content: content["vehicles"][0][key].pop()


@pytest.mark.parametrize("words", PICTURES)
@pytest.mark.parametrize(
    ("how", "what"),
    [
        (lambda content: content["vehicles"].pop(), "vehicle 'west': missing from the plan"),
        (lambda content: content["vehicles"].reverse(), "stand in the order ['west', 'east']"),
        (row_less("controls"), "vehicle 'east': controls have shape (5, 2), must be (6, 2)"),
        (row_less("means"), "vehicle 'east': means have shape (6, 4), must be (7, 4)"),
        (row_less("covariances"), "covariances have shape (6, 4, 4), must be (7, 4, 4)"),
        (row_with("step", 99), "names step 99, the last is 6"),
        (row_with("vehicle", "nobody"), "names vehicle 'nobody', who is not in the scenario"),
    ],
)
def test_a_plan_that_does_not_fit_its_scenario_is_refused_in_a_line(
    run: Run,
    plan_file: Path,
    words: tuple[str, ...],
    how: Callable[[dict[str, Any]], object],
    what: str,
) -> None:
    change(plan_file, how)
    result = run("draw", plan_file, *words)
    assert result.exit_code == 2
    line = assert_one_line(result.stderr)
    assert line.startswith(f"radmpc: {plan_file}: cannot be drawn: ")
    assert what in line
    assert not Path(words[-1]).exists()


@pytest.mark.sampled(2)
@pytest.mark.parametrize("words", PICTURES)
def test_a_plan_that_does_not_hold_is_drawn(
    run: Run, plan_file: Path, words: tuple[str, ...]
) -> None:
    def worsen(content: dict[str, Any]) -> None:
        content["cost"] = 0.5 * content["cost"]
        content["vehicles"][0]["controls"][3][0] += 0.3

    change(plan_file, worsen)
    assert run("verify", plan_file, "--samples", 100).exit_code == 1
    result = run("draw", plan_file, *words)
    assert result.exit_code == 0, result.stderr
    assert Path(words[-1]).stat().st_size > 0


def test_what_there_is_without_a_plan_is_drawn(run: Run, infeasible: Path) -> None:
    run("plan", infeasible, "-o", "none.json")
    result = run("draw", "none.json", "-o", "none.svg")
    assert result.exit_code == 0, result.stderr
    assert Path("none.svg").stat().st_size > 0
