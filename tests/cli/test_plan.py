from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import pytest

from radmpc.model.plan import Plan
from radmpc.planning import plan
from radmpc.referee import Certificate
from radmpc.result import Result

from .conftest import CROSSING, Run, assert_one_line


def test_a_certified_plan_is_reported_with_exit_code_zero(run: Run, crossing: Path) -> None:
    result = run("plan", crossing)
    assert result.exit_code == 0, result.stderr
    for word in ("crossing: 2 vehicles", "status", "cost", "within the bound 0.05", "seconds"):
        assert word in result.stdout
    assert "where the risk goes" in result.stdout
    assert "certified: optimal, branch, certified" in result.stdout
    assert result.stderr == ""


def test_nothing_is_written_unless_asked_for(run: Run, crossing: Path) -> None:
    run("plan", crossing)
    assert [path.name for path in crossing.parent.iterdir()] == ["crossing.yaml"]


def test_plan_and_picture_go_where_they_are_told(run: Run, crossing: Path) -> None:
    result = run("plan", crossing, "-o", "a.json", "--figure", "a.svg")
    assert result.exit_code == 0
    assert "plan written to a.json" in result.stdout
    content = json.loads(Path("a.json").read_text(encoding="utf-8"))
    assert content["format"] == "radmpc/plan/1"
    assert [vehicle["name"] for vehicle in content["vehicles"]] == ["east", "west"]
    assert Path("a.svg").read_text(encoding="utf-8").startswith("<?xml")


def test_the_risk_ledger_is_drawn_where_it_is_told(run: Run, crossing: Path) -> None:
    result = run("plan", crossing, "--ledger", "risk.svg")
    assert result.exit_code == 0
    assert "risk ledger written to risk.svg" in result.stdout
    assert Path("risk.svg").read_text(encoding="utf-8").startswith("<?xml")


def test_a_ledger_without_a_plan_is_still_drawn(run: Run, infeasible: Path) -> None:
    assert run("plan", infeasible, "--ledger", "risk.png").exit_code == 1
    assert Path("risk.png").exists()


@pytest.mark.parametrize("words", [(), ("--json",)])
def test_ctrl_c_while_filming_leaves_report_and_plan(
    run: Run, crossing: Path, monkeypatch: pytest.MonkeyPatch, words: tuple[str, ...]
) -> None:
    def interrupt(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("radmpc.console.commands.plan_command.write_film", interrupt)
    result = run("plan", crossing, "-o", "a.json", "--animation", "a.gif", *words)
    assert (result.exit_code, result.stderr) == (1, "radmpc: interrupted\n")
    assert "certified" in result.stdout
    assert "film written" not in result.stdout
    assert Path("a.json").exists()


@pytest.mark.slow
def test_files_are_told_below_the_report_after_one_empty_line(run: Run, crossing: Path) -> None:
    lines = run("plan", crossing, "--figure", "a.svg", "--ledger", "b.svg").stdout.splitlines()
    assert lines[-3:] == ["", "picture written to a.svg", "risk ledger written to b.svg"]


def test_json_is_the_plan_without_vehicles_and_nothing_else(run: Run, crossing: Path) -> None:
    result = run("plan", crossing, "--json", "-o", "a.json")
    content = json.loads(result.stdout)
    written = json.loads(Path("a.json").read_text(encoding="utf-8"))
    del written["vehicles"]
    assert content == written
    assert content["status"] in {"optimal", "feasible"}
    assert result.stderr == ""


def test_the_same_seed_gives_the_same_plan(run: Run, crossing: Path) -> None:
    plans = []
    for name in ("a.json", "b.json"):
        assert run("plan", crossing, "--seed", 3, "-o", name).exit_code == 0
        plans.append(json.loads(Path(name).read_text(encoding="utf-8")))
    assert plans[0]["seed"] == 3
    assert plans[0]["vehicles"] == plans[1]["vehicles"]


def test_a_certificate_above_the_bound_is_said_plainly(run: Run, crossing: Path) -> None:
    result = run("plan", crossing, "--planner", "dlp", "-o", "a.json")
    assert result.exit_code == 1
    assert "EXCEEDS the bound 0.05" in result.stdout
    assert "exceeds the risk bound 0.05" in assert_one_line(result.stderr)
    content = json.loads(Path("a.json").read_text(encoding="utf-8"))
    assert content["risk"]["certified"] > 0.05
    assert len(content["vehicles"]) == 2


def test_without_a_report_the_reason_stands_on_stderr(run: Run, infeasible: Path) -> None:
    result = run("plan", infeasible, "--json")
    assert result.exit_code == 1
    assert "cannot reach its goal" in json.loads(result.stdout)["explanation"]
    assert "cannot reach its goal" in assert_one_line(result.stderr)


def test_without_a_plan_a_result_is_written(run: Run, infeasible: Path, crossing: Path) -> None:
    words = ("--planner", "dlp", "--time-limit", "1e-9")
    for scenario, more in ((infeasible, ()), (crossing, words)):
        result = run("plan", scenario, "-o", "a.json", *more)
        assert result.exit_code == 1
        assert result.stdout.splitlines()[-2:] == ["", "result written to a.json"]
        assert "plan written" not in result.stdout
        assert json.loads(Path("a.json").read_text(encoding="utf-8"))["vehicles"] == []


def test_without_a_plan_the_reason_is_given(run: Run, infeasible: Path) -> None:
    result = run("plan", infeasible, "-o", "a.json", "--figure", "a.png")
    assert result.exit_code == 1
    assert "east" in result.stdout
    assert "cannot reach its goal" in result.stdout
    line = assert_one_line(result.stderr)
    assert line == "radmpc: no plan (infeasible): the report says why"
    content = json.loads(Path("a.json").read_text(encoding="utf-8"))
    assert content["vehicles"] == []
    assert content["cost"] is None
    assert content["explanation"]
    assert Path("a.png").exists()


def test_a_limit_without_a_plan_is_told_in_few_words(run: Run, crossing: Path) -> None:
    result = run("plan", crossing, "--time-limit", 0)
    assert result.exit_code == 1
    line = assert_one_line(result.stderr)
    assert (result.stdout + line).count("before any plan") <= 2


def test_a_run_cut_short_without_a_plan_leaves_that_of_an_earlier_one(
    run: Run, crossing: Path
) -> None:
    assert run("plan", crossing, "-o", "a.json").exit_code == 0
    before = Path("a.json").read_bytes()
    result = run("plan", crossing, "--time-limit", 0, "-o", "a.json")
    assert (result.exit_code, Path("a.json").read_bytes()) == (1, before)
    assert "a.json kept: it holds a plan of this scenario" in result.stdout
    assert "written" not in result.stdout


def test_what_is_no_plan_of_the_same_scenario_is_replaced(run: Run, crossing: Path) -> None:
    run("plan", crossing, "-o", "a.json")
    for words in (("--time-limit", 0, "--set", "risk_bound=0.01"), ("--set", "horizon=1")):
        assert run("plan", crossing, *words, "-o", "a.json").exit_code == 1
        assert json.loads(Path("a.json").read_text(encoding="utf-8"))["vehicles"] == []


def test_json_without_a_plan_is_still_one_object(run: Run, infeasible: Path) -> None:
    result = run("plan", infeasible, "--json")
    assert result.exit_code == 1
    assert json.loads(result.stdout)["status"] == "infeasible"
    assert_one_line(result.stderr)


def test_a_planner_may_carry_a_number(run: Run, crossing: Path) -> None:
    result = run("plan", crossing, "--planner", "multi-vehicle(0.5)", "--json")
    assert "couplings(0.5)" in json.loads(result.stdout)["planner"]


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        (["--planner", "best"], "planner must be one of milp"),
        (["--planner", "ira(3)"], "takes no argument"),
        (["--seed", "x"], "--seed"),
        (["--jobs", "0"], "--jobs"),
        (["--time-limit", "-1"], "--time-limit"),
        (["--figure", "a.bmp"], "a.bmp: a figure must end in"),
        (["--figure", "no/a.png"], "cannot write no/a.png: no: No such file or directory"),
        (["--ledger", "a.txt"], "a.txt: a figure must end in"),
        (["-o", "no/a.json"], "cannot write no/a.json: no: No such file or directory"),
        (["-o", "."], "cannot write .: Is a directory"),
        (["--hue"], "No such option: --hue"),
    ],
)
def test_bad_usage_is_one_line_and_exit_code_two(
    run: Run, crossing: Path, words: list[str], expected: str
) -> None:
    result = run("plan", crossing, *words)
    assert result.exit_code == 2
    assert expected in assert_one_line(result.stderr)
    assert result.stdout == ""


def test_bad_usage_is_noticed_before_any_planning(
    run: Run, crossing: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def never(*args: object, **kwargs: object) -> None:
        pytest.fail("planned although the output cannot be written")

    monkeypatch.setattr("radmpc.console.commands.plan_command.plan", never)
    assert run("plan", crossing, "-o", "no/a.json").exit_code == 2


def test_a_missing_scenario_is_one_line(run: Run) -> None:
    result = run("plan", "nowhere.yaml")
    assert result.exit_code == 2
    assert "nowhere.yaml" in assert_one_line(result.stderr)


def test_a_defect_is_one_line_and_exit_code_three(
    run: Run, crossing: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def broken(*args: object, **kwargs: object) -> None:
        raise ZeroDivisionError("a\nb")

    monkeypatch.setattr("radmpc.console.commands.plan_command.plan", broken)
    result = run("plan", crossing)
    assert result.exit_code == 3
    assert "internal error: ZeroDivisionError: a b" in assert_one_line(result.stderr)


@pytest.mark.parametrize("place", ["first", "last"])
def test_debug_shows_the_traceback_wherever_it_stands(
    run: Run, crossing: Path, monkeypatch: pytest.MonkeyPatch, place: str
) -> None:
    def broken(*args: object, **kwargs: object) -> None:
        raise ZeroDivisionError

    monkeypatch.setattr("radmpc.console.commands.plan_command.plan", broken)
    words = ["plan", str(crossing)]
    words.insert(0 if place == "first" else 2, "--debug")
    result = run(*words)
    assert result.exit_code == 3
    assert "Traceback" in result.stderr


def test_brackets_in_names_are_no_markup(run: Run, tmp_path: Path) -> None:
    path = tmp_path / "odd.yaml"
    path.write_text(CROSSING.replace("name: east", 'name: "[red]east[/]"'), encoding="utf-8")
    result = run("plan", path)
    assert result.exit_code == 0
    assert "[red]east[/]" in result.stdout


@pytest.mark.slow
def test_processes_change_nothing(run: Run, tmp_path: Path) -> None:
    apart = tmp_path / "apart.yaml"
    text = CROSSING.replace("[9, 5.2]", "[9, 10]").replace("[1, 5.2]", "[1, 10]")
    apart.write_text(text, encoding="utf-8")
    plans = []
    for jobs in (1, 2):
        assert run("plan", apart, "--jobs", jobs, "-o", f"{jobs}.json").exit_code == 0
        plans.append(json.loads(Path(f"{jobs}.json").read_text(encoding="utf-8")))
    assert len(plans[0]["sets"]) == 2
    assert plans[0]["vehicles"] == plans[1]["vehicles"]


def test_the_plan_written_is_the_plan_found(
    run: Run, crossing: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    kept: list[Plan] = []
    monkeypatch.setattr(
        "radmpc.console.commands.plan_command.save_plan",
        lambda plan, path: kept.append((plan, path)),
    )
    run("plan", crossing, "-o", "a.json")
    ((plan, path),) = kept
    assert path == Path("a.json")
    assert plan.scenario.name == "crossing"


def test_a_plan_the_referee_finds_fault_with_is_a_no(
    run: Run, crossing: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def faulty(*args: object, **kwargs: object) -> Result:
        result = plan(*args, **kwargs)
        return replace(result, certificate=Certificate(0.05, 0.01, (), ("goal missed",)))

    monkeypatch.setattr("radmpc.console.commands.plan_command.plan", faulty)
    result = run("plan", crossing)
    assert result.exit_code == 1
    assert "the plan is not certified: goal missed" in assert_one_line(result.stderr)


@pytest.mark.slow
def test_verbose_tells_the_stages_on_stderr_and_nothing_else_does(run, crossing):
    told = run("plan", crossing, "-v")
    assert told.exit_code == 0
    assert "of risk bound 0.05" in told.stderr
    assert "1 % of the risk bound at a price of" in told.stderr
    assert "gap 0" in told.stderr
    assert run("plan", crossing).stderr == ""
    assert "iteration 1" in run("plan", crossing, "-v", "--planner", "multi-vehicle").stderr
