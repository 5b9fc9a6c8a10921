"""What a random tree finds satisfies the program; what it does not find it does not deny."""

from __future__ import annotations

import time
from dataclasses import replace

import numpy as np
import pytest
from problems import random_problem

from radmpc.errors import ScenarioError
from radmpc.experiments.families import circle, clutter, paper
from radmpc.model.dynamics import LinearSystem, double_integrator
from radmpc.model.obstacle import Obstacle
from radmpc.model.plan import Status
from radmpc.model.scenario import Scenario
from radmpc.model.vehicle import Goal, Vehicle
from radmpc.planners import (
    Centralized,
    Certified,
    Couplings,
    Distance,
    Ira,
    NoRisk,
    Optimal,
    Planner,
    Pool,
    Receding,
    Sigmas,
    Uniform,
)
from radmpc.planners.presets import parse_planner
from radmpc.planning import plan
from radmpc.program.allocation import margins_of
from radmpc.program.build import build_program, condensed_models
from radmpc.solvers.branch.branch import Branch
from radmpc.solvers.rrt.rrt import Rrt
from radmpc.solvers.rrt.shortcuts import _basis
from radmpc.solvers.solution import Limits, Outcome

FINDS = [0, 1, 3, 4, 7, 9, 12, 14, 15, 16]
MISSES = [5, 6]
"""Tight ones, which Branch solves."""

IMPOSSIBLE = [2, 8]
"""Ones that Branch proves to have no solution."""

TOL = 1e-6


def _program(scenario):
    return build_program(scenario, condensed_models(scenario), risk_bound=scenario.risk_bound)


def _problem(seed):
    scenario = random_problem(seed)
    program = _program(scenario)
    risk = scenario.risk_bound / (6 * scenario.horizon)
    return program, margins_of(program, np.full(len(program.risk_items), risk))


def _solve(program, margins, solver=None, limits=None, rng=None):
    return (solver or Rrt()).solve(program, margins, gap=1e-3, limits=limits or Limits(), rng=rng)


def _assert_holds(program, margins, solution):
    z, selection = solution.z, solution.selection
    assert np.all((z >= program.lower - TOL) & (z <= program.upper + TOL))
    hard = program.hard.toarray() @ z
    assert np.all((hard >= program.hard_lower - TOL) & (hard <= program.hard_upper + TOL))
    outputs = program.outputs.toarray() @ z + program.constant
    over = program.rows.normals.toarray() @ outputs + margins - program.rows.offsets
    for avoidance, alternative in enumerate(selection):
        assert alternative in program.alternatives_of(avoidance)
        assert np.all(over[program.rows_of(alternative)] <= TOL)
    assert solution.cost == pytest.approx(program.cost @ z)


def _box(limit=2.0, **more):
    """One vehicle that must get around a box."""
    vehicle = Vehicle(
        name="a",
        system=double_integrator(1.0, 2),
        start=np.zeros(4),
        goal=Goal(np.array([7.8, -0.2]), np.array([8.2, 0.2]), np.full(2, 0.05)),
        radius=0.3,
        control_limit=np.full(2, limit),
        initial_covariance=1e-3,
        disturbance_covariance=1e-3,
    )
    return Scenario(
        name="box",
        dt=1.0,
        horizon=10,
        risk_bound=0.05,
        vehicles=(replace(vehicle, **more),),
        obstacles=(Obstacle.box("o", np.array([3.0, -1.0]), np.array([5.0, 1.0])),),
    )


@pytest.mark.slow
@pytest.mark.sampled(3)
@pytest.mark.parametrize("seed", FINDS)
def test_a_point_satisfies_every_row_at_its_margin_and_costs_no_less_than_the_least(seed):
    program, margins = _problem(seed)
    found = _solve(program, margins)
    assert found.outcome is Outcome.FEASIBLE
    _assert_holds(program, margins, found)
    proven = _solve(program, margins, Branch())
    assert found.cost >= proven.bound * (1 - 1e-6)
    assert found.cost <= 1.6 * proven.cost
    assert found.bound == 0.0


@pytest.mark.slow
@pytest.mark.sampled(2)
@pytest.mark.parametrize("seed", MISSES + IMPOSSIBLE)
def test_what_it_does_not_find_it_does_not_deny(seed):
    program, margins = _problem(seed)
    assert (_solve(program, margins, Branch()).z is None) == (seed in IMPOSSIBLE)
    missed = _solve(program, margins, Rrt(max_nodes=40))
    assert missed.outcome is Outcome.LIMIT
    assert missed.z is None
    assert missed.selection is None
    assert missed.cost == np.inf
    assert missed.bound == 0.0


@pytest.mark.parametrize("avoidance", ["steps", "intervals"])
@pytest.mark.parametrize("seed", range(4))
def test_problems_of_the_papers_kind_are_solved_close_to_the_least_cost(avoidance, seed):
    program = _program(replace(paper(1, seed), avoidance=avoidance))
    margins = 3.0 * program.rows.deviations
    found = _solve(program, margins)
    _assert_holds(program, margins, found)
    assert found.cost <= 1.25 * _solve(program, margins, Branch()).cost


def test_several_blocks_are_planned_around_each_other():
    program = _program(circle(4))
    margins = 3.0 * program.rows.deviations
    found = _solve(program, margins)
    assert any(e.cause == "pair" for e in program.avoidances)
    _assert_holds(program, margins, found)


def test_a_long_horizon_among_many_boxes_is_no_trouble():
    program = _program(clutter(1, 15, 0))
    margins = 3.0 * program.rows.deviations
    _assert_holds(program, margins, _solve(program, margins, Rrt(max_nodes=60)))


def test_it_finds_ways_in_space_too():
    wall = Obstacle.box("wall", [4.0, -3.0, -3.0], [4.5, 3.0, 1.5])
    vehicle = Vehicle(
        name="a",
        system=double_integrator(1.0, 3),
        start=np.zeros(6),
        goal=Goal(np.array([8.8, -0.2, -0.2]), np.array([9.2, 0.2, 0.2]), np.full(3, 0.1)),
        radius=0.4,
        control_limit=np.full(3, 3.0),
        initial_covariance=1e-3,
        disturbance_covariance=1e-3,
    )
    for avoidance in ("steps", "intervals"):
        program = _program(Scenario("s", 1.0, 6, 0.05, (vehicle,), (wall,), avoidance=avoidance))
        margins = 3.0 * program.rows.deviations
        found = _solve(program, margins)
        _assert_holds(program, margins, found)
        assert found.cost <= 1.3 * _solve(program, margins, Branch()).cost


def test_a_vehicle_whose_places_answer_late_is_planned_as_well():
    eye, zero = np.eye(2), np.zeros((2, 2))
    A = np.block([[eye, eye], [zero, 0.9 * eye]])
    B = np.vstack([np.zeros((2, 3)), np.array([[1.0, 0.3, 0.0], [0.0, 0.3, 1.0]])])
    late = LinearSystem(A, B, position=(0, 1), velocity=(2, 3))
    program = _program(_box(system=late, control_limit=np.full(3, 2.0)))
    margins = 3.0 * program.rows.deviations
    found = _solve(program, margins)
    _assert_holds(program, margins, found)
    assert found.cost >= _solve(program, margins, Branch()).bound * (1 - 1e-6)


def test_a_goal_that_is_a_point_is_met():
    point = np.array([8.0, 0.0])
    program = _program(_box(goal=Goal(point, point, np.zeros(2))))
    margins = 3.0 * program.rows.deviations
    _assert_holds(program, margins, _solve(program, margins))


def test_one_step_and_a_vehicle_that_has_arrived_are_planned_without_a_tree():
    scenario = replace(_box(), horizon=1, obstacles=())
    there = replace(scenario.vehicles[0], start=np.array([8.0, 0.0, 0.0, 0.0]))
    program = _program(replace(scenario, vehicles=(there,)))
    found = _solve(program, np.zeros(program.rows.count))
    assert found.outcome is Outcome.OPTIMAL
    assert found.cost == found.bound == 0.0


def test_the_same_seed_gives_the_same_point_and_another_may_not():
    program = _program(_box())
    margins = 3.0 * program.rows.deviations
    first, second = (_solve(program, margins, rng=np.random.default_rng(3)) for _ in range(2))
    assert np.array_equal(first.z, second.z)
    others = [_solve(program, margins, rng=np.random.default_rng(seed)).z for seed in (4, 5)]
    assert any(not np.array_equal(first.z, other) for other in others)


def test_more_nodes_grow_larger_trees_within_their_number():
    program = _program(_box())
    margins = 3.0 * program.rows.deviations
    small, large = (_solve(program, margins, Rrt(max_nodes=n)) for n in (20, 200))
    assert small.nodes <= 20 < large.nodes <= 200


def test_a_limit_ends_it_with_what_it_has():
    program = _program(_box())
    margins = 3.0 * program.rows.deviations
    past = _solve(program, margins, limits=Limits(deadline=time.monotonic() - 1.0))
    assert past.outcome is Outcome.LIMIT
    assert past.z is None
    asked = iter(range(10**6))
    soon = _solve(program, margins, Rrt(10**5), Limits(is_stopped=lambda: next(asked) >= 60))
    assert soon.outcome is Outcome.FEASIBLE
    # It stops within a few questions of the one that was answered yes, far from its most nodes.
    assert 60 < next(asked) < 70
    assert soon.nodes < 10**4


def test_what_limits_exclude_is_infeasible():
    program = _program(_box())
    none = np.zeros(program.rows.count)
    blocked = replace(
        program,
        avoidances=(*program.avoidances, program.avoidances[-1]),
        avoidance_starts=np.append(program.avoidance_starts, program.num_alternatives),
    )
    assert _solve(blocked, none).outcome is Outcome.INFEASIBLE
    assert _solve(program, none + 100.0).outcome is Outcome.INFEASIBLE
    weak = _program(_box(limit=0.05))
    assert _solve(weak, np.zeros(weak.rows.count)).outcome is Outcome.INFEASIBLE


@pytest.mark.slow
@pytest.mark.sampled(1)
@pytest.mark.parametrize("seed", range(2))
def test_the_planner_keeps_limits_and_goals_and_is_judged(seed):
    result = plan(paper(2, seed), "rmpc-rrt")
    assert result.status is Status.FEASIBLE
    assert result.certificate.problems == ()
    assert result.certificate.certified > 0.0
    assert result.plan.lower_bound is None
    assert result.plan.planner == "sigmas(3), rrt, receding"


def test_the_seed_of_the_plan_seeds_the_trees_and_the_record_stays_as_it_is():
    planner = Planner(Sigmas(3.0), Rrt(60), Centralized())
    plans = [plan(_box(), planner, rng=seed) for seed in (1, 1, 2, 3)]
    controls = [p.plan.trajectories[0].controls for p in plans]
    assert np.array_equal(controls[0], controls[1])
    assert any(not np.array_equal(controls[0], c) for c in controls[2:])
    assert {p.plan.planner for p in plans} == {"sigmas(3), rrt(max_nodes=60), centralized"}


@pytest.mark.slow
def test_it_plans_whole_fleets_and_sets_under_every_policy_that_needs_no_proof():
    for policy in (NoRisk(), Sigmas(2.0), Uniform()):
        for decomposition in (Centralized(), Distance(3.0)):
            result = plan(paper(2, 0), Planner(policy, Rrt(200), decomposition))
            assert result.status is Status.FEASIBLE
            assert result.certificate.problems == ()


def test_choices_that_need_a_proven_solve_are_refused_in_one_line():
    with pytest.raises(ScenarioError, match="solver 'rrt' does not go with the policy 'ira'"):
        Planner(Ira(), Rrt(), Centralized())
    with pytest.raises(ScenarioError, match="the policy 'pool'"):
        Planner(Pool(), Rrt(), Receding())
    with pytest.raises(ScenarioError, match="needs the solver Branch, got 'rrt'"):
        Planner(Optimal(), Rrt(), Certified())
    with pytest.raises(ScenarioError, match="with the decomposition 'couplings"):
        Planner(Sigmas(), Rrt(), Couplings())
    with pytest.raises(ScenarioError, match="max_nodes must be at least 1, got 0"):
        Rrt(max_nodes=0)


def test_the_preset_takes_a_number_of_deviations():
    assert str(parse_planner("rmpc-rrt(2)")) == "sigmas(2), rrt, receding"


@pytest.mark.parametrize("rank", [0, 1, 4, 7])
def test_the_basis_of_what_is_seen_later_spans_it_and_nothing_else(rank):
    rng = np.random.default_rng(rank)
    rows = rng.normal(size=(40, rank)) @ rng.normal(size=(rank, 12)) * 1e-3
    basis = _basis(rows)
    assert basis.shape == (rank, 12)
    assert np.allclose(basis @ basis.T, np.eye(rank), atol=1e-12)
    assert np.allclose(rows @ basis.T @ basis, rows, atol=1e-14)
