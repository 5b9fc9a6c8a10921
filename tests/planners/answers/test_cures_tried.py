"""What is told to help was tried, and what does not help is not told."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest

from radmpc import (
    Goal,
    Obstacle,
    Scenario,
    Status,
    Vehicle,
    Visit,
    Workspace,
    double_integrator,
    from_dict,
    plan,
)
from radmpc.planners.certified.infeasible import cures
from radmpc.planners.certified.infeasible.cures import find_cures
from radmpc.planners.cures.trying import passage_sentence, reach_sentence
from radmpc.planners.cures.variants import (
    longer_horizons,
    longer_text,
    regulated,
    with_horizon,
)
from radmpc.solvers.solution import Limits


def pair() -> Scenario:
    def one(name: str, y: float) -> Vehicle:
        return Vehicle(
            name=name,
            system=double_integrator(1.0, 2),
            start=[0.0, y],
            goal=Goal.at([8.0, y], 0.2),
            radius=0.3,
            control_limit=2.0,
            initial_covariance=0.01,
            disturbance_covariance=0.01,
        )

    return Scenario("pair", 1.0, 10, 0.02, [one("a", 0.0), one("b", 5.0)])


@pytest.mark.parametrize(
    ("does", "told"),
    [
        (lambda s, _: s.horizon >= 14, "lengthen the horizon to 16 steps (16 s)."),
        (lambda s, _: s.risk_bound > 0.05, "raise risk_bound to 0.08."),
        (lambda s, _: s.num_pair_faces > 4, "raise pair_faces to 8."),
        (
            lambda s, _: s.vehicles[0].initial_covariance[0, 0] < 1e-3,
            "reduce the noise to 0.25 of its standard deviations.",
        ),
    ],
)
def test_the_mildest_change_that_does_is_told_alone(does, told):
    assert passage_sentence(pair(), does, Limits()) == f"What helps, as tried: {told}"


def test_nothing_is_told_where_nothing_does_or_no_time_is_left():
    assert passage_sentence(pair(), lambda *_: False, Limits()) == ""
    assert passage_sentence(pair(), lambda *_: True, Limits(deadline=0.0)) == ""
    assert reach_sentence(pair(), (0,), lambda *_: False, Limits()) == ""


def test_only_what_is_late_is_changed_to_reach_its_goal():
    seen = set()

    def does(changed, limits):
        del limits
        seen.add(tuple(vehicle.name for vehicle in changed.vehicles))
        return float(changed.vehicles[0].control_limit[0]) == 3.0

    text = reach_sentence(pair(), (1,), does, Limits())
    assert text == "What helps, as tried: raise control_limit to 1.5 times its value."
    assert seen == {("b",)}


def test_a_bound_that_nobody_wants_is_not_tried():
    bold = replace(pair(), risk_bound=0.2)
    assert passage_sentence(bold, lambda s, _: s.risk_bound > 0.2, Limits()) == ""


def test_horizons_to_try_are_longer_each():
    short = replace(pair(), horizon=1)
    assert longer_horizons(short) == (2,)
    assert longer_horizons(pair()) == (12, 16, 22)
    assert longer_horizons(replace(pair(), horizon=500)) == (625, 800, 1000)
    assert longer_horizons(replace(pair(), horizon=1000)) == ()


@pytest.mark.parametrize(
    ("horizon", "told"),
    [(300, ["a horizon of 600 steps"]), (900, ["a horizon of 1000 steps"]), (1000, [])],
)
def test_no_horizon_is_tried_that_no_file_holds(
    horizon: int, told: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    tried: list[int] = []

    def too_short(_: Scenario, asked: int) -> None:
        tried.append(asked)

    monkeypatch.setattr(cures, "with_horizon", too_short)
    one = pair().vehicles[0]
    late = replace(one, goal=Goal.at([1e8, 0.0], 0.2))
    alone = replace(pair(), horizon=horizon, vehicles=(late,))
    failed = find_cures(alone, Limits()).failed
    assert max(tried) == 1000
    assert [each for each in failed if "horizon" in each] == told


def test_windows_that_end_with_the_horizon_are_lengthened_with_it() -> None:
    late, free = pair().vehicles
    scenario = pair()
    box = Visit([3.0, -1.0], [4.0, 1.0], (2, 6))
    late = replace(late, goal=replace(late.goal, within=(8, 10)), via=(box,))
    longer = with_horizon(replace(scenario, vehicles=(late, free)), 15)
    assert longer.vehicles[0].goal.within == (8, 15)
    assert longer.vehicles[0].via[0].between == (2, 6)
    assert longer.vehicles[1] is free
    assert longer_text(replace(scenario, vehicles=(late, free)), 15) == (
        "lengthen the horizon to 15 steps (15 s), and windows that end with it"
    )


def test_a_longer_horizon_and_feedback_are_tried_together_where_neither_does_alone() -> None:
    slow = Vehicle(
        name="slow",
        system=double_integrator(1.0, 2),
        start=[1.0, 2.0],
        goal=Goal.at([18.0, 16.0], 0.3, 0.1),
        radius=0.4,
        control_limit=1.0,
        speed_limit=0.5,
        initial_covariance=1e-3,
        disturbance_covariance=[1e-3, 1e-3, 1e-4, 1e-4],
    )
    workspace = Workspace(np.array([-2.0, -2.0]), np.array([22.0, 22.0]))
    obstacles = (
        Obstacle.polygon("reef", [[8.0, 8.0], [12.0, 8.0], [11.0, 12.0]]),
        Obstacle.box("pier", [10.0, 0.0], [12.0, 4.0]),
    )
    scenario = Scenario("slow", 1.0, 12, 0.05, [slow], obstacles, workspace=workspace)
    [told] = find_cures(scenario, Limits()).found
    horizon = re.search(r"lengthen the horizon to (\d+) steps .*, and add feedback \(lqr", told)
    weight = re.search(r"R = (\S+) does", told)
    assert horizon is not None, told
    assert weight is not None, told
    cured = regulated(slow, float(weight[1]))
    assert plan(replace(scenario, horizon=int(horizon[1]), vehicles=(cured,))).is_certified


def one_in_a_gap(risk_bound: float) -> Scenario:
    """Return a vehicle that needs 0.02 to 0.04 for a gap, and one far from it."""

    def vehicle(name: str, y: float) -> dict[str, object]:
        goal = {"center": [8, y], "half_width": 0.5, "speed": None}
        return {"name": name, "start": [0, y], "goal": goal}

    return from_dict(
        {
            "format": "radmpc/scenario/1",
            "name": "gap",
            "dt": 1.0,
            "horizon": 6,
            "risk_bound": risk_bound,
            "avoidance": "steps",
            "obstacles": [
                {"name": "north", "min": [3, 0.72], "max": [5, 9]},
                {"name": "south", "min": [3, -9], "max": [5, -0.72]},
            ],
            "defaults": {
                "radius": 0.4,
                "control_limit": 3.0,
                "speed_limit": 2.0,
                "disturbance_covariance": [0.0, 0.0064, 0.0, 0.0],
            },
            "vehicles": [vehicle("narrow", 0), vehicle("free", 20)],
        }
    )


@pytest.mark.parametrize("planner", ["distance", "radmpc"])
def test_a_bound_that_is_said_to_help_is_the_fleets_and_does(planner):
    scenario = one_in_a_gap(0.04)
    result = plan(scenario, planner)
    assert result.status is Status.INFEASIBLE
    assert "Its share of risk_bound 0.04, by head count, is 0.02." in result.explanation
    [raised] = re.findall(r"raise risk_bound to (0\.\d+)", result.explanation)
    bolder = plan(replace(scenario, risk_bound=float(raised)), planner)
    assert bolder.status is Status.FEASIBLE


def test_planners_that_ignore_the_bound_have_no_share_of_it():
    scenario = one_in_a_gap(0.04)
    narrow, free = scenario.vehicles
    within = Goal(np.array([3.9, 1.9]), np.array([4.1, 2.1]), None)
    text = plan(
        replace(scenario, vehicles=(replace(narrow, goal=within), free)), "dmpc"
    ).explanation
    assert "(a risk of 1, above risk_bound 0.04)" in text
    assert "share" not in text
