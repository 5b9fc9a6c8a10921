"""Infeasible and limit are true, and advice works."""

from __future__ import annotations

from dataclasses import replace
from itertools import product
from pathlib import Path

import numpy as np
import pytest

from radmpc.io.native.scenario_file import load_scenario
from radmpc.model.dynamics import double_integrator, lqr_gain
from radmpc.model.obstacle import Obstacle
from radmpc.model.plan import Status
from radmpc.model.scenario import Scenario
from radmpc.model.vehicle import Goal, Vehicle
from radmpc.planners.certified.infeasible.explanation import why_not
from radmpc.planning import plan
from radmpc.solvers.solution import Limits
from running import first_plan

SCENES = Path(__file__).parents[2] / "data" / "scenes"


def scene(name):
    return load_scenario(SCENES / name)


def vehicle(name, start, goal, half=0.1, **fields):
    common = {
        "system": double_integrator(1.0, len(start)),
        "goal": Goal.at(goal, half, 3.0),
        "radius": 0.3,
        "control_limit": 4.0,
        "initial_covariance": 1e-6,
        "disturbance_covariance": 1e-6,
    }
    return Vehicle(name=name, start=np.array(start, dtype=float), **(common | fields))


def scenario(*vehicles, **fields):
    settings = {"name": "true", "dt": 1.0, "horizon": 4, "risk_bound": 0.02} | fields
    return Scenario(vehicles=vehicles, **settings)


def test_starts_in_contact_without_noise_are_planned_as_well_as_ira_does():
    problem = scene("contact-at-start.json")
    result = plan(problem, time_limit=20.0)
    assert result.is_certified
    assert result.cost <= plan(problem, "ira").cost * (1.0 + 1e-3)


def test_a_depot_with_a_spacing_of_two_radii_can_be_left():
    fleet = [vehicle(f"v{i}", (0.6 * i, 0), (4 * i - 4, 6), initial_covariance=0) for i in range(3)]
    assert plan(scenario(*fleet, avoidance="steps"), time_limit=20.0).is_certified


@pytest.mark.parametrize(
    ("avoidance", "at_goal", "planner"),
    list(product(["steps", "intervals"], [False, True], ["certified", "ira"])),
)
def test_places_apart_along_a_diagonal_alone_are_planned(avoidance, at_goal, planner):
    near, far = ((0, 0), (0.45, 0.45)), ((-5, -4), (4, 5))
    starts, goals = (far, near) if at_goal else (near, far)
    fleet = [
        vehicle(name, start, goal, half=0.005)
        for name, start, goal in zip("ab", starts, goals, strict=True)
    ]
    result = plan(scenario(*fleet, avoidance=avoidance), planner, time_limit=20.0)
    assert result.is_certified


def test_a_start_beside_the_corner_of_an_obstacle_is_no_contact():
    rock = Obstacle.box("rock", [-2, -2], [-0.25, -0.25])
    problem = scenario(vehicle("a", (0, 0), (5, 4)), obstacles=(rock,))
    assert plan(problem, time_limit=20.0).is_certified


def test_starts_in_space_apart_along_a_diagonal_are_planned():
    fleet = vehicle("a", (0, 0, 0), (-5, -4, -4)), vehicle("b", (0.4, 0.4, 0.4), (4, 5, 4))
    assert plan(scenario(*fleet), time_limit=20.0).is_certified


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("starts-clash.yaml", ["'usv1' and 'usv2'", "overlap", "2 m apart", "5 m"]),
        ("start-risk-above-bound.yaml", ["'v1'", "'post1'", "0.19", "0.154746"]),
        ("budget-complex.json", ["'v0'", "'o0'", "0.28", "0.27659"]),
        ("goal-too-near.yaml", ["'usv4'", "goal", "'mole'", "0.026", "0.02"]),
        ("goal-too-near-fleet.yaml", ["'usv4'", "goal", "'mole'", "0.026", "0.02"]),
    ],
)
def test_a_start_or_goal_that_rules_out_any_plan_is_named_before_any_search(name, words):
    result = plan(scene(name))
    assert result.status is Status.INFEASIBLE
    assert all(word in result.explanation for word in words)
    assert not result.steps


@pytest.mark.slow
def test_a_goal_that_is_too_near_has_no_plan_however_it_is_planned():
    problem = scene("goal-too-near.yaml")
    risk = plan(replace(problem, risk_bound=0.1), time_limit=5.0).certificate.certified
    assert risk > problem.risk_bound


@pytest.mark.slow
def test_a_longer_horizon_that_does_is_named_and_does():
    problem = scene("horizon-is-the-cure.yaml")
    text = why_not(problem, Limits()).explanation
    assert "26 steps" in text
    assert "add feedback" not in text
    assert first_plan(replace(problem, horizon=26), time_limit=10.0).is_certified


@pytest.mark.slow
def test_a_plan_that_needs_more_faces_says_so_and_what_else_would_help():
    result = plan(scene("horizon-is-the-cure.yaml"), "certified(0)", time_limit=30.0)
    assert result.is_certified
    assert "Planned with obstacles' corners cut every" in result.explanation
    assert "26 steps" in result.explanation


@pytest.mark.nightly
@pytest.mark.slow
def test_feedback_that_keeps_back_most_of_the_control_is_told_with_a_softer_one_that_does():
    problem = scene("soft-gain-is-the-cure.yaml")
    text = why_not(problem, Limits()).explanation
    assert "keeps back 0.276 of 0.3 m/s² on axis 0" in text
    assert "soften the feedback (lqr with Q = 1, R = 10 does)" in text
    assert "add feedback" not in text
    [one] = problem.vehicles
    softer = replace(one, gain=lqr_gain(one.system, np.eye(4), 10.0 * np.eye(2)))
    assert first_plan(replace(problem, vehicles=(softer,)), time_limit=20.0).is_certified


def test_a_least_time_is_told_and_is_enough():
    problem = scenario(vehicle("a", (0, 0), (40, 0), speed_limit=np.full(2, 3.0)), horizon=5)
    text = plan(problem).explanation
    assert "cannot reach its goal within 5 steps (5 s)" in text
    assert "lengthen the horizon to 14 steps" in text
    assert plan(replace(problem, horizon=14)).is_certified
    assert not plan(replace(problem, horizon=13)).is_certified


def test_six_vehicles_with_the_same_reason_share_a_sentence():
    fleet = [vehicle(f"v{i}", (0, 10 * i), (90, 10 * i)) for i in range(6)]
    text = plan(scenario(*fleet)).explanation
    assert text.count("within 4 steps") == 1
    assert "Vehicles 'v0', 'v1', 'v2' and 3 more cannot reach their goals" in text


def test_feedback_that_leaves_no_control_is_told_in_numbers():
    gain = np.hstack([-np.eye(2), -1.5 * np.eye(2)])
    stiff = vehicle("a", (0, 0), (2, 0), gain=gain, disturbance_covariance=4.0)
    text = plan(scenario(stiff)).explanation
    assert "the feedback alone takes more than control axis 0 allows, it keeps back" in text
    assert "of 4 m/s² (3 standard deviations)" in text


def test_settled_risk_is_no_reason_to_refuse_a_tiny_bound():
    # What these avoidances could run at worst is far above what any plan runs.
    rock = Obstacle.box("rock", [-1, 3.5], [1, 4])
    fast = vehicle("a", (-4, 0), (4, 0), disturbance_covariance=np.diag([0.02, 0.02, 0, 0]))
    problem = scenario(fast, obstacles=(rock,), risk_bound=1e-13, avoidance="steps")
    result = plan(problem, time_limit=10.0)
    assert result.status is not Status.INFEASIBLE


@pytest.mark.parametrize(
    ("limits", "words"),
    [({"time_limit": 0.0}, "time limit of 0 s"), ({"stop": lambda: True}, "stopped on request")],
)
def test_a_limit_is_named(limits, words):
    rock = Obstacle.box("rock", [1.5, -0.5], [2.5, 0.5])
    result = plan(scenario(vehicle("a", (0, 0), (4, 0)), obstacles=(rock,)), **limits)
    assert result.status is Status.LIMIT
    assert words in result.explanation


INFEASIBLE = (7, 30, 38, 51, 55, 65, 107, 155, 180, 201)
"""Seeds of random problems without a plan: starts that overlap in the first, goals too close in the
last, and else starts apart, but too close for the risk bound."""


@pytest.mark.slow
@pytest.mark.sampled(2)
@pytest.mark.parametrize("seed", INFEASIBLE)
def test_what_is_called_infeasible_is_planned_by_no_other_planner(seed):
    rng = np.random.default_rng(seed)
    noise = np.array([*10.0 ** rng.uniform(-5, -1.5, 2), 1e-4, 1e-4])
    fleet = [
        vehicle(
            f"v{i}",
            rng.uniform(-1.0, 1.0, 2),
            rng.uniform(-2.0, 2.0, 2),
            half=0.3,
            control_limit=float(rng.uniform(2, 6)),
            initial_covariance=float(rng.choice([0.0, 1e-3])),
            disturbance_covariance=noise,
        )
        for i in range(2)
    ]
    problem = scenario(
        *fleet,
        horizon=3,
        risk_bound=float(10.0 ** rng.uniform(-3, -0.4)),
        avoidance=str(rng.choice(["steps", "intervals"])),
    )
    assert plan(problem, time_limit=10.0).status is Status.INFEASIBLE
    for planner, faces in product(["ira", "uniform"], [4, 8]):
        assert not plan(replace(problem, pair_faces=faces), planner).is_certified
