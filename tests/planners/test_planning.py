"""Planners end to end: what they promise, and what they say when they cannot."""

from __future__ import annotations

import re
from collections import defaultdict
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from radmpc.errors import NoPlanError, ScenarioError
from radmpc.experiments.families import circle, paper
from radmpc.model.dynamics import double_integrator
from radmpc.model.obstacle import Obstacle
from radmpc.model.plan import Status
from radmpc.model.scenario import Scenario, Workspace
from radmpc.model.vehicle import Goal, Vehicle
from radmpc.planners import (
    Centralized,
    Couplings,
    Ira,
    Planner,
    Pool,
    Receding,
    Sigmas,
    Uniform,
)
from radmpc.planners.paper.algorithm_2_radmpc import approximate
from radmpc.planners.presets import PRESETS, parse_planner
from radmpc.planners.sets import SetPlan, verdict_of_sets
from radmpc.planning import plan
from radmpc.solvers.branch.branch import Branch
from radmpc.solvers.milp.big_m import BigM
from radmpc.solvers.solution import Outcome
from running import silent_run

CENTRAL_IRA = Planner(Ira(), Branch(), Centralized())


def _vehicle(name, start, goal, **more):
    options = {"radius": 0.4, "control_limit": np.full(2, 2.0), "speed_limit": np.full(2, 3.0)}
    return Vehicle(
        name=name,
        system=double_integrator(1.0, 2),
        start=np.concatenate([start, np.zeros(2)]),
        goal=Goal(np.array(goal) - 0.1, np.array(goal) + 0.1, np.full(2, 0.05)),
        **({"initial_covariance": 1e-3, "disturbance_covariance": 1e-3} | options | more),
    )


def _scenario(*vehicles, **more):
    options = {"dt": 1.0, "horizon": 8, "risk_bound": 0.05, "avoidance": "steps"}
    return Scenario(name="s", vehicles=vehicles, **(options | more))


@pytest.mark.slow
@pytest.mark.parametrize("name", PRESETS)
def test_every_preset_plans_a_small_problem(name):
    result = plan(paper(2, 1), name)
    assert result.status in {Status.FEASIBLE, Status.OPTIMAL}
    assert result.certificate.problems == ()
    assert result.cost == pytest.approx(
        sum(float(np.abs(t.controls).sum()) for t in result.plan.trajectories)
    )
    if name not in {"milp", "dlp"}:
        assert result.is_certified


@pytest.mark.slow
@pytest.mark.sampled(2)
@pytest.mark.parametrize("avoidance", ["steps", "intervals"])
@pytest.mark.parametrize("seed", range(3))
def test_multi_vehicle_plans_hold_before_the_referee(avoidance, seed):
    result = plan(replace(paper(4, seed), avoidance=avoidance), "multi-vehicle")
    assert result.is_certified
    assert result.certificate.certified <= 0.05
    assert sorted(name for s in result.sets for name in s) == ["v1", "v2", "v3", "v4"]


@pytest.mark.slow
@pytest.mark.sampled(3)
@pytest.mark.parametrize("avoidance", ["steps", "intervals"])
@pytest.mark.parametrize("seed", range(4))
def test_the_cost_of_ira_never_rises_and_its_allocation_never_exceeds_the_bound(avoidance, seed):
    scenario = replace(paper(3, seed), avoidance=avoidance)
    result = plan(scenario, CENTRAL_IRA)
    costs = [step.cost for step in result.steps]
    assert len(costs) >= 2
    for before, after in pairwise(costs):
        assert after <= before * (1 + CENTRAL_IRA.gap)
    for step in result.steps:
        assert step.allocated <= scenario.risk_bound
        assert step.used <= scenario.risk_bound
    assert result.cost <= min(costs) * (1 + 1e-9)


def test_ira_is_never_dearer_than_the_uniform_allocation_it_starts_from():
    scenario = paper(3, 0)
    uniform = plan(scenario, Planner(Uniform(), Branch(), Centralized()))
    assert plan(scenario, CENTRAL_IRA).cost < uniform.cost


def test_branch_and_big_m_give_the_same_uniform_plan():
    scenario = paper(2, 1)
    ours = plan(scenario, Planner(Uniform(), Branch(), Centralized(), gap=1e-5))
    theirs = plan(scenario, Planner(Uniform(), BigM(), Centralized(), gap=1e-5))
    assert ours.cost == pytest.approx(theirs.cost, rel=1e-4)


@pytest.mark.parametrize("charge", ["allocated", "used"])
def test_the_risk_pool_never_goes_negative_and_never_grows(charge):
    run = approximate(paper(5, 2), Planner(Pool(charge), Branch(), Receding()), silent_run())
    assert len(run.pool) == 50
    assert min(run.pool) >= 0.0
    assert all(b <= a for a, b in pairwise(run.pool))
    assert run.pool[0] < 0.05


def test_a_pool_that_is_charged_what_was_used_keeps_more():
    pools = {
        charge: approximate(
            paper(3, 2), Planner(Pool(charge), Branch(), Receding()), silent_run()
        ).pool[-1]
        for charge in ("allocated", "used")
    }
    assert pools["used"] > pools["allocated"]


@pytest.mark.slow
def test_the_same_seed_gives_the_same_plan_and_another_may_not():
    scenario = paper(3, 4)
    given = (7, 7, np.random.default_rng(7), 8)
    first, second, drawn, other = (plan(scenario, "radmpc", rng=rng) for rng in given)
    for a, *same in zip(*(p.plan.trajectories for p in (first, second, drawn)), strict=True):
        assert all(np.array_equal(a.controls, b.controls) for b in same)
    # Who goes first is drawn, and here it decides who gives way.
    assert other.cost < 0.95 * first.cost
    assert (first.record.seed, other.record.seed, drawn.record.seed) == (7, 8, None)


@pytest.mark.slow
def test_sets_planned_on_an_executor_give_the_same_plan():
    scenario = paper(4, 3)
    here = plan(scenario, "multi-vehicle")
    with ThreadPoolExecutor(2) as executor:
        there = plan(scenario, "multi-vehicle", executor=executor)
    assert here.cost == there.cost
    assert here.sets == there.sets


def test_vehicles_that_never_meet_are_planned_apart_and_crossing_ones_together():
    near = _scenario(_vehicle("a", (0, 0), (8, 0)), _vehicle("b", (8, 0), (0, 0)))
    far = _scenario(_vehicle("a", (0, 0), (8, 0)), _vehicle("b", (8, 30), (0, 30)))
    assert plan(near, "multi-vehicle").sets == (("a", "b"),)
    assert plan(far, "multi-vehicle").sets == (("a",), ("b",))


@pytest.mark.slow
def test_a_coupling_threshold_of_one_couples_nobody_and_the_excess_is_not_hidden():
    scenario = paper(3, 4)
    assert plan(scenario, "multi-vehicle").is_certified
    result = plan(scenario, Planner(Ira(), Branch(), Couplings(1.0)))
    assert result.sets == (("v1",), ("v2",), ("v3",))
    assert result.plan is not None
    assert not result.is_certified
    assert result.certificate.certified > scenario.risk_bound
    assert result.record.risk.certified == result.certificate.certified


def test_robust_planning_keeps_the_number_of_deviations_it_is_told():
    scenario = _scenario(
        _vehicle("a", (0, 0), (8, 0)), obstacles=(Obstacle.box("wall", [3, -1], [4, 0.9]),)
    )
    loose = plan(scenario, Planner(Sigmas(1.0), Branch(), Centralized()))
    tight = plan(scenario, Planner(Sigmas(4.0), Branch(), Centralized()))
    assert loose.cost < tight.cost
    assert loose.certificate.certified > tight.certificate.certified


def test_progress_is_told_per_stage():
    seen = defaultdict(list)
    plan(
        paper(2, 0),
        "multi-vehicle",
        progress=lambda stage, done, total: seen[stage].append((done, total)),
    )
    assert seen["radmpc"][-1] == (20, 20)
    assert seen["sets"][-1][0] == seen["sets"][-1][1]


def test_a_stop_returns_a_result_without_a_plan_and_says_so():
    result = plan(paper(3, 0), stop=lambda: True)
    assert result.status is Status.LIMIT
    assert result.plan is None
    assert result.certificate is None
    with pytest.raises(NoPlanError):
        result.require()


def test_a_time_limit_of_nothing_is_a_limit_not_an_infeasible_problem():
    result = plan(paper(3, 0), "ira", time_limit=0.0)
    assert result.status is Status.LIMIT
    assert result.record.stopped_by == "the time limit of 0 s was reached"


def test_a_search_that_ended_by_itself_was_stopped_by_no_limit():
    assert plan(paper(2, 1), "certified", time_limit=30.0).record.stopped_by is None


def _explained(scenario, planner="multi-vehicle"):
    result = plan(scenario, planner)
    assert result.status is Status.INFEASIBLE
    assert result.plan is None
    assert result.cost is None
    return result.explanation


def test_a_goal_out_of_reach_is_told_with_the_vehicle_and_the_time():
    text = _explained(_scenario(_vehicle("slow", (0, 0), (100, 0))))
    assert "'slow' cannot reach its goal within 8 steps (8 s)" in text


def test_two_vehicles_with_one_goal_are_named():
    text = _explained(_scenario(_vehicle("a", (0, 0), (4, 0)), _vehicle("b", (8, 0), (4, 0))))
    assert "goals of vehicles 'a' and 'b' are too close" in text


def test_a_goal_within_an_obstacle_is_named():
    reef = Obstacle.box("reef", [7, -1], [9, 1])
    text = _explained(_scenario(_vehicle("a", (0, 0), (8, 0)), obstacles=(reef,)), "ira")
    assert "goal of vehicle 'a' lies within obstacle 'reef'" in text


def test_starts_in_conflict_are_named_with_their_risk():
    text = _explained(
        _scenario(_vehicle("a", (0, 0), (8, 0)), _vehicle("b", (0.83, 0), (0, 8))), "ira"
    )
    assert "starts of vehicles 'a' and 'b' are too close" in text
    assert "that alone runs a risk of" in text


def test_feedback_that_eats_the_control_limit_is_told_with_step_and_axis():
    gain = np.array([[-9.0, 0, -9.0, 0], [0, -9.0, 0, -9.0]])
    text = _explained(_scenario(_vehicle("a", (0, 0), (8, 0), gain=gain)))
    assert "at step 1 the feedback alone takes more than control axis 0 allows" in text


@pytest.mark.parametrize("planner", ["certified", "ira"])
def test_vehicles_whose_places_share_a_trouble_share_a_sentence(planner):
    three = [_vehicle(name, (0, 3 * i), (8, 3 * i)) for i, name in enumerate("abc")]
    all_three = "goals of vehicles 'a', 'b' and 'c'"
    quay = Obstacle.box("quay", [7.5, -2], [8.5, 8])
    text = plan(_scenario(*three, obstacles=(quay,)), planner).explanation
    assert f"The {all_three} lie within obstacle 'quay' grown by the vehicles' radii" in text
    assert text.count("vehicles 'a'") == text.count("obstacle 'quay'") == 1
    posts = tuple(Obstacle.box(f"post{i}", [7.5, 3 * i + 0.55], [8.5, 3 * i + 1]) for i in range(3))
    text = plan(_scenario(*three, obstacles=posts), planner).explanation
    assert f"The {all_three} are too close to obstacles 'post0', 'post1' and 'post2'" in text
    assert "even their best points are 0.65 m away or more" in text
    text = plan(_scenario(*three, workspace=Workspace([-2, -2], [7.95, 8])), planner).explanation
    assert f"The {all_three} are too close to the workspace border" in text
    assert "even their best points are 0.05 m away or more and run a risk of" in text


def test_places_too_close_to_each_other_are_told_together():
    row = [_vehicle(name, (0, 0.5 * i), (8, 3 * i)) for i, name in enumerate("abc")]
    text = _explained(_scenario(*row))
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
        _vehicle(name, (0, 20 * i), (8, 20 * i), disturbance_covariance=noise)
        for i, name in enumerate("abc")
    ]
    scenario = _scenario(*fleet, obstacles=walls, risk_bound=1e-4, avoidance="intervals")
    text = _explained(scenario)
    assert "'b'" in text
    assert "'c'" in text


def test_sets_that_a_limit_stopped_are_told_together():
    fleet = [_vehicle(name, (0, 20 * i), (8, 20 * i)) for i, name in enumerate("abc")]
    plans = [SetPlan(Outcome.LIMIT, (), ())] * 3
    status, why = verdict_of_sets(_scenario(*fleet), ((0,), (1,), (2,)), plans)
    assert status is Status.LIMIT
    assert why == "Sets of 'a'; 'b'; 'c': no plan within the limit."


@pytest.mark.slow
def test_a_gap_too_narrow_for_the_noise_names_the_vehicle():
    walls = (
        Obstacle.box("north", [3, 0.5], [4, 30]),
        Obstacle.box("south", [3, -30], [4, -0.5]),
    )
    scenario = _scenario(
        _vehicle("a", (0, 0), (8, 0), disturbance_covariance=[0.05, 0.05, 0, 0]),
        obstacles=walls,
        risk_bound=1e-4,
        avoidance="intervals",
    )
    assert "Vehicle 'a' alone finds no way" in _explained(scenario)


@pytest.mark.slow
def test_everyone_through_one_point_is_planned_within_the_bound():
    result = plan(circle(4), "multi-vehicle")
    assert result.is_certified
    assert result.sets == (("v1", "v2", "v3", "v4"),)


def test_planner_names_are_read_with_and_without_their_number():
    assert parse_planner("multi-vehicle(1e-3)").decomposition == Couplings(1e-3)
    assert parse_planner("rmpc(2)").policy == Sigmas(2.0)
    assert str(parse_planner("radmpc")) == "pool, branch, receding"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("nothing", "planner must be one of milp, dlp"),
        ("ira(3)", "takes no argument"),
        ("multi-vehicle(x)", "takes a number"),
        ("multi-vehicle(7)", r"must be in \[0, 1\]"),
        ("multi-vehicle(1e-6", "planner must be one of"),
    ],
)
def test_bad_planner_names_are_refused_with_what_is_allowed(text, message):
    with pytest.raises(ScenarioError, match=message):
        parse_planner(text)


def test_choices_that_do_not_go_together_are_refused():
    with pytest.raises(ScenarioError, match=r"'pool' \(pooled\) does not go with 'centralized'"):
        Planner(Pool(), Branch(), Centralized())
    with pytest.raises(ScenarioError, match="does not go with 'receding'"):
        Planner(Ira(), Branch(), Receding())
    with pytest.raises(ScenarioError, match="gap must lie"):
        Planner(Ira(), Branch(), Centralized(), gap=0.0)
    with pytest.raises(ScenarioError, match="covariances must be"):
        Receding("sometimes")


def test_a_limit_and_a_horizon_are_told_that_bring_a_goal_into_reach():
    problem = _scenario(_vehicle("slow", (0, 0), (20, 0), speed_limit=np.full(2, 2.0)))
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
