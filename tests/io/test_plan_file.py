from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from comparing import differences
from radmpc.errors import FileFormatError, ScenarioError
from radmpc.io.native.plan_file import encode_plan, load_plan, save_plan
from radmpc.io.native.scenario_file import decode_scenario
from radmpc.model.dynamics import rollout
from radmpc.model.plan import FirstPlan, LedgerRow, Plan, Risk, Status, Trajectory

Content = dict[str, Any]


@pytest.fixture
def plan() -> Plan:
    """Two vehicles, three steps."""
    entry = {"goal": {"center": [9, 9], "half_width": 9, "speed": None}}
    scenario = decode_scenario(
        {
            "format": "radmpc/scenario/1",
            "name": "two",
            "dt": 1.0,
            "horizon": 3,
            "risk_bound": 0.05,
            "defaults": {
                "radius": 0.4,
                "control_limit": 2.0,
                "disturbance_covariance": 0.001,
                "feedback": {"gain": [[-0.3, 0, -0.9, 0], [0, -0.3, 0, -0.9]]},
            },
            "vehicles": [
                {"name": "a", "start": [1, 2], **entry},
                {"name": "b", "start": [9, 2], **entry},
            ],
        }
    )
    controls = np.array([[0.1, 1.0 / 3.0], [-0.0, 0.0], [1e-17, -1.5]])
    return Plan(
        scenario=scenario,
        planner="ira, branch, couplings(1e-06)",
        seed=7,
        status=Status.FEASIBLE,
        cost=2.0 * float(np.abs(controls).sum()),
        lower_bound=None,
        risk=Risk(0.05, 0.01, (LedgerRow("pair", "a", "b", 2, 0.01),)),
        sets=(("a",), ("b",)),
        seconds={"total": 0.1},
        versions={"radmpc": "0"},
        trajectories=tuple(
            Trajectory(
                v.name, controls, rollout(v.system, v.start, controls), v.covariances(3), v.gain
            )
            for v in scenario.vehicles
        ),
    )


@pytest.fixture
def edited(plan: Plan, tmp_path: Path) -> Callable[[Callable[[Content], object]], Path]:
    """Write the plan with its content changed."""

    def write(change: Callable[[Content], object]) -> Path:
        content = encode_plan(plan)
        change(content)
        path = tmp_path / "plan.json"
        path.write_text(json.dumps(content, indent=1), encoding="utf-8")
        return path

    return write


def test_a_plan_reads_back_equal(plan: Plan, tmp_path: Path) -> None:
    save_plan(plan, tmp_path / "plan.json")
    assert differences(load_plan(tmp_path / "plan.json"), plan) == []


def test_the_limit_that_ended_a_search_is_kept(plan: Plan, tmp_path: Path) -> None:
    stopped = replace(plan, stopped_by="the time limit of 2 s was reached")
    save_plan(stopped, tmp_path / "plan.json")
    assert load_plan(tmp_path / "plan.json").stopped_by == "the time limit of 2 s was reached"
    assert encode_plan(stopped, with_vehicles=False)["stopped_by"] == stopped.stopped_by
    assert encode_plan(plan)["stopped_by"] is None


def test_no_plan_is_written_as_no_vehicles_and_no_cost(plan: Plan, tmp_path: Path) -> None:
    none = replace(
        plan,
        status=Status.INFEASIBLE,
        cost=None,
        risk=Risk(0.05),
        explanation="the goals of 'a' and 'b' are too close",
        trajectories=(),
    )
    save_plan(none, tmp_path / "none.json")
    content = json.loads((tmp_path / "none.json").read_text(encoding="utf-8"))
    assert (content["vehicles"], content["cost"], content["status"]) == ([], None, "infeasible")
    assert content["risk"] == {"bound": 0.05, "certified": None, "ledger": []}
    assert differences(load_plan(tmp_path / "none.json"), none) == []


def test_the_content_stands_in_the_documented_order(plan: Plan) -> None:
    assert list(encode_plan(plan)) == [
        "format", "scenario", "planner", "seed", "status", "cost", "lower_bound",
        "certified_lower_bound", "risk", "sets",
            "couplings", "seconds", "versions", "explanation", "stopped_by", "vehicles",
    ]  # fmt: skip
    assert "vehicles" not in encode_plan(plan, with_vehicles=False)


def test_the_first_plan_is_kept_where_it_is_known(plan: Plan, tmp_path: Path) -> None:
    told = replace(plan, first=FirstPlan(0.25, 7.5))
    save_plan(told, tmp_path / "told.json")
    content = json.loads((tmp_path / "told.json").read_text(encoding="utf-8"))
    assert content["first_plan"] == {"seconds": 0.25, "cost": 7.5}
    assert load_plan(tmp_path / "told.json").first == FirstPlan(0.25, 7.5)
    assert "first_plan" not in encode_plan(replace(plan, first=None))


def test_each_row_of_a_matrix_takes_one_line(plan: Plan, tmp_path: Path) -> None:
    save_plan(plan, tmp_path / "plan.json")
    lines = (tmp_path / "plan.json").read_text(encoding="utf-8").splitlines()
    mean = plan.trajectories[0].means[2].tolist()
    assert json.dumps(mean) in [line.strip().rstrip(",") for line in lines]
    assert len(lines) < 150


def test_content_without_the_optional_keys_is_read(
    edited: Callable[..., Path],
) -> None:
    def strip(content: Content) -> None:
        for key in ("seconds", "versions", "explanation"):
            del content[key]

    loaded = load_plan(edited(strip))
    assert (loaded.seconds, loaded.versions, loaded.explanation) == ({}, {}, None)


def test_a_missing_a_doubled_and_a_swapped_vehicle_are_left_to_the_referee(
    edited: Callable[..., Path],
) -> None:
    missing = load_plan(edited(lambda content: content["vehicles"].pop()))
    assert [t.name for t in missing.trajectories] == ["a"]
    swapped = load_plan(edited(lambda content: content["vehicles"].reverse()))
    assert [t.name for t in swapped.trajectories] == ["b", "a"]
    doubled = load_plan(edited(lambda content: content["vehicles"][1].update(name="a")))
    assert [t.name for t in doubled.trajectories] == ["a", "a"]


def test_arrays_of_another_horizon_are_left_to_the_referee(edited: Callable[..., Path]) -> None:
    loaded = load_plan(edited(lambda content: content["vehicles"][0]["controls"].pop()))
    assert loaded.trajectories[0].controls.shape == (2, 2)


@pytest.mark.parametrize(
    ("change", "line"),
    [
        (lambda c: c.update(extra=1), r"extra: unknown key, allowed are format, scenario"),
        (lambda c: c.update(costs=c.pop("cost")), r"costs: unknown key, did you mean 'cost'\?"),
        (lambda c: c.pop("risk"), r":1: risk: is required$"),
        (lambda c: c.update(format="radmpc/scenario/1"), r":2: format: must be 'radmpc/plan/1'"),
        (lambda c: c.update(status="good"), r"status: must be 'optimal', 'feasible', 'infeas"),
        (lambda c: c.update(cost="3"), r"cost: must be a number, got '3'"),
        (lambda c: c.update(seed=1.5), r"seed: must be a whole number, got 1.5"),
        (lambda c: c.update(seed=True), r"seed: must be a whole number, got true"),
        (lambda c: c.update(sets=[["a"], "b"]), r"sets\[1\]: must be a list, got 'b'"),
        (lambda c: c.update(scenario=[]), r"scenario: must be a mapping, got \[\]"),
        (
            lambda c: c["scenario"].update(horizon=0),
            r":7: scenario.horizon: must be at least 1 step, got 0",
        ),
        (
            lambda c: c["scenario"]["defaults"].update(radius=-1),
            r"scenario.defaults.radius: must be > 0 m, got -1.0",
        ),
        (
            lambda c: c["risk"]["ledger"][0].update(cause="weather"),
            r"risk.ledger\[0\].cause: must be 'obstacle', 'pair', 'workspace' or 'range', "
            "got 'weather'",
        ),
        (
            lambda c: c["risk"]["ledger"][0].update(risk=-0.1),
            r"risk.ledger\[0\].risk: must be at least 0, got -0.1",
        ),
        (
            lambda c: c["vehicles"][1]["controls"][2].append(1.0),
            r"vehicles\[1\].controls: must have rows of equal length, got lengths 2 and 3",
        ),
        (
            lambda c: c["vehicles"][1]["covariances"][0].pop(),
            r"vehicles\[1\].covariances: must be numbers of equal row length",
        ),
        (
            lambda c: c["vehicles"][1].update(controls=[]),
            r"vehicles\[1\].controls: must have shape \(any, any\), got \(0,\)",
        ),
        (
            lambda c: c["vehicles"][1]["means"][1].__setitem__(0, float("nan")),
            r"vehicles\[1\].means\[1\]\[0\]: must be a finite number, got nan",
        ),
        (
            lambda c: c["vehicles"][1]["means"][1].__setitem__(0, float("inf")),
            r"vehicles\[1\].means\[1\]\[0\]: must be a finite number, got inf",
        ),
        (
            lambda c: c["vehicles"][1]["means"][1].__setitem__(0, None),
            r"vehicles\[1\].means\[1\]\[0\]: must be a number, got null",
        ),
        (lambda c: c["vehicles"][0].pop("gain"), r"vehicles\[0\].gain: is required"),
    ],
)
def test_a_malformed_plan_is_one_line(
    edited: Callable[..., Path], change: Callable[[Content], object], line: str
) -> None:
    with pytest.raises(FileFormatError, match=line) as caught:
        load_plan(edited(change))
    assert "\n" not in str(caught.value)


def test_the_line_is_that_of_the_number(edited: Callable[..., Path]) -> None:
    def spoil(content: Content) -> None:
        content["vehicles"][1]["means"][2][3] = "x"

    path = edited(spoil)
    wanted = 1 + path.read_text(encoding="utf-8").splitlines().index('     "x"')
    with pytest.raises(
        FileFormatError, match=rf"plan.json:{wanted}: vehicles\[1\].means\[2\]\[3\]"
    ):
        load_plan(path)


def test_a_plan_in_yaml_is_refused_as_json(tmp_path: Path) -> None:
    path = tmp_path / "plan.yaml"
    path.write_text("format: radmpc/plan/1\n", encoding="utf-8")
    with pytest.raises(FileFormatError, match=r"plan.yaml:1: not valid JSON"):
        load_plan(path)


def test_numbers_that_are_not_finite_are_not_written(plan: Plan, tmp_path: Path) -> None:
    path = tmp_path / "plan.json"
    with pytest.raises(FileFormatError, match=r"cannot be written"):
        save_plan(replace(plan, cost=float("nan")), path)
    assert not path.exists()


def test_a_plan_of_a_scenario_that_no_file_can_hold_is_refused(plan: Plan, tmp_path: Path) -> None:
    odd = replace(plan, scenario=replace(plan.scenario, source={"what": object()}))
    with pytest.raises(ScenarioError, match=r"source.what: must be plain data"):
        save_plan(odd, tmp_path / "plan.json")
