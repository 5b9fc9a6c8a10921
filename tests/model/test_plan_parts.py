"""What plans are made of, and what they refuse to be made of."""

from __future__ import annotations

import copy
import json
import pickle
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

import radmpc
from radmpc.model.dynamics import covariances, rollout
from radmpc.model.obstacle import Obstacle

SYSTEM = radmpc.double_integrator(1.0, 2)
BOAT = radmpc.Vehicle("a", SYSTEM, [0, 0], radmpc.Goal.at([3, 0], 0.3), 0.3, 2.0, 0.0, 1e-3)
SCENE = radmpc.Scenario(
    "s", 1.0, 4, 0.05, [BOAT, replace(BOAT, name="b", start=[0, 9], goal=radmpc.Goal.at([3, 9], 1))]
)


@pytest.fixture(scope="module")
def plan() -> radmpc.Plan:
    return radmpc.plan(SCENE, "multi-vehicle").require()


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"cost": "x"}, "cost: must be a number, got 'x'"),
        ({"lower_bound": "x"}, "lower_bound: must be a number, got 'x'"),
        ({"trajectories": (1,)}, r"trajectories\[0\]: must be a Trajectory, got 1"),
        ({"trajectories": 1}, "trajectories: must be a sequence of Trajectorys, got 1"),
        ({"scenario": None}, "scenario: must be a Scenario, got None"),
        ({"status": "optimal"}, "status: must be a Status, got 'optimal'"),
        ({"risk": 0.1}, r"risk: must be a Risk, got 0\.1"),
        ({"sets": (1,)}, "sets: must be a sequence of names, got 1"),
        ({"seconds": 3}, "seconds: must be a mapping, got 3"),
        ({"planner": 3}, "planner: must be text, got 3"),
        ({"first": 3}, "first: must be a FirstPlan, got 3"),
        ({"seed": 1.5}, r"seed: must be an integer, got 1\.5"),
    ],
)
def test_a_plan_of_other_parts_is_refused_in_one_line(
    plan: radmpc.Plan, changes: dict[str, object], message: str
) -> None:
    with pytest.raises(radmpc.ScenarioError, match=f"^{message}$"):
        replace(plan, **changes)  # type: ignore[arg-type] # what a caller may try


def test_a_risk_of_other_parts_is_refused() -> None:
    with pytest.raises(radmpc.ScenarioError, match=r"^risk\.price: must be a number, got 'x'$"):
        radmpc.Risk(0.1, price="x")  # type: ignore[arg-type] # what a caller may try
    with pytest.raises(radmpc.ScenarioError, match=r"^risk\.ledger\[0\]: must be a LedgerRow"):
        radmpc.Risk(0.1, ledger=(1,))  # type: ignore[arg-type] # what a caller may try


def test_numbers_of_numpy_become_pythons(plan: radmpc.Plan) -> None:
    assert type(replace(plan, cost=np.float32(2.0)).cost) is float
    assert type(replace(plan, seed=np.int64(2)).seed) is int


@pytest.mark.parametrize(
    ("changed", "problem"),
    [
        (lambda p: replace(p, cost=float("nan")), "states a cost of nan, its controls cost"),
        (lambda p: replace(p, lower_bound=float("nan")), "lower bound is nan, must be a number"),
        (
            lambda p: replace(p, certified_lower_bound=float("nan")),
            "lower bound of any certified plan is nan, must be a number",
        ),
        (
            lambda p: replace(p, risk=replace(p.risk, price=-5.0)),
            "states a shadow price of risk of -5, must be >= 0",
        ),
        (
            lambda p: replace(p, risk=replace(p.risk, price=float("nan"))),
            "states a shadow price of risk of nan, must be >= 0",
        ),
        (
            lambda p: replace(p, risk=replace(p.risk, certified=float("nan"))),
            "states a certified risk of nan",
        ),
    ],
)
def test_numbers_that_are_none_are_problems(
    plan: radmpc.Plan, changed: Callable[[radmpc.Plan], radmpc.Plan], problem: str
) -> None:
    [told] = radmpc.certify(changed(plan)).problems
    assert problem in told


def test_rows_and_couplings_of_nonsense_are_problems_and_no_errors(plan: radmpc.Plan) -> None:
    rows = (
        radmpc.LedgerRow("weather", "a", "b", 1, 0.0),  # type: ignore[arg-type] # no cause
        radmpc.LedgerRow("pair", "a", "b", "x", 0.0),  # type: ignore[arg-type] # no step
    )
    odd = radmpc.Coupling("a", "b", "distance", "x")  # type: ignore[arg-type] # no number
    wrong = replace(plan, risk=replace(plan.risk, ledger=rows), couplings=(odd,))
    assert len(radmpc.certify(wrong).problems) == 3


def test_a_vehicle_that_a_plan_lacks_is_named_with_those_it_has(plan: radmpc.Plan) -> None:
    with pytest.raises(KeyError, match="no vehicle 'zzz'; the plan has 'a', 'b'"):
        plan.trajectory("zzz")


def test_mappings_of_frozen_values_are_copies_that_do_not_change(plan: radmpc.Plan) -> None:
    given = {"choices": {"dt": "1 s"}, "list": [1, {"a": 2}]}
    source = replace(SCENE, source=given).source
    assert source is not None
    given["choices"]["dt"] = "2 s"  # type: ignore[index] # a mapping
    assert source == {"choices": {"dt": "1 s"}, "list": [1, {"a": 2}]}
    for mapping in (source, source["choices"], plan.seconds, plan.versions):
        with pytest.raises(TypeError, match="belongs to a frozen value"):
            mapping["x"] = 1  # type: ignore[index] # refused
        for same in (
            copy.deepcopy(mapping),
            copy.copy(mapping),
            pickle.loads(pickle.dumps(mapping)),
        ):
            assert same == mapping
        assert json.loads(json.dumps(mapping)) == mapping
    for word in ("clear", "popitem"):
        with pytest.raises(TypeError, match="belongs to a frozen value"):
            getattr(source, word)()


LIST_CHANGES: dict[str, Callable[[list[object]], object]] = {
    "set": lambda given: given.__setitem__(0, 9),
    "delete": lambda given: given.__delitem__(0),
    "add": lambda given: given.__iadd__([9]),
    "multiply": lambda given: given.__imul__(2),
    "append": lambda given: given.append(9),
    "extend": lambda given: given.extend([9]),
    "insert": lambda given: given.insert(0, 9),
    "pop": lambda given: given.pop(),
    "remove": lambda given: given.remove(1),
    "clear": lambda given: given.clear(),
    "sort": lambda given: given.sort(),
    "reverse": lambda given: given.reverse(),
}


@pytest.mark.parametrize("change", LIST_CHANGES.values(), ids=LIST_CHANGES)
def test_lists_within_a_frozen_mapping_do_not_change(
    change: Callable[[list[object]], object],
) -> None:
    source = replace(SCENE, source={"list": [1, 2, [3]]}).source
    assert source is not None
    for same in (source, copy.deepcopy(source), pickle.loads(pickle.dumps(source))):
        found = same["list"]
        assert isinstance(found, list)
        with pytest.raises(TypeError, match="belongs to a frozen value"):
            change(found)
        with pytest.raises(TypeError, match="belongs to a frozen value"):
            found[2].append(4)
        assert source == same == {"list": [1, 2, [3]]}
        assert json.loads(json.dumps(same)) == same


def test_an_array_within_a_frozen_mapping_is_what_a_file_makes_of_it() -> None:
    given = np.array([[1.0, 2.0]])
    scene = replace(SCENE, source={"corner": given, "height": np.float64(3.0)})
    given[:] = 7.0
    assert scene.source == {"corner": [[1.0, 2.0]], "height": 3.0}
    back = radmpc.from_dict(radmpc.to_dict(scene))
    assert isinstance(back, radmpc.Scenario)
    assert back.source == scene.source


def test_a_belief_of_another_kind_is_refused() -> None:
    with pytest.raises(radmpc.ScenarioError, match=r"^belief: must be a Belief, got 3$"):
        replace(BOAT, belief=3)  # type: ignore[arg-type] # what a caller may try


def test_a_vehicle_without_any_control_limit_is_refused() -> None:
    message = "^control_limit: needs a number per axis or a control_norm, got neither$"
    with pytest.raises(radmpc.ScenarioError, match=message):
        replace(BOAT, control_limit=None)  # type: ignore[arg-type] # what a caller may try


def test_a_vehicle_in_space_among_others_is_refused_at_its_dynamics() -> None:
    drone = radmpc.Vehicle(
        "c", radmpc.double_integrator(1.0, 3), [0] * 3, radmpc.Goal.at([1] * 3), 0.3, 2.0, 0.0, 0.0
    )
    with pytest.raises(radmpc.ScenarioError, match=r"^vehicles\[1\]\.dynamics: must be 2-D like"):
        replace(SCENE, vehicles=(BOAT, drone))


def test_a_regulator_that_leaves_a_mode_as_it_is_does_not_stabilize() -> None:
    with pytest.raises(radmpc.ScenarioError, match="no stabilizing gain"):
        radmpc.lqr_gain(SYSTEM, np.zeros((4, 4)), np.eye(2))
    gain = radmpc.lqr_gain(SYSTEM, 1e-6 * np.eye(4), np.eye(2))
    assert np.abs(np.linalg.eigvals(SYSTEM.A + SYSTEM.B @ gain)).max() < 1.0


@pytest.mark.parametrize("drift", [np.zeros(3), np.zeros((2, 4)), [np.nan] * 4, "x"])
def test_a_drift_that_does_not_fit_is_refused(drift: object) -> None:
    with pytest.raises(radmpc.ScenarioError, match=r"^drift: must "):
        rollout(SYSTEM, np.zeros(4), np.zeros((3, 2)), drift)  # type: ignore[arg-type] # refused


def test_a_drift_of_every_step_is_that_of_each() -> None:
    same = rollout(SYSTEM, np.zeros(4), np.zeros((3, 2)), [1, 0, 0, 0])  # type: ignore[arg-type] # a list
    each = rollout(SYSTEM, np.zeros(4), np.zeros((3, 2)), np.tile([1.0, 0, 0, 0], (3, 1)))
    assert same.tolist() == each.tolist()
    assert same[-1].tolist() == [3, 0, 0, 0]


def test_covariances_over_time_take_a_number_or_a_diagonal_as_vehicles_do() -> None:
    exact = covariances(SYSTEM, 0.25 * np.eye(4), np.diag([1.0, 2.0, 3.0, 4.0]), None, 3)
    assert covariances(SYSTEM, 0.25, [1, 2, 3, 4], None, 3).tolist() == exact.tolist()


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        ((None, 0.1, 0.1, None, 3), "^system must be a LinearSystem, got None$"),
        ((SYSTEM, [1, 2], 0.1, None, 3), "^initial: must have 4 numbers, got 2$"),
        ((SYSTEM, 0.1, -1, None, 3), "^disturbance: must be positive semi-definite"),
        ((SYSTEM, 0.1, 0.1, np.eye(4), 3), r"^gain: must have shape \(2, 4\), got \(4, 4\)$"),
        ((SYSTEM, 0.1, 0.1, None, 2.5), "^horizon must be an integer >= 0, got 2.5$"),
    ],
)
def test_covariances_over_time_are_refused_what_they_do_not_follow_from(
    arguments: tuple[object, ...], told: str
) -> None:
    with pytest.raises(radmpc.RadmpcError, match=told):
        covariances(*arguments)  # type: ignore[arg-type] # what a caller may try


def test_steps_that_a_moving_obstacle_does_not_have_are_refused() -> None:
    track = Obstacle.tracked("o", [[0, 0]], [0, 0, 1, 0])
    assert len(track.at(0)) == 1
    with pytest.raises(radmpc.ArgumentError, match="from 0 to 0, got 3: its scenario lays out"):
        track.at(3)
    laid_out = replace(SCENE, obstacles=(track,)).obstacles[0]
    for step in (-1, 5):
        with pytest.raises(
            radmpc.ArgumentError, match=f"^step must be an integer from 0 to 4, got {step}$"
        ):
            laid_out.at(step)
    for odd, told in ((1.5, "1.5"), ("1", "'1'"), (None, "None"), (True, "True"), ([1], r"\[1\]")):
        with pytest.raises(
            radmpc.ArgumentTypeError, match=f"^step must be an integer from 0 to 4, got {told}$"
        ):
            laid_out.at(odd)  # type: ignore[arg-type] # what a caller may try
    assert laid_out.at(np.int64(3))  # type: ignore[arg-type] # numpy's
    assert Obstacle.box("o", [0, 0], [1, 1]).at(99)
