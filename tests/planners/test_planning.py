"""Planners end to end: what they promise, and what they say when they cannot."""

from __future__ import annotations

from collections import defaultdict
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from small_problems import mover, scene_of

from radmpc.errors import NoPlanError, ScenarioError
from radmpc.experiments.families import circle, paper
from radmpc.model.obstacle import Obstacle
from radmpc.model.plan import Status
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
from radmpc.planners.outcome import record
from radmpc.planners.paper.algorithm_2_radmpc import approximate
from radmpc.planners.presets import PRESETS, called, parse_planner
from radmpc.planning import plan
from radmpc.referee import certify
from radmpc.solvers.branch.branch import Branch
from radmpc.solvers.milp.big_m import BigM
from running import silent_run

CENTRAL_IRA = Planner(Ira(), Branch(), Centralized())


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
    near = scene_of(mover("a", (0, 0), (8, 0)), mover("b", (8, 0), (0, 0)))
    far = scene_of(mover("a", (0, 0), (8, 0)), mover("b", (8, 30), (0, 30)))
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
    scenario = scene_of(
        mover("a", (0, 0), (8, 0)), obstacles=(Obstacle.box("wall", [3, -1], [4, 0.9]),)
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


@pytest.mark.parametrize("name", [*PRESETS, "multi-vehicle(0.001)", "rmpc(2)", "distance(7.5)"])
def test_a_planner_is_called_what_users_type_for_it(name: str) -> None:
    assert called(parse_planner(name)) == name
    assert called(replace(parse_planner(name), gap=0.02)) == name


def test_choices_without_a_name_are_called_by_themselves() -> None:
    planner = Planner(Ira(direction="to_inactive"), BigM(), Centralized())
    assert called(planner) == str(planner)


def test_choices_that_do_not_go_together_are_refused():
    with pytest.raises(ScenarioError, match=r"'pool' \(pooled\) does not go with 'centralized'"):
        Planner(Pool(), Branch(), Centralized())
    with pytest.raises(ScenarioError, match="does not go with 'receding'"):
        Planner(Ira(), Branch(), Receding())
    with pytest.raises(ScenarioError, match="gap must lie"):
        Planner(Ira(), Branch(), Centralized(), gap=0.0)
    with pytest.raises(ScenarioError, match="covariances must be"):
        Receding("sometimes")


def test_what_the_returned_plan_risks_is_what_the_referee_found_of_it_in_the_search(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    asked: list[bytes] = []
    judge = record.ledger_under

    def counted(noise, controls):
        asked.append(b"".join(each.tobytes() for each in controls))
        return judge(noise, controls)

    monkeypatch.setattr(record, "ledger_under", counted)
    found = plan(circle(3)).require()
    assert asked.count(b"".join(t.controls.tobytes() for t in found.trajectories)) == 1
    assert found.risk.certified == certify(found).certified
    assert found.risk.ledger == certify(found).ledger
