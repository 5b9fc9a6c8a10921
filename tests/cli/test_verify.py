from __future__ import annotations

import json
from pathlib import Path

import pytest

from radmpc.io.native.scenario_file import load_scenario, save_scenario

from .conftest import Run, assert_one_line

KEYS = ["holds", "bound", "certified", "rate", "rate_low", "rate_high", "samples", "problems"]
KEYS += ["saturation_bound", "saturation_rate", "warnings"]


@pytest.fixture
def plan_file(crossing: Path, crossing_plan: bytes) -> Path:
    """A certified plan."""
    path = crossing.with_name("crossing.plan.json")
    path.write_bytes(crossing_plan)
    return path


def tamper(path: Path, change: str, value: object) -> None:
    """Change one entry of the first vehicle."""
    content = json.loads(path.read_text(encoding="utf-8"))
    content["vehicles"][0][change] = value
    path.write_text(json.dumps(content), encoding="utf-8")


def claim(path: Path, **claims: object) -> None:
    """Change what the plan says about itself."""
    content = json.loads(path.read_text(encoding="utf-8")) | claims
    path.write_text(json.dumps(content), encoding="utf-8")


def test_a_good_plan_holds(run: Run, plan_file: Path) -> None:
    result = run("verify", plan_file, "--samples", 2000)
    assert result.exit_code == 0
    assert "within the bound 0.05" in result.stdout
    assert "2000 samples" in result.stdout
    assert result.stdout.splitlines()[-1].split() == ["the", "plan", "holds"]


def test_a_plan_made_at_steps_is_judged_along_its_path_where_that_is_asked_for(
    run: Run, plan_file: Path
) -> None:
    words = ("verify", plan_file, "--samples", 2000)
    certified = {
        where: json.loads(run(*words, "--json", "--avoidance", where).stdout)["certified"]
        for where in ("steps", "intervals")
    }
    assert certified["steps"] == json.loads(run(*words, "--json").stdout)["certified"]
    assert certified["intervals"] > certified["steps"]
    report = run(*words, "--avoidance", "intervals")
    assert "avoidance along intervals" in report.stdout
    assert "states a certified risk" not in report.stdout
    refused = run(*words, "--avoidance", "always")
    assert refused.exit_code == 2
    line = assert_one_line(refused.stderr)
    assert line == "radmpc: --avoidance must be 'intervals' or 'steps', got 'always'"


@pytest.mark.parametrize("command", ["verify", "export"])
def test_a_scenario_given_for_a_plan_is_called_one_and_how_to_plan_it(
    run: Run, crossing: Path, tmp_path: Path, command: str
) -> None:
    save_scenario(load_scenario(crossing), tmp_path / "same.json")
    for name in ("crossing.yaml", "same.json"):
        more = ("--to", "csv", "-o", "out.csv") if command == "export" else ()
        result = run(command, name, *more)
        assert result.exit_code == 2
        assert assert_one_line(result.stderr) == (
            f"radmpc: {name}: is a scenario, not a plan: plan it first: "
            f"radmpc plan {name} -o {name.partition('.')[0]}.plan.json"
        )


def test_json_has_the_documented_keys_and_nothing_else(run: Run, plan_file: Path) -> None:
    result = run("verify", plan_file, "--samples", 2000, "--json")
    content = json.loads(result.stdout)
    assert list(content) == KEYS
    assert content["holds"] is True
    assert content["bound"] == 0.05
    assert content["samples"] == 2000
    assert content["rate_low"] <= content["rate"] <= content["rate_high"]
    assert content["problems"] == []
    assert result.stderr == ""


def test_the_seed_decides_the_simulation(run: Run, plan_file: Path) -> None:
    words = ("verify", plan_file, "--samples", 500, "--json", "--seed")
    assert run(*words, 1).stdout == run(*words, 1).stdout


def test_changed_controls_do_not_hold(run: Run, plan_file: Path) -> None:
    tamper(plan_file, "controls", [[0.0, 0.0]] * 6)
    result = run("verify", plan_file, "--samples", 500)
    assert result.exit_code == 1
    assert "does not hold" in result.stdout
    assert "east" in result.stdout


def test_arrays_that_do_not_fit_are_a_no_not_a_crash(run: Run, plan_file: Path) -> None:
    tamper(plan_file, "controls", [[0.0, 0.0]] * 5)
    result = run("verify", plan_file, "--json")
    assert result.exit_code in {1, 2}
    if result.exit_code == 1:
        content = json.loads(result.stdout)
        assert content["rate"] is None
        assert content["problems"]
    else:
        assert_one_line(result.stderr)


def test_a_file_without_a_plan_does_not_hold(run: Run, infeasible: Path) -> None:
    run("plan", infeasible, "-o", "none.json")
    result = run("verify", "none.json")
    assert result.exit_code == 1
    assert "cannot reach its goal" in result.stdout
    content = json.loads(run("verify", "none.json", "--json").stdout)
    assert list(content) == KEYS
    assert content["holds"] is False
    assert content["samples"] == 0


@pytest.mark.parametrize("text", ["", "{", "[]", "{}", "format: radmpc/plan/2", "\x00\x01"])
def test_what_is_no_plan_is_one_line(run: Run, tmp_path: Path, text: str) -> None:
    path = tmp_path / "bad.json"
    path.write_text(text, encoding="utf-8")
    result = run("verify", path)
    assert result.exit_code == 2
    assert "bad.json" in assert_one_line(result.stderr)


def test_a_rate_above_the_certificate_speaks_against_both(
    run: Run, plan_file: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    class Alarming:
        samples, rate, rate_low, rate_high = 100, 0.5, 0.4, 0.6
        saturation_rate = 0.3

    monkeypatch.setattr("radmpc.console.commands.verifying.simulate", lambda *a, **k: Alarming())
    result = run("verify", plan_file, "--json")
    assert result.exit_code == 1
    [problem] = json.loads(result.stdout)["problems"]
    assert "collision rate is at least 0.4" in problem
    assert "controls saturate in 30 % of samples" in problem


def test_collisions_are_counted_in_whole_missions(
    run: Run, plan_file: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    class Counted:
        samples, rate, rate_low, rate_high = 100_000, 0.00204, 0.00177, 0.00234
        saturation_rate = 0.0

    monkeypatch.setattr("radmpc.console.commands.verifying.simulate", lambda *a, **k: Counted())
    expected = "204 of 100000 samples collide: 0.00204 (0.00177 to 0.00234 with 95 % confidence)"
    assert expected in run("verify", plan_file).stdout


def test_the_bound_that_counts_is_the_scenarios(run: Run, plan_file: Path) -> None:
    risk = json.loads(plan_file.read_text(encoding="utf-8"))["risk"]
    claim(plan_file, risk=risk | {"bound": 0.4})
    result = run("verify", plan_file, "--samples", 100)
    assert result.exit_code == 1
    assert "within the bound 0.05" in result.stdout
    assert "states a risk bound of 0.4" in result.stdout


@pytest.mark.slow
@pytest.mark.parametrize(
    ("claims", "expected"),
    [
        ({"lower_bound": 1e6}, "lower bound 1000000 is above the cost"),
        ({"lower_bound": None}, "'optimal' without a lower bound"),
        ({"status": "limit"}, "'limit', yet there are trajectories"),
        ({"sets": [["east"]]}, "sets do not hold every vehicle once"),
        ({"vehicles": []}, "'optimal', yet there are no trajectories"),
    ],
)
def test_false_claims_do_not_hold(
    run: Run, plan_file: Path, claims: dict[str, object], expected: str
) -> None:
    claim(plan_file, **claims)
    result = run("verify", plan_file, "--samples", 100)
    assert result.exit_code == 1
    assert expected in result.stdout


def test_too_many_samples_are_refused_before_a_certificate_is_computed(
    run: Run, plan_file: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("radmpc.console.commands.verifying.certify", None)
    result = run("verify", plan_file, "--samples", 2 * 10**9)
    assert (result.exit_code, result.stdout) == (2, "")
    assert "samples must be at most 1000000000, got 2000000000" in result.stderr
