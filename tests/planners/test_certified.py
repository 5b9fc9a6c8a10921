"""The certified planner: what it promises of plan, bound and certificate."""

from __future__ import annotations

import pickle
from concurrent.futures import BrokenExecutor, Executor, Future, ProcessPoolExecutor
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from radmpc.errors import ArgumentTypeError, ScenarioError
from radmpc.experiments.families import circle, clutter, fleet, paper
from radmpc.model.dynamics import double_integrator
from radmpc.model.obstacle import Obstacle
from radmpc.model.plan import Status
from radmpc.model.scenario import Scenario
from radmpc.model.vehicle import Goal, Vehicle
from radmpc.planners import Centralized, Certified, Ira, Optimal, Planner, Uniform
from radmpc.planners.certified.inter_set_risk import inter_set_risks
from radmpc.planning import plan
from radmpc.referee import certify, simulate
from radmpc.solvers.branch.branch import Branch
from radmpc.solvers.milp.big_m import BigM


def plan_asked(scenario, times):
    """Return the answer of a planner that is stopped when it asks for the n-th time.

    Unlike a time limit this ends every machine's search at the same place.
    """
    asked = iter(range(10**9))
    return plan(scenario, "certified", stop=lambda: next(asked) >= times)


@pytest.mark.slow
@pytest.mark.sampled(2)
@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("num_vehicles", [2, 4, 6])
def test_plans_are_certified_and_proven(num_vehicles, seed):
    result = plan(paper(num_vehicles, seed), "certified")
    assert result.status is Status.OPTIMAL
    assert certify(result.require()).holds
    assert result.lower_bound <= result.cost <= result.lower_bound * (1.0 + 1.1e-3)
    everyone = sorted(name for members in result.sets for name in members)
    assert everyone == sorted(v.name for v in paper(num_vehicles, seed).vehicles)


@pytest.mark.parametrize("seed", range(3))
def test_no_plan_of_iterative_risk_allocation_is_below_the_bound(seed):
    scenario = paper(3, seed)
    proven = plan(scenario, "certified")
    other = plan(scenario, Planner(Ira(), Branch(), Centralized()))
    assert proven.lower_bound <= other.cost * (1.0 + 1e-9)
    assert proven.cost <= other.cost * (1.0 + 1e-3)


@pytest.mark.slow
def test_more_risk_never_costs_more():
    scenario = paper(3, 5)
    found = [
        plan(replace(scenario, risk_bound=bound), "certified") for bound in (1e-3, 0.01, 0.05, 0.2)
    ]
    for less, more in pairwise(found):
        assert more.lower_bound <= less.cost
        assert more.cost <= less.cost * (1.0 + 1e-3)


@pytest.mark.slow
def test_flights_collide_no_more_often_than_granted():
    result = plan(paper(6, 1), "certified")
    simulation = simulate(result.require(), 20_000, rng=1)
    assert simulation.rate_low <= result.certificate.certified <= 0.05


@pytest.mark.slow
def test_a_fleet_keeps_every_vehicle_through_all_merges():
    result = plan(fleet(16, 0), "certified")
    assert result.is_certified
    assert len(result.require().trajectories) == 16
    assert max(len(s) for s in result.sets) < 16


class _DyingExecutor(Executor):
    """Runs its first task and dies, as a pool does whose worker was killed."""

    def __init__(self):
        self._count = 0

    def submit(self, task, /, *args, **more):
        self._count += 1
        if self._count > 3:
            raise BrokenExecutor
        future = Future()
        if self._count == 1:
            future.set_result(task(*pickle.loads(pickle.dumps(args)), **more))
        else:
            future.set_exception(BrokenExecutor())
        return future


@pytest.mark.slow
def test_the_plan_does_not_depend_on_who_searches_nor_on_workers_that_die():
    scenario = paper(6, 3)
    here = plan(scenario, "certified(0)")
    with ProcessPoolExecutor(2) as pool:
        others = [plan(scenario, "certified(0)", executor=e) for e in (pool, _DyingExecutor())]
    for other in others:
        assert other.sets == here.sets
        assert other.cost == here.cost
        assert other.lower_bound == here.lower_bound


@pytest.mark.slow
def test_plans_along_intervals_are_certified():
    result = plan(clutter(1, 40, 4), "certified")
    assert result.is_certified
    assert result.lower_bound <= result.cost


def test_no_bound_is_told_that_the_best_plan_is_below():
    told = []
    scenario = replace(paper(2, 3), avoidance="intervals")
    # Half-spaces turned to it make the first plan cheaper than any by the faces of the scenario.
    plan(scenario, "certified(0)", found=lambda cost, bound: told.append((cost, bound)))
    assert all(bound is None or bound <= cost for cost, bound in told)
    costs = [cost for cost, _ in told]
    assert costs == sorted(costs, reverse=True)


def test_the_best_plan_so_far_is_told_while_planning():
    told = []
    result = plan(paper(3, 0), "certified", found=lambda cost, bound: told.append((cost, bound)))
    assert told
    assert min(cost for cost, _ in told) >= result.cost
    assert all(bound is None or bound <= cost for cost, bound in told)
    with pytest.raises(ArgumentTypeError, match="found must be a function or None, got 3"):
        plan(paper(3, 0), "certified", found=3)


def test_better_plans_are_handed_out_with_their_certificates():
    plans = []
    alone = plan(paper(3, 0), "certified")
    result = plan(paper(3, 0), "certified", improved=plans.append)
    costs = [one.cost for one in plans]
    assert costs == sorted(costs, reverse=True)
    assert len(set(costs)) == len(costs)
    assert costs[-1] == result.cost == alone.cost
    for one in plans:
        assert one.risk.certified == certify(one).certified
        assert one.risk.certified <= one.scenario.risk_bound
    for ours, theirs in zip(result.plan.trajectories, alone.plan.trajectories, strict=True):
        np.testing.assert_array_equal(ours.controls, theirs.controls)
    with pytest.raises(ArgumentTypeError, match="improved must be a function or None, got 3"):
        plan(paper(3, 0), "certified", improved=3)


@pytest.mark.slow
def test_a_limit_returns_a_certified_plan_or_none_with_a_reason():
    early, later = plan_asked(circle(8), 3), plan_asked(paper(2, 0), 20)
    for result in (early, later):
        assert result.plan is None or result.is_certified
        assert (result.plan is None) == bool(result.explanation)
    assert (early.status, later.status) == (Status.LIMIT, Status.FEASIBLE)


@pytest.mark.slow
def test_what_ended_the_search_is_told_with_the_plan(monkeypatch):
    # The time is up once there is a plan, however busy the machine.
    passed = [0.0]
    with monkeypatch.context() as patch:
        patch.setattr("time.monotonic", lambda: passed[-1])
        result = plan(
            circle(8), "certified", time_limit=3.0, found=lambda cost, bound: passed.append(4.0)
        )
    assert result.is_certified
    assert result.record.stopped_by == "the time limit of 3 s was reached"
    assert "but the time limit of 3 s was reached" in result.record.status_sentence
    assert "feasible (the time limit of 3 s was reached)" in repr(result)
    nothing = plan(paper(8, 0), "certified", time_limit=0.0)
    assert nothing.status is Status.LIMIT
    assert nothing.plan is None


def test_a_goal_out_of_reach_is_named():
    scenario = paper(3, 0)
    first = scenario.vehicles[0]
    far = replace(
        first, goal=Goal(np.array([90.0, 90.0]), np.array([91.0, 91.0]), first.goal.speed)
    )
    result = plan(replace(scenario, vehicles=(far, *scenario.vehicles[1:])), "certified")
    assert result.status is Status.INFEASIBLE
    assert repr(first.name) in result.explanation
    assert "cannot reach its goal" in result.explanation


def test_a_start_within_an_obstacle_is_named():
    scenario = paper(2, 0)
    at = scenario.vehicles[1].start_position
    box = Obstacle.box("crate", at - 0.5, at + 0.5)
    result = plan(replace(scenario, obstacles=(*scenario.obstacles, box)), "certified")
    assert result.status is Status.INFEASIBLE
    assert "crate" in result.explanation


def test_the_policy_and_the_decomposition_need_each_other():
    for choices in (
        (Optimal(), Branch(), Centralized()),
        (Uniform(), Branch(), Certified()),
        (Optimal(), BigM(), Certified()),
    ):
        with pytest.raises(ScenarioError, match=r"optimal|certified"):
            Planner(*choices)


def test_risk_between_sets_counts_each_pair_once_and_none_within_a_set():
    scenario = circle(4)
    models = [v.start_position for v in scenario.vehicles]
    goals = [v.goal.center for v in scenario.vehicles]
    share = np.linspace(0.0, 1.0, 11)[:, None]
    means = np.array([a + share * (b - a) for a, b in zip(models, goals, strict=True)])
    noise = np.array([v.covariances(10)[:, :2, :2] for v in scenario.vehicles])
    apart = inter_set_risks(scenario, means, noise, np.arange(4))
    assert set(apart) == {(0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)}
    assert min(apart.values()) >= 0.5  # all meet in the middle
    together = inter_set_risks(scenario, means, noise, np.array([0, 0, 1, 1]))
    assert together == {
        (0, 1): pytest.approx(sum(apart[p] for p in [(0, 2), (0, 3), (1, 2), (1, 3)]))
    }
    assert inter_set_risks(scenario, means, noise, np.zeros(4, dtype=int)) == {}


@pytest.mark.slow
@pytest.mark.sampled(1)
@pytest.mark.parametrize("scenario", [paper(5, 2), paper(6, 5), paper(8, 9)], ids=lambda s: s.name)
def test_what_the_referee_leaves_of_the_bound_is_spent(scenario):
    result = plan(scenario, "certified")
    assert 0.8 * scenario.risk_bound <= result.certificate.certified <= scenario.risk_bound
    assert result.status is Status.OPTIMAL


@pytest.mark.slow
def test_sides_that_the_referee_rates_above_the_bound_do_not_end_the_search():
    # At the budget that most problems afford, this one's best sides are rated above Δ.
    result = plan(paper(7, 7), "certified")
    assert result.status is Status.OPTIMAL
    assert result.is_certified


@pytest.mark.slow
def test_a_tangled_set_has_a_certified_plan_long_before_its_proof():
    result = plan_asked(circle(8), 1_000)
    assert result.status is Status.FEASIBLE
    assert result.is_certified
    assert result.cost <= 1.12 * result.lower_bound


@pytest.mark.slow
@pytest.mark.sampled(1)
@pytest.mark.parametrize("scenario", [paper(6, 2), paper(8, 2)], ids=lambda s: s.name)
def test_the_price_of_risk_tells_what_more_of_it_saves(scenario):
    found = plan(scenario, "certified")
    more = plan(replace(scenario, risk_bound=1.2 * scenario.risk_bound), "certified")
    predicted = 0.2 * scenario.risk_bound * found.record.risk.price
    assert predicted == pytest.approx(found.cost - more.cost, rel=0.6)


def test_where_risk_does_not_limit_the_plan_its_price_is_nothing():
    assert plan(paper(2, 1), "certified").record.risk.price == 0.0
    assert plan(paper(2, 1), "radmpc").record.risk.price is None


def gate(half_width):
    noise = np.diag([1e-3, 1e-3, 1e-4, 1e-4])
    goal = Goal(np.array([25.0, 0.0]), np.array([25.0, 0.0]), np.zeros(2))
    rover = Vehicle(
        "rover", double_integrator(1.0, 2), np.zeros(4), goal, 0.4, np.ones(2), noise, noise
    )
    posts = (
        Obstacle.box("north", [11.5, half_width], [13.5, 4.0]),
        Obstacle.box("south", [11.5, -4.0], [13.5, -half_width]),
    )
    return Scenario("gate", 1.0, 25, 0.05, (rover,), posts)


@pytest.mark.slow
def test_through_a_wider_gate_no_plan_costs_more():
    # Some widths leave one way whose risk, a little above the bound, no small price moves.
    costs = [plan(gate(half), "certified").cost for half in (1.03, 1.05, 1.1, 1.15)]
    assert all(wider <= narrower * 1.002 for narrower, wider in pairwise(costs))
