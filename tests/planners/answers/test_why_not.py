"""Scenarios without a plan: who is stuck, what bound would do, and what the rest could do."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest
from scipy.special import ndtr

from radmpc.experiments.families import paper
from radmpc.model.dynamics import double_integrator
from radmpc.model.noise.measurement import Measurement
from radmpc.model.noise.shared import SharedDisturbance
from radmpc.model.obstacle import Obstacle
from radmpc.model.plan import Status
from radmpc.model.scenario import Scenario
from radmpc.model.vehicle import Goal, Vehicle
from radmpc.planners import Centralized, Certified, Ira, Optimal, Planner
from radmpc.planners.certified import certified, fallbacks
from radmpc.planners.certified.infeasible.explanation import why_not
from radmpc.planners.certified.infeasible.least_risk import least_risk
from radmpc.planners.certified.phases import searching
from radmpc.planners.certified.search import PriceSearch
from radmpc.planners.certified.state.incumbent import FleetIncumbent
from radmpc.planners.cures.variants import with_noise
from radmpc.planners.outcome.record import Certifying
from radmpc.planners.planner import Run, no_listener
from radmpc.planning import plan
from radmpc.solvers.branch.branch import Branch
from radmpc.solvers.solution import Limits
from running import first_plan


def vehicle(name, start, goal, noise=1e-3):
    goal = np.array(goal, dtype=float)
    return Vehicle(
        name=name,
        system=double_integrator(1.0, 2),
        start=np.array([*start, 0.0, 0.0]),
        goal=Goal(goal - 0.2, goal + 0.2, np.full(2, 0.05)),
        radius=0.3,
        control_limit=np.full(2, 2.0),
        speed_limit=np.full(2, 3.0),
        initial_covariance=1e-3,
        disturbance_covariance=noise,
    )


def scenario(*vehicles, obstacles=(), risk_bound=0.05):
    return Scenario(
        name="why-not",
        dt=1.0,
        horizon=10,
        risk_bound=risk_bound,
        vehicles=vehicles,
        obstacles=obstacles,
        avoidance="intervals",
    )


def wall_with_gap(width):
    return (
        Obstacle.box("north", [4.5, 0.5 * width], [5.5, 30.0]),
        Obstacle.box("south", [4.5, -30.0], [5.5, -0.5 * width]),
    )


def far(name="far"):
    return vehicle(name, (0, 60), (4, 60))


@pytest.mark.slow
def test_a_vehicle_behind_a_wall_is_told_how_long_the_way_around_takes_and_the_rest_can_go():
    result = plan(
        scenario(vehicle("a", (0, 0), (10, 0)), far(), obstacles=wall_with_gap(0.1)), "certified"
    )
    assert result.status is Status.INFEASIBLE
    assert "Vehicle 'a' cannot be at its goal by step 10" in result.explanation
    assert "around obstacles that takes 22 steps (22 s) at least" in result.explanation
    assert "The other vehicle can be planned" in result.explanation


def test_every_goal_out_of_reach_is_named_and_the_rest_can_go():
    slow = [vehicle(name, (0, y), (100, y)) for name, y in (("a", 0), ("c", 30))]
    result = plan(scenario(*slow, far("b")), "certified")
    assert result.status is Status.INFEASIBLE
    for name in "ac":
        assert f"Vehicle '{name}' cannot reach its goal within 10 steps" in result.explanation
    assert "The other vehicle can be planned" in result.explanation


def test_two_conflicts_do_not_hide_each_other():
    one = [vehicle("a", (0, 0), (4, 0)), vehicle("b", (8, 0), (4, 0))]
    two = [vehicle("c", (0, 30), (4, 30)), vehicle("d", (8, 30), (4, 30))]
    text = plan(scenario(*one, *two, far()), "certified").explanation
    assert "goals of vehicles 'a' and 'b' are too close" in text
    assert "goals of vehicles 'c' and 'd' are too close" in text
    assert "The other vehicle can be planned" in text


@pytest.mark.nightly
@pytest.mark.slow
def test_the_bound_that_is_proposed_would_do_and_a_smaller_one_than_proven_would_not():
    problem = scenario(
        vehicle("a", (0, 0), (10, 0), noise=4e-3),
        far(),
        obstacles=wall_with_gap(1.0),
        risk_bound=1e-3,
    )
    result = plan(problem, "certified")
    assert result.plan is None  # with more faces than were searched there might be one
    assert "vehicle 'a' and obstacle" in result.explanation
    found = least_risk(problem, Limits())
    assert problem.risk_bound < found.bound <= found.risk < 0.49
    assert found.risk <= 1.05 * found.bound
    assert plan(replace(problem, risk_bound=1.02 * found.risk), "certified").is_certified
    below = replace(problem, risk_bound=0.95 * found.bound)
    # The bound is one on simple bounds: along intervals the referee may certify less.
    by_simple_bounds = Planner(Ira(), Branch(), Centralized())
    assert plan(below, by_simple_bounds).status is Status.INFEASIBLE


def beside_a_wall(sigmas, risk_bound, avoidance):
    """A vehicle that starts so many deviations clear of a long wall and goes away from it."""
    away = 0.3 + sigmas * np.sqrt(1e-3)
    wall = Obstacle.box("wall", [-3.0, -1.0], [-away, 1.0])
    problem = scenario(
        vehicle("a", (0, 0), (10, 0)), far(), obstacles=(wall,), risk_bound=risk_bound
    )
    return replace(problem, avoidance=avoidance)


@pytest.mark.parametrize("sigmas", [2.0, 2.5])
def test_where_simple_bounds_are_exact_no_planner_has_a_plan_below_the_proven_bound(sigmas):
    problem = beside_a_wall(sigmas, 1e-3, "steps")
    found = least_risk(problem, Limits())
    assert found.bound == pytest.approx(ndtr(-sigmas), rel=1e-6)
    enough = plan(replace(problem, risk_bound=1.02 * found.risk), "certified")
    assert enough.is_certified
    assert enough.certificate.certified >= found.bound * (1.0 - 1e-6)
    below = replace(problem, risk_bound=0.99 * found.bound)
    for planner in ("certified", Planner(Ira(), Branch(), Centralized())):
        assert plan(below, planner).status is Status.INFEASIBLE


def test_along_intervals_no_plan_is_certified_below_what_its_start_runs():
    alone = float(ndtr(-2.0))
    below = plan(beside_a_wall(2.0, 0.99 * alone, "intervals"), "certified")
    assert below.status is Status.INFEASIBLE
    assert "start of vehicle 'a' is too close to obstacle 'wall'" in below.explanation
    above = plan(beside_a_wall(2.0, 1.25 * alone, "intervals"), "certified")
    assert above.is_certified
    assert alone <= above.certificate.certified <= 1.25 * alone


def test_the_least_risk_of_a_fleet_is_what_a_plan_with_it_runs():
    problem = paper(3, 2)
    found = least_risk(problem, Limits())
    assert 0.0 <= found.bound <= found.risk <= 1e-3
    assert not found.stuck
    assert len(found.controls) == 3


@pytest.mark.parametrize("is_stopped", [True, False])
def test_a_limit_before_any_plan_says_so(is_stopped):
    problem = scenario(vehicle("a", (0, 0), (10, 0)), obstacles=wall_with_gap(1.0))
    limits = {"stop": lambda: True} if is_stopped else {"time_limit": 0.0}
    result = plan(problem, "certified", **limits)
    assert result.status is Status.LIMIT
    assert result.plan is None
    assert result.explanation


def test_starts_in_conflict_are_named_and_the_rest_can_go():
    problem = scenario(vehicle("a", (0, 0), (8, 0)), vehicle("b", (0.63, 0), (0, 8)), far())
    for avoidance in ("steps", "intervals"):
        result = plan(replace(problem, avoidance=avoidance), "certified")
        assert result.status is Status.INFEASIBLE
        assert "'a' and 'b'" in result.explanation
        assert "The other vehicle can be planned" in result.explanation


def test_a_start_within_an_obstacle_does_not_hide_the_rest():
    rock = Obstacle.box("rock", [-1, -1], [1, 1])
    result = plan(scenario(vehicle("a", (0, 0), (8, 0)), far(), obstacles=(rock,)), "certified")
    assert "start of vehicle 'a' lies within obstacle 'rock'" in result.explanation
    assert "The other vehicle can be planned" in result.explanation


@pytest.mark.slow
def test_the_safest_plan_found_on_the_way_is_returned_if_the_referee_certifies_it(monkeypatch):
    monkeypatch.setattr(searching, "first_plan", lambda *_, **__: FleetIncumbent())
    # As where simple bounds see no plan at all: the search for the reason finds the safest one.
    monkeypatch.setattr(PriceSearch, "run", lambda self, state: state)
    monkeypatch.setattr(certified, "bound_faces_of_each", lambda fleet, state, *_: state)
    monkeypatch.setattr(fallbacks, "turn_from_noiseless", lambda fleet, state, judge: state)
    result = plan(paper(3, 2), "certified")
    assert result.status is Status.FEASIBLE
    assert result.is_certified
    assert result.explanation is None
    effort = sum(float(np.abs(t.controls).sum()) for t in result.require().trajectories)
    assert result.cost == pytest.approx(effort)


@pytest.mark.nightly
def test_noise_that_leaves_no_room_anywhere_is_named_before_what_stands_there():
    noise = np.array([0.05, 0.05, 1e-6, 1e-6])
    wild = vehicle("a", (0, 0), (10, 0), noise=noise)
    result = plan(scenario(wild, obstacles=wall_with_gap(1.0)), time_limit=20.0)
    assert result.plan is None
    assert "without noise there is one" in result.explanation
    assert "What helps, as tried: reduce the noise to" in result.explanation


def test_less_noise_is_less_of_what_obstacles_stray_too():
    track = Obstacle.tracked("barge", [[0, 5], [1, 5], [1, 6]], [0, 0, 0.1, 0], 0.5, 0.02)
    noisy = scenario(vehicle("a", (0, 0), (10, 0)), obstacles=(track,))
    quiet = with_noise(noisy, 0.25)
    spreads = [s.obstacles[0].spread.positions for s in (noisy, quiet)]
    assert spreads[1] == pytest.approx(0.25 * spreads[0])
    assert quiet.obstacles[0].steps[3][0].vertices == pytest.approx(
        noisy.obstacles[0].steps[3][0].vertices
    )
    assert quiet.vehicles[0].disturbance_covariance == pytest.approx(
        0.25 * noisy.vehicles[0].disturbance_covariance
    )


@pytest.mark.slow
def test_a_start_too_close_to_a_wall_is_told_where_it_could_be_and_there_it_has_a_plan():
    problem = beside_a_wall(1.5, 1e-2, "steps")
    text = plan(problem, "certified").explanation
    told = re.search(r"move the start of 'a' to \(([^()]+)\)", text)
    assert told is not None, text
    first, *others = problem.vehicles
    start = first.start.copy()
    start[:2] = [float(x) for x in told[1].split(",")]
    moved = replace(problem, vehicles=(replace(first, start=start), *others))
    assert first_plan(moved, time_limit=20.0).is_certified


def test_less_noise_is_less_of_what_is_shared_and_measured_too():
    gust = SharedDisturbance("gust", np.eye(4), 1e-3 * np.eye(4))
    one = replace(
        vehicle("a", (0, 0), (10, 0)), shared=(gust,), measurement=Measurement.of([0, 1], 4, 0.01)
    )
    quiet = with_noise(scenario(one), 0.25).vehicles[0]
    assert quiet.shared[0].covariance == pytest.approx(0.25 * gust.covariance)
    assert quiet.measurement.covariance == pytest.approx(0.25 * one.measurement.covariance)


def test_what_a_search_along_intervals_rules_out_is_said_to_hold_of_whole_steps():
    blocked = scenario(vehicle("a", (0, 0), (10, 0)), obstacles=wall_with_gap(0.1))
    found = why_not(replace(blocked, avoidance="intervals"), Limits())
    assert found.is_proven
    assert not found.rules_out_any
    assert "on one side over a whole step" in found.explanation


def test_of_goals_out_of_reach_nothing_is_said_of_whole_steps():
    late = replace(scenario(vehicle("a", (0, 0), (1000, 0))), avoidance="intervals")
    found = why_not(late, Limits())
    assert found.is_proven
    assert found.rules_out_any
    assert "whole step" not in found.explanation


@pytest.mark.parametrize("limits", [{}, {"speed_norm": 3.0}])
def test_drafts_tell_whether_their_proof_holds_of_any_plan(limits):
    planner = Planner(Optimal(), Branch(), Certified(0.0))

    def drafted(one):
        judge = Certifying(one, planner).judge
        run = Run(np.random.default_rng(0), Limits(), None, no_listener, judge, no_listener)
        return planner.decomposition.plan(one, planner, run)

    late = drafted(scenario(replace(vehicle("a", (0, 0), (1000, 0)), **limits)))
    assert late.status is Status.INFEASIBLE
    assert late.rules_out_any
    free = drafted(scenario(replace(vehicle("a", (0, 0), (4, 0)), **limits)))
    assert not free.rules_out_any
