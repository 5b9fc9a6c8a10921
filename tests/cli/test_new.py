from __future__ import annotations

from pathlib import Path

import pytest

import radmpc
from radmpc.data import TEMPLATES
from radmpc.preflight import concerns_of, outlook_of

from .conftest import Run, assert_one_line


@pytest.mark.parametrize("kind", TEMPLATES)
def test_a_template_is_a_scenario_that_nothing_is_said_against(run: Run, kind: str) -> None:
    result = run("new", kind, "-o", "mine.yaml")
    assert result.exit_code == 0, result.output
    scenario = radmpc.load_scenario("mine.yaml")
    assert scenario.name == kind
    assert concerns_of(outlook_of(scenario)) == ()
    text = Path("mine.yaml").read_text(encoding="utf-8")
    assert sum("#" in line for line in text.splitlines()) > 10


@pytest.mark.slow
@pytest.mark.sampled(1)
@pytest.mark.parametrize("kind", TEMPLATES)
def test_a_template_is_planned_within_its_bound(run: Run, kind: str) -> None:
    run("new", kind, "-o", "mine.yaml")
    result = run("plan", "mine.yaml", "--gap", "0.5", "-o", "plan.json")
    assert result.exit_code == 0, result.output
    risk = radmpc.load_plan("plan.json").risk
    assert risk.saturation is not None
    assert risk.saturation < 0.1 * risk.bound


def test_without_a_file_the_template_is_shown(run: Run) -> None:
    shown = run("new", "drones")
    assert shown.stdout.startswith("# Four drones")
    assert run("new").stdout == run("new", TEMPLATES[0]).stdout


def test_a_file_that_is_there_stays(run: Run) -> None:
    Path("mine.yaml").write_text("mine", encoding="utf-8")
    result = run("new", "-o", "mine.yaml")
    assert result.exit_code == 2
    assert "it is there already" in assert_one_line(result.stderr)
    assert Path("mine.yaml").read_text(encoding="utf-8") == "mine"


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (("rockets",), "KIND must be one of boats, drones, warehouse, got 'rockets'"),
        (("boats", "-o", "mine.json"), "a template must end in .yaml or .yml"),
        (("boats", "-o", "none/mine.yaml"), "No such file or directory"),
    ],
)
def test_what_cannot_be_written_is_told_in_one_line(
    run: Run, words: tuple[str, ...], told: str
) -> None:
    result = run("new", *words)
    assert result.exit_code == 2
    assert told in assert_one_line(result.stderr)
