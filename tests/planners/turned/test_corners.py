"""Corners of the problem where a plan is easily lost, or a danger easily missed."""

from __future__ import annotations

import time
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from radmpc.errors import ScenarioError
from radmpc.experiments.families import circle, paper
from radmpc.model.dynamics import LinearSystem, double_integrator
from radmpc.model.obstacle import Obstacle
from radmpc.model.plan import Status
from radmpc.model.scenario import Scenario, Workspace
from radmpc.model.vehicle import Goal, Vehicle
from radmpc.planners import Centralized, Couplings, Ira, Planner, Pool, Receding, Sigmas
from radmpc.planners.executing import _until
from radmpc.planners.explain import explain_infeasible
from radmpc.planners.sets import SetTask, plan_set, run_sets
from radmpc.planning import plan
from radmpc.program.allocation import uniform_allocation
from radmpc.program.build import build_program, condensed_models
from radmpc.solvers.branch.branch import Branch
from radmpc.solvers.solution import Limits, Outcome

EULER = LinearSystem(
    A=np.block([[np.eye(2), np.eye(2)], [np.zeros((2, 2)), np.eye(2)]]),
    B=np.vstack([np.zeros((2, 2)), np.eye(2)]),
    position=(0, 1),
    velocity=(2, 3),
)


def _vehicle(name, start, goal, **more):
    half = more.pop("half", 0.2)
    goal_speed = more.pop("goal_speed", np.full(2, 0.05))
    options = {
        "system": double_integrator(1.0, 2),
        "radius": 0.4,
        "control_limit": np.full(2, 2.0),
        "initial_covariance": 1e-3,
        "disturbance_covariance": 1e-3,
    }
    full = np.concatenate([start, np.zeros(4 - len(start))])
    goal = np.array(goal, float)
    return Vehicle(
        name=name,
        start=full,
        goal=Goal(goal - half, goal + half, goal_speed),
        **(options | more),
    )


def _scenario(*vehicles, **more):
    options = {"dt": 1.0, "horizon": 8, "risk_bound": 0.05, "avoidance": "intervals"}
    return Scenario(name="s", vehicles=vehicles, **(options | more))


@pytest.mark.parametrize("sigmas", [2.6, 2.8])
@pytest.mark.parametrize("planner", ["ira", "uniform", "radmpc", "multi-vehicle"])
def test_a_start_close_to_a_wall_is_paid_first_also_under_intervals(sigmas, planner):
    noise = np.diag([0.02, 0.02, 1e-6, 1e-6])
    vehicle = _vehicle("a", (0, 0), (6, 0), initial_covariance=noise, disturbance_covariance=1e-7)
    wall = Obstacle.box("wall", [-3, -1], [-0.4 - sigmas * np.sqrt(0.02), 1])
    result = plan(_scenario(vehicle, obstacles=(wall,)), planner)
    assert result.is_certified
    assert 0.002 < result.certificate.certified <= 0.05


@pytest.mark.slow
def test_a_stop_at_any_moment_is_a_limit_and_never_called_infeasible():
    scenario, found = paper(2, 0), []
    for count in (0, 1, 3, 6, 10, 20, 40, 200):
        calls = iter(range(10**6))
        result = plan(scenario, stop=lambda calls=calls, n=count: next(calls) >= n)
        assert result.plan is None or result.is_certified
        assert (result.plan is None) == (result.status is Status.LIMIT)
        found.append(result.status)
    # The first moment is before any plan, the last after its proof; infeasible is never said.
    assert found[0] is Status.LIMIT
    assert Status.FEASIBLE in found
    assert found[-1] is Status.OPTIMAL
    assert set(found) == {Status.LIMIT, Status.FEASIBLE, Status.OPTIMAL}


@pytest.mark.slow
def test_a_node_limit_is_a_limit_and_never_called_infeasible():
    for planner in (
        Planner(Pool(), Branch(1), Receding()),
        Planner(Ira(), Branch(1), Couplings()),
    ):
        result = plan(paper(3, 0), planner)
        assert result.status is Status.LIMIT
        assert "the searches ended at their limits of nodes" in result.explanation
    together = plan(paper(3, 0), Planner(Ira(), Branch(1), Centralized()))
    assert together.status is Status.FEASIBLE
    assert together.is_certified


def test_an_explanation_that_ran_out_of_time_says_so():
    text = explain_infeasible(
        paper(2, 1), Planner(Ira(), Branch(), Centralized()), Limits(deadline=0.0)
    )
    assert "a limit ended the search for the reason" in text


@pytest.mark.slow
def test_vehicles_that_meet_within_the_first_interval_are_coupled():
    common = {
        "radius": 0.25,
        "control_limit": np.full(2, 3.0),
        "half": 0.5,
        "goal_speed": None,
        "initial_covariance": 2e-4,
        "disturbance_covariance": 2e-4,
    }
    scenario = _scenario(
        _vehicle("a", (0.571, 1.97, 1.847, -0.597), (8.482, -1.778), **common),
        _vehicle("b", (1.886, 0.669, -0.153, 1.493), (0.312, 6.015), **common),
        horizon=6,
    )
    for seed in range(4):
        result = plan(scenario, "multi-vehicle", rng=seed)
        assert result.sets == (("a", "b"),)
        assert result.is_certified
        # Who goes first swerves as far as it can: clear at both ends, and hardly so between.
        assert result.couplings[0].value > 1e-5


def test_the_reach_at_the_start_is_the_start_however_fast_it_begins():
    vehicle = _vehicle("a", (0, 0, 3, 0), (2, 0), speed_limit=np.full(2, 1.0))
    behind = Obstacle.box("behind", [-2, -1], [-0.1, 1])
    scenario = _scenario(vehicle, obstacles=(behind,), horizon=1, avoidance="steps")
    [model] = condensed_models(scenario)
    assert model.reach_lower[0] == pytest.approx([0.0, 0.0])
    assert model.reach_upper[0] == pytest.approx([0.0, 0.0])
    program = build_program(scenario, [model], risk_bound=0.05)
    assert program.initial_risk > 0.5


def test_places_that_no_control_moves_are_allocated_once_per_face():
    scenario = _scenario(
        _vehicle("a", (0, 0, 1, 1), (6, 6), system=EULER, radius=0.3, initial_covariance=2e-3),
        obstacles=(Obstacle.box("corner", [2, -3], [5, -0.6]),),
    )
    program = build_program(scenario, condensed_models(scenario), risk_bound=0.05)
    allocation = uniform_allocation(program, program.budget)
    starts = program.avoidance_starts
    rng = np.random.default_rng(0)
    for _ in range(200):
        selection = np.array([rng.integers(a, b) for a, b in pairwise(starts)])
        events = np.unique(program.rows.events[program.selected_rows(selection)])
        paid = allocation[program.rows.risk_items[events]].sum()
        assert paid <= program.budget * (1 + 1e-9)


def test_an_obstacle_nobody_can_steer_around_yet_is_no_crash():
    scenario = _scenario(
        _vehicle("a", (0, 0, 1, 1), (6, 6), system=EULER, radius=0.3),
        _vehicle("b", (0, 20), (6, 20), system=EULER, radius=0.3),
        obstacles=(Obstacle.box("block", [0.9, 0.9], [1.1, 1.1]),),
        avoidance="steps",
    )
    result = plan(scenario, Planner(Sigmas(3.0), Branch(), Centralized()))
    assert result.status is Status.INFEASIBLE


@pytest.mark.slow
def test_a_vehicle_that_has_arrived_leaves_the_pool_to_those_that_travel():
    noise = np.diag([1e-3, 1e-3, 1e-4, 1e-4])
    calm = {"initial_covariance": noise, "disturbance_covariance": noise}
    resting = _vehicle("a", (0, 0), (0, 0), **calm)
    traveling = _vehicle("b", (30, 0), (36, 0), **calm)
    obstacles = (Obstacle.box("o", [1.1, -1], [2, 1]), Obstacle.box("p", [35, 1.2], [37, 2]))
    for seed in range(6):
        scenario = _scenario(resting, traveling, obstacles=obstacles, avoidance="steps")
        result = plan(scenario, "multi-vehicle", rng=seed)
        assert result.sets == (("a",), ("b",))
        assert result.events == ()


def test_pairs_that_start_too_close_are_charged_to_the_pool():
    scenario = _scenario(
        _vehicle("a", (0, 0), (8, 0), initial_covariance=0.01),
        _vehicle("b", (1.0, 0), (0, 8), initial_covariance=0.01),
        avoidance="steps",
    )
    result = plan(scenario, "radmpc")
    assert result.status is Status.INFEASIBLE
    assert "starts of vehicles 'a' and 'b' are too close" in result.explanation
    assert "a risk of 0.068, above risk_bound 0.05" in result.explanation


def test_an_obstacle_in_the_way_is_not_mistaken_for_one_on_the_goal():
    vehicle = _vehicle("a", (0, 0), (2, 0), control_limit=np.full(2, 9.0), goal_speed=None)
    scenario = _scenario(vehicle, obstacles=(Obstacle.box("o", [0.9, -3], [1.1, 3]),), horizon=1)
    result = plan(scenario, "ira")
    assert result.status is Status.INFEASIBLE
    assert "Vehicle 'a' and obstacle 'o' cannot be kept apart" in result.explanation


def test_a_set_that_waited_for_a_worker_does_not_restart_the_clock(tmp_path):
    task = SetTask(paper(2, 0), Planner(Ira(), Branch(), Centralized()), "sets")
    flag = tmp_path / "stop"
    assert _until(plan_set, task, time.time() - 1.0, str(flag)).outcome is Outcome.LIMIT
    assert _until(plan_set, task, time.time() + 60.0, str(flag)).outcome is Outcome.OPTIMAL


def test_a_stop_reaches_sets_that_are_planned_elsewhere():
    task = SetTask(
        replace(circle(10), avoidance="intervals"),
        Planner(Ira(), Branch(), Centralized()),
        "sets",
    )
    begun = time.monotonic()
    limits = Limits(is_stopped=lambda: time.monotonic() > begun + 0.3)
    with ThreadPoolExecutor(1) as executor:
        [answer] = run_sets([task], limits, executor, lambda done, total: None)
    assert answer.outcome in {Outcome.LIMIT, Outcome.FEASIBLE}


def test_rows_that_need_much_are_not_starved_by_a_uniform_start():
    workspace = Workspace(np.array([-1.0, -1.0]), np.array([9.0, 1.0]))
    noise = np.diag([0.004, 0.004, 0.0, 0.0])
    vehicle = _vehicle(
        "a",
        (0, 0),
        (8, 0.55),
        half=0.05,
        disturbance_covariance=noise,
        initial_covariance=0.0,
    )
    scenario = _scenario(vehicle, workspace=workspace, horizon=8, risk_bound=0.005)
    uniform = plan(scenario, "uniform")
    assert uniform.status is Status.INFEASIBLE
    assert "near are the workspace border" in uniform.explanation
    for planner in ("ira", "multi-vehicle"):
        assert plan(scenario, planner).is_certified


def test_a_vehicle_that_needs_more_than_its_share_gets_it_from_the_others():
    workspace = Workspace(np.array([-1.0, -9.0]), np.array([9.0, 1.0]))
    noise = {"disturbance_covariance": np.diag([0.004, 0.004, 0.0, 0.0]), "initial_covariance": 0.0}
    needy = _vehicle("a", (0, 0), (8, 0.56), half=0.05, **noise)
    easy = _vehicle("b", (0, -5), (8, -5), **noise)
    scenario = _scenario(needy, easy, workspace=workspace, risk_bound=0.005)
    result = plan(scenario, "multi-vehicle")
    assert result.is_certified
    assert result.sets == (("a", "b"),)


def test_a_start_inside_something_is_told_plainly():
    inside = Obstacle.box("o", [-1, -1], [0.2, 1])
    for avoidance in ("steps", "intervals"):
        scenario = _scenario(
            _vehicle("a", (0, 0), (6, 0)), obstacles=(inside,), avoidance=avoidance
        )
        text = plan(scenario, "multi-vehicle").explanation
        assert "start of vehicle 'a' lies within obstacle 'o'" in text
    outside = Workspace(np.array([1.0, -5.0]), np.array([9.0, 5.0]))
    text = plan(_scenario(_vehicle("a", (0, 0), (6, 0)), workspace=outside)).explanation
    assert "start of vehicle 'a' lies outside the workspace" in text


def test_deterministic_planners_refuse_to_start_inside_an_obstacle():
    scenario = _scenario(
        _vehicle("a", (0, 0), (6, 0)),
        obstacles=(Obstacle.box("o", [-1, -1], [0.2, 1]),),
        avoidance="steps",
    )
    result = plan(scenario, "dlp")
    assert result.status is Status.INFEASIBLE
    assert "start of vehicle 'a' lies within obstacle 'o'" in result.explanation


def test_more_deviations_than_programs_keep_are_refused():
    with pytest.raises(ScenarioError, match="sigmas must lie between 0 and 7"):
        Sigmas(8.0)


@pytest.mark.slow
def test_intervals_catch_what_steps_do_not():
    wall = Obstacle.box("wall", [3.9, -0.6], [4.1, 0.6])
    vehicle = _vehicle("a", (0, 0), (8, 0), radius=0.1, disturbance_covariance=1e-6)
    scenario = _scenario(vehicle, obstacles=(wall,), horizon=6)
    loose = plan(replace(scenario, avoidance="steps"), "ira")
    tight = plan(scenario, "ira")
    assert loose.cost < tight.cost
    assert tight.is_certified
