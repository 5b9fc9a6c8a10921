from __future__ import annotations

import csv
import json
from pathlib import Path

import pytest

import radmpc
from radmpc.experiments.sweep_table import SweepTable
from radmpc.experiments.sweeping import sweep_scenarios

from .conftest import Run, assert_one_line

OVER = "risk_bound=0.02,0.05"


def rows_of(path: Path) -> list[dict[str, str]]:
    with open(path, encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


@pytest.mark.slow
def test_a_table_and_a_curve_tell_what_risk_costs(run: Run, crossing: Path) -> None:
    result = run("sweep", crossing, "--over", OVER, "-o", "rows.csv", "--figure", "curve.png")
    assert result.exit_code == 0, result.output
    rows = rows_of(Path("rows.csv"))
    assert [row["risk_bound"] for row in rows] == ["0.02", "0.05"]
    costs = [float(row["cost"]) for row in rows]
    assert costs[0] > costs[1]
    assert all(float(row["certified"]) <= float(row["risk_bound"]) for row in rows)
    assert [line.split()[0] for line in result.stdout.splitlines()[:3]] == [
        "risk_bound", "0.02", "0.05",
    ]  # fmt: skip
    assert result.stdout.splitlines()[-2:] == [
        "table written to rows.csv", "picture written to curve.png",
    ]  # fmt: skip
    assert Path("curve.png").read_bytes().startswith(b"\x89PNG")
    planned = radmpc.plan(radmpc.load_scenario(crossing, {"risk_bound": 0.02}))
    assert costs[0] == pytest.approx(planned.cost, rel=2e-3)


@pytest.mark.slow
def test_what_stands_in_the_table_is_not_planned_again(run: Run, crossing: Path) -> None:
    assert run("sweep", crossing, "--over", OVER, "-o", "rows.csv").exit_code == 0
    whole = Path("rows.csv").read_text(encoding="utf-8")
    lines = whole.splitlines(keepends=True)
    # A kill leaves a row and a half; the first is made another, to be known again.
    marked = lines[1].replace("optimal", "feasible")
    Path("rows.csv").write_text(lines[0] + marked + lines[2][:20], encoding="utf-8")
    result = run("sweep", crossing, "--over", "risk_bound=0.02,0.05,0.1", "-o", "rows.csv")
    assert result.exit_code == 0, result.output
    rows = rows_of(Path("rows.csv"))
    assert [row["risk_bound"] for row in rows] == ["0.02", "0.05", "0.1"]
    assert [row["status"] for row in rows] == ["feasible", "optimal", "optimal"]


def test_a_table_of_something_else_is_left_alone(run: Run, crossing: Path) -> None:
    assert run("sweep", crossing, "--over", "risk_bound=0.05", "-o", "rows.csv").exit_code == 0
    before = Path("rows.csv").read_bytes()
    for words, told in (
        (("--over", "horizon=6"), "is no table of a sweep over these keys"),
        (("--over", "risk_bound=0.05", "--seed", "1"), "was made by 'certified seed=0'"),
    ):
        result = run("sweep", crossing, *words, "-o", "rows.csv")
        assert result.exit_code == 2
        assert told in assert_one_line(result.stderr)
    crossing.write_text(crossing.read_text(encoding="utf-8").replace("0.4", "0.5"), "utf-8")
    result = run("sweep", crossing, "--over", "risk_bound=0.05", "-o", "rows.csv")
    assert result.exit_code == 2
    assert "is of another scenario" in assert_one_line(result.stderr)
    assert Path("rows.csv").read_bytes() == before


def test_a_table_that_another_sweep_writes_is_left_to_it(run: Run, crossing: Path) -> None:
    fcntl = pytest.importorskip("fcntl")
    with open("rows.csv", "wb") as file:
        fcntl.flock(file, fcntl.LOCK_EX)
        result = run("sweep", crossing, "--over", OVER, "-o", "rows.csv")
    assert result.exit_code == 2
    line = assert_one_line(result.stderr)
    assert line == "radmpc: rows.csv: is being written by another sweep"
    assert not Path("rows.csv").read_bytes()


def test_only_a_table_that_was_there_is_left_without_a_row(tmp_path: Path) -> None:
    path = tmp_path / "rows.csv"
    SweepTable(path, ["risk_bound"], ["certified"]).close()
    assert not path.exists()
    path.touch()
    SweepTable(path, ["risk_bound"], ["certified"]).close()
    assert path.exists()


def test_where_there_is_no_plan_the_row_says_why(run: Run, crossing: Path) -> None:
    result = run("sweep", crossing, "--over", "horizon=2,6", "--json")
    assert result.exit_code == 1
    rows = json.loads(result.stdout)["rows"]
    assert [(row["horizon"], row["is_within"]) for row in rows] == [(2, False), (6, True)]
    assert rows[0]["cost"] is None
    assert rows[0]["problem"]


def test_noise_scales_every_standard_deviation(crossing: Path) -> None:
    found = sweep_scenarios(crossing, {"noise": [0.0, 1.0, 2.0], "risk_bound": [0.1]})
    assert list(found) == [("0.0", "0.1"), ("1.0", "0.1"), ("2.0", "0.1")]
    once = found["1.0", "0.1"].vehicles[0]
    for factor in ("0.0", "2.0"):
        vehicle = found[factor, "0.1"].vehicles[0]
        for name in ("initial_covariance", "disturbance_covariance"):
            expected = float(factor) ** 2 * getattr(once, name)
            assert getattr(vehicle, name) == pytest.approx(expected)


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (("--over", "risk_bound"), "--over: must be KEY=VALUE,VALUE,..., got 'risk_bound'"),
        (("--over", "risk_bound=0.1,0.1"), "risk_bound: has 0.1 twice"),
        (("--over", "risk_bound=0.1,2"), "(at risk_bound=2)"),
        (("--over", "noise=-1"), "noise: must be factors >= 0"),
        (("--over", OVER, "--over", OVER), "--over: names 'risk_bound' twice"),
        (("--over", OVER, "--gap", "3"), "--gap must lie between 0 and 1, got 3.0"),
        (("--over", OVER, "--planner", "best"), "best"),
    ],
)
def test_what_cannot_be_swept_is_told_in_one_line(
    run: Run, crossing: Path, words: tuple[str, ...], told: str
) -> None:
    result = run("sweep", crossing, *words)
    assert result.exit_code == 2
    assert told in assert_one_line(result.stderr)


def test_plan_check_and_compare_take_values_in_place_of_the_files(run: Run, crossing: Path) -> None:
    result = run("plan", crossing, "--set", "risk_bound=0.02", "--gap", "0.2", "-o", "plan.json")
    assert result.exit_code == 0, result.output
    assert radmpc.load_plan("plan.json").scenario.risk_bound == 0.02
    assert "other" in run("check", crossing, "--set", "name=other").stdout
    result = run(
        "compare", crossing, "--planners", "certified", "--samples", "10", "--json",
        "--set", "name=other",
    )  # fmt: skip
    assert json.loads(result.stdout)["scenario"] == "other"
