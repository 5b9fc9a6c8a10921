from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from radmpc.console.commands import calibrating
from radmpc.io.native.plan_file import save_plan
from radmpc.io.native.scenario_file import load_scenario
from radmpc.model.scenario import Scenario
from radmpc.planning import plan
from radmpc.result import Result

from .conftest import CROSSING, Run, assert_one_line

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def plan_text(tmp_path_factory: pytest.TempPathFactory) -> str:
    """Return a plan along intervals."""
    folder = tmp_path_factory.mktemp("planned")
    scenario = folder / "crossing.yaml"
    scenario.write_text(CROSSING.replace("steps", "intervals"), encoding="utf-8")
    save_plan(plan(load_scenario(scenario), rng=0).require(), folder / "plan.json")
    return (folder / "plan.json").read_text(encoding="utf-8")


@pytest.fixture
def planned(plan_text: str, tmp_path: Path) -> Path:
    """Return the folder of that plan."""
    (tmp_path / "plan.json").write_text(plan_text, encoding="utf-8")
    return tmp_path


def test_the_model_is_found_to_be_what_it_is_planned_for(run: Run, planned: Path) -> None:
    words = ("calibrate", "plan.json", "--with", "model", "--missions", "8", "-o", "new.yaml")
    result = run(*words, "--plan", "new.json", "--json")
    assert result.exit_code == 0, result.output
    told = json.loads(result.stdout)
    assert told["before"]["holds"]
    assert told["before"]["doubted"] <= 1
    assert told["after"]["certified"] <= 0.05
    assert told["identified"]["evidence"] == "commands"
    assert told["covers"][0]["vehicles"] == ["east", "west"]
    assert [loop["differs"] for loop in told["loops"]] == [False, False]
    W = np.diag(load_scenario(planned / "new.yaml").vehicles[0].disturbance_covariance)
    assert np.all((W > [5e-4, 5e-4, 5e-5, 5e-5]) & (W < [4e-3, 4e-3, 4e-4, 4e-4]))
    assert (planned / "new.json").exists()


def test_a_report_says_what_was_flown_and_written(run: Run, planned: Path) -> None:
    result = run("calibrate", "plan.json", "--with", "model", "--missions", "6", "-o", "new.yaml")
    assert result.exit_code == 0, result.output
    for words in (
        "6 missions: 2 vehicles, 72 steps of 1 s",
        "of 6 missions collided",
        "; certified 0.0",
        "written to new.yaml",
    ):
        assert words in result.stdout, words


@pytest.mark.parametrize(
    ("words", "line"),
    [
        (("--with", "kite"), "backend must be one of model, "),
        (("--with", "model", "--option", "wind"), "--option must be KEY=VALUE, every key once"),
        (("--with", "model", "--option", "wind=1"), "takes no option 'wind', got '1'"),
        (("--with", "model", "--option", "rng=1"), "takes no option 'rng', got '1'; it takes none"),
        (("--with", "boat"), "plan.json: vehicles[0].radius: must be at least 1.14 m to be flown"),
    ],
)
def test_what_cannot_be_flown_with_is_told_in_one_line(
    run: Run, planned: Path, words: tuple[str, ...], line: str
) -> None:
    result = run("calibrate", "plan.json", *words, "-o", "new.yaml")
    assert result.exit_code == 2
    assert line in assert_one_line(result.stderr)
    assert not (planned / "new.yaml").exists()


def test_the_plan_itself_is_not_written_over(run: Run, planned: Path) -> None:
    before = (planned / "plan.json").read_text(encoding="utf-8")
    result = run("calibrate", "plan.json", "--with", "model", "-o", "plan.json")
    assert result.exit_code == 2
    assert (planned / "plan.json").read_text(encoding="utf-8") == before


def test_why_there_is_no_plan_with_the_noise_that_was_found_is_told(
    run: Run, planned: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def hurried(scenario: Scenario, rng: int) -> Result:
        return plan(replace(scenario, horizon=2), rng=rng)

    monkeypatch.setattr(calibrating, "make_plan", hurried)
    words = ("calibrate", "plan.json", "--with", "model", "--missions", "4", "-o", "new.yaml")
    result = run(*words, "--plan", "new.json")
    assert result.exit_code == 1
    said = " ".join(result.stdout.split())
    assert "no certified plan with that noise: Vehicle 'east' cannot reach its goal" in said
    assert_one_line(result.stderr)
    told = json.loads(run(*words, "--plan", "new.json", "--json").stdout)
    assert told["problem"].startswith("Vehicle 'east' cannot reach its goal")
    assert (told["plan"], told["after"]) == (None, None)
    assert json.loads(run(*words, "--json").stdout)["problem"] is None
