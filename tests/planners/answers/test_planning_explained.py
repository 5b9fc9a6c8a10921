"""Why there is no plan, and what would help, as planners say it."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest
from small_problems import mover, scene_of

from radmpc.model.obstacle import Obstacle
from radmpc.model.plan import Status
from radmpc.model.relations.concerns import only_for
from radmpc.model.relations.keep import Keep
from radmpc.model.scenario import Workspace
from radmpc.planners.sets import SetPlan, verdict_of_sets
from radmpc.planning import plan
from radmpc.solvers.solution import Limits, Outcome


def _explained(scenario, planner="multi-vehicle"):
    result = plan(scenario, planner)
    assert result.status is Status.INFEASIBLE
    assert result.plan is None
    assert result.cost is None
    return result.explanation


def test_a_goal_out_of_reach_is_told_with_the_vehicle_and_the_time():
    text = _explained(scene_of(mover("slow", (0, 0), (100, 0))))
    assert "'slow' cannot reach its goal within 8 steps (8 s)" in text


def test_two_vehicles_with_one_goal_are_named():
    text = _explained(scene_of(mover("a", (0, 0), (4, 0)), mover("b", (8, 0), (4, 0))))
    assert "goals of vehicles 'a' and 'b' are too close" in text


def test_a_goal_within_an_obstacle_is_named():
    reef = Obstacle.box("reef", [7, -1], [9, 1])
    text = _explained(scene_of(mover("a", (0, 0), (8, 0)), obstacles=(reef,)), "ira")
    assert "goal of vehicle 'a' lies within obstacle 'reef'" in text


def test_starts_in_conflict_are_named_with_their_risk():
    text = _explained(
        scene_of(mover("a", (0, 0), (8, 0)), mover("b", (0.83, 0), (0, 8))),
        "ira",
    )
    assert "starts of vehicles 'a' and 'b' are too close" in text
    assert "that alone runs a risk of" in text


def test_feedback_that_eats_the_control_limit_is_told_with_step_and_axis():
    gain = np.array([[-9.0, 0, -9.0, 0], [0, -9.0, 0, -9.0]])
    text = _explained(scene_of(mover("a", (0, 0), (8, 0), gain=gain)))
    assert "at step 1 the feedback alone takes more than control axis 0 allows" in text


@pytest.mark.parametrize("planner", ["certified", "ira"])
def test_vehicles_whose_places_share_a_trouble_share_a_sentence(planner):
    three = [mover(name, (0, 3 * i), (8, 3 * i)) for i, name in enumerate("abc")]
    all_three = "goals of vehicles 'a', 'b' and 'c'"
    quay = Obstacle.box("quay", [7.5, -2], [8.5, 8])
    text = plan(scene_of(*three, obstacles=(quay,)), planner).explanation
    assert f"The {all_three} lie within obstacle 'quay' grown by the vehicles' radii" in text
    assert text.count("vehicles 'a'") == text.count("obstacle 'quay'") == 1
    posts = tuple(Obstacle.box(f"post{i}", [7.5, 3 * i + 0.55], [8.5, 3 * i + 1]) for i in range(3))
    text = plan(scene_of(*three, obstacles=posts), planner).explanation
    assert f"The {all_three} are too close to obstacles 'post0', 'post1' and 'post2'" in text
    assert "even their best points are 0.65 m away or more" in text
    text = plan(scene_of(*three, workspace=Workspace([-2, -2], [7.95, 8])), planner).explanation
    assert f"The {all_three} are too close to the workspace border" in text
    assert "even their best points are 0.05 m away or more and run a risk of" in text


def test_places_too_close_to_each_other_are_told_together():
    row = [mover(name, (0, 0.5 * i), (8, 3 * i)) for i, name in enumerate("abc")]
    text = _explained(scene_of(*row))
    assert "The starts of vehicles 'a', 'b' and 'c' are too close to each other" in text
    assert "are 0.5 m apart, contact is at 0.8 m (a risk of 1 each" in text


@pytest.mark.slow
def test_vehicles_without_a_way_are_told_together():
    walls = tuple(
        box
        for i in range(3)
        for box in (
            Obstacle.box(f"north{i}", [3, 20 * i + 0.5], [4, 20 * i + 9]),
            Obstacle.box(f"south{i}", [3, 20 * i - 11], [4, 20 * i - 0.5]),
        )
    )
    noise = [0.05, 0.05, 0, 0]
    fleet = [
        mover(name, (0, 20 * i), (8, 20 * i), disturbance_covariance=noise)
        for i, name in enumerate("abc")
    ]
    scenario = scene_of(*fleet, obstacles=walls, risk_bound=1e-4, avoidance="intervals")
    text = _explained(scenario)
    assert "'b'" in text
    assert "'c'" in text


def test_sets_that_a_limit_stopped_are_told_together():
    fleet = [mover(name, (0, 20 * i), (8, 20 * i)) for i, name in enumerate("abc")]
    plans = [SetPlan(Outcome.LIMIT, (), ())] * 3
    limits = Limits(0.0, time_limit=5.0)
    status, why = verdict_of_sets(scene_of(*fleet), ((0,), (1,), (2,)), plans, limits)
    assert status is Status.LIMIT
    assert why == (
        "Sets of 'a'; 'b'; 'c': No plan was found, and none was ruled out: the time limit of 5 s "
        "was reached. Raise it."
    )


def test_a_limit_is_told_by_every_planner_in_the_same_words():
    scenario = scene_of(mover("a", (0, 0), (8, 0)))
    told = {plan(scenario, name, time_limit=1e-9).explanation for name in ("distance", "rmpc-rrt")}
    (text,) = told
    assert text.startswith("No plan was found, and none was ruled out: the time limit of 1e-09 s ")


@pytest.mark.parametrize(
    ("planner", "sought"),
    [
        ("dlp", "whose mean touches nothing (all that this planner looks at); near"),
        ("rmpc", "that keeps 3 standard deviations clear (all that this planner looks at); near"),
        ("uniform", "within the risk bound 0.001 that this planner sees"),
    ],
)
def test_a_planner_without_a_path_says_what_it_looks_at(planner, sought):
    walls = (
        Obstacle.box("north", [3, 0.1], [4, 30]),
        Obstacle.box("south", [3, -30], [4, -0.1]),
    )
    vehicle = mover("a", (0, 0), (8, 0), disturbance_covariance=[0.01, 0.01, 0, 0])
    scenario = scene_of(vehicle, obstacles=walls, risk_bound=1e-3, avoidance="intervals")
    assert _explained(scenario, planner).startswith(f"Vehicle 'a' alone finds no path {sought}")


@pytest.mark.slow
def test_a_gap_too_narrow_for_the_noise_names_the_vehicle():
    walls = (
        Obstacle.box("north", [3, 0.5], [4, 30]),
        Obstacle.box("south", [3, -30], [4, -0.5]),
    )
    scenario = scene_of(
        mover("a", (0, 0), (8, 0), disturbance_covariance=[0.05, 0.05, 0, 0]),
        obstacles=walls,
        risk_bound=1e-4,
        avoidance="intervals",
    )
    assert "Vehicle 'a' alone finds no path" in _explained(scenario)


def test_a_limit_and_a_horizon_are_told_that_bring_a_goal_into_reach():
    problem = scene_of(mover("slow", (0, 0), (20, 0), speed_limit=np.full(2, 2.0)))
    text = _explained(problem)
    horizon = re.search(r"lengthen the horizon to (\d+) steps", text)
    factor = re.search(r"raise speed_limit to ([0-9.]+) times", text)
    assert horizon is not None, text
    assert factor is not None, text
    assert "soften" not in text  # there is no feedback
    assert plan(replace(problem, horizon=int(horizon[1])), "multi-vehicle").plan is not None
    (vehicle,) = problem.vehicles
    faster = replace(vehicle, speed_limit=float(factor[1]) * vehicle.speed_limit)
    assert plan(replace(problem, vehicles=(faster,)), "multi-vehicle").plan is not None


def test_two_that_are_far_apart_are_not_told_to_be_in_each_others_way():
    fleet, walls = [], []
    for name, y in (("a", 0.0), ("b", 50.0)):
        fleet.append(mover(name, (0, y), (8, y), disturbance_covariance=[0.01, 0.01, 0, 0]))
        walls.append(Obstacle.box(f"{name} north", [1, y + 1], [7, y + 9]))
        walls.append(Obstacle.box(f"{name} south", [1, y - 9], [7, y - 1]))
    scenario = scene_of(*fleet, obstacles=tuple(walls))
    assert plan(replace(scenario, vehicles=(fleet[0],)), "uniform").plan is not None
    text = _explained(scenario, "uniform")
    assert text.startswith("Vehicles 'a' and 'b' alone find no path for both within the risk bound")
    assert "past each other" not in text


QUIET = {"disturbance_covariance": 0.0, "initial_covariance": 0.0}


def test_two_that_meet_in_a_corridor_are_told_to_be_in_each_others_way():
    walls = (Obstacle.box("north", [1, 0.6], [7, 20]), Obstacle.box("south", [1, -20], [7, -0.6]))
    fleet = (mover("a", (0, 0), (8, 0), **QUIET), mover("b", (8, 0), (0, 0), **QUIET))
    text = _explained(scene_of(*fleet, obstacles=walls, avoidance="intervals"), "dlp")
    assert text.startswith("Vehicles 'a' and 'b' alone find no path past each other whose mean")


def test_two_that_lose_their_range_are_not_told_to_be_in_each_others_way():
    walls = (
        only_for(Obstacle.box("north", [3, -3], [5, 20]), ["a"]),
        only_for(Obstacle.box("south", [3, -20], [5, 3]), ["b"]),
    )
    fleet = (mover("a", (0, -1), (8, -1), **QUIET), mover("b", (0, 1), (8, 1), **QUIET))
    keep = (Keep(["a", "b"], 4.0),)
    kept = scene_of(*fleet, obstacles=walls, keep=keep, avoidance="intervals")
    assert plan(replace(kept, keep=()), "dlp").plan is not None
    assert _explained(kept, "dlp").startswith("Vehicles 'a' and 'b' alone find no path for both ")


def test_what_brings_a_goal_into_reach_leaves_a_way_to_it():
    wall = Obstacle.box("wall", [9, -12], [10, 12])
    late = mover("a", (0, 0), (20, 0), **QUIET)
    scenario = scene_of(late, obstacles=(wall,), horizon=7, avoidance="intervals")
    text = _explained(scenario, "uniform")
    horizon = re.search(r"lengthen the horizon to (\d+) steps", text)
    assert horizon is not None, text
    assert plan(replace(scenario, horizon=int(horizon[1])), "uniform").plan is not None
    # At 1.5 times its speed it would be there in time, straight through the wall.
    assert "raise speed_limit" not in text
