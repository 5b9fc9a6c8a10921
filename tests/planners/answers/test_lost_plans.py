"""Plans that are easily lost: hidden between sets, above the hull of prices, at contact."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from radmpc.experiments.families import paper
from radmpc.io.native.scenario_file import load_scenario
from radmpc.model.dynamics import double_integrator
from radmpc.model.plan import LedgerRow, Status
from radmpc.model.scenario import Scenario
from radmpc.model.vehicle import Goal, Vehicle
from radmpc.planners.certified import fallbacks, programs
from radmpc.planners.certified.fleet import Fleet
from radmpc.planners.certified.inter_set_risk import inter_set_risks
from radmpc.planners.certified.phases import searching
from radmpc.planners.certified.search import PriceSearch
from radmpc.planners.certified.set_searches import solve_sets
from radmpc.planners.certified.state.incumbent import FleetIncumbent
from radmpc.planners.certified.state.search_state import SearchState
from radmpc.planners.verdict import Verdict
from radmpc.planning import plan
from radmpc.referee import certify
from radmpc.solvers.priced.budget import OVER, BudgetTree
from radmpc.solvers.priced.lp import RiskLp
from radmpc.solvers.priced.rating import Rater
from radmpc.solvers.solution import Limits

SCENES = Path(__file__).parents[2] / "data" / "scenes"
FOREVER = Limits(float("inf"))


def scene(name):
    return load_scenario(SCENES / f"{name}.json")


@pytest.mark.slow
@pytest.mark.sampled(1)
@pytest.mark.parametrize(
    ("name", "others"),
    [
        ("bow-merge-limit", 8.3783),
        ("bow-merge-limit-2", 11.1889),
        ("bow-merge-dear", 25.3239),
        ("contact-at-start", 4.4401),
        ("infeasible-price", 2.92),
        ("formation-of-three", 50.8136),
        ("formation-at-contact", 5.1941),
        ("start-of-little-room", 33.7111),
        ("no-way-by-faces", 2.8428),
        ("no-way-together-by-faces", 8.4249),
        ("dear-by-faces-475", 2.7325),
        ("dear-by-faces-152", 4.5808),
        ("dear-by-faces-156", 1.7003),
        ("dear-by-halves-of-the-sagitta", 3.7384),
    ],
)
def test_no_certified_plan_of_another_planner_is_cheaper(name, others):
    result = plan(scene(name), "certified", time_limit=20.0)
    assert certify(result.require()).holds
    assert result.cost <= others * (1.0 + 1e-3)
    assert result.status is Status.OPTIMAL


def passers(acceleration):
    # Side by side along x, 0.1 m between them at both steps; both curves bend toward each other.
    start = np.array([[0.0, 0.0], [0.0, 0.9]])
    vehicles = tuple(
        Vehicle(
            name,
            double_integrator(1.0, 2),
            np.concatenate([at, np.zeros(2)]),
            Goal(at - 1.0, at + 1.0, np.ones(2)),
            0.4,
            np.full(2, 5.0),
            1e-4 * np.eye(4),
            1e-4 * np.eye(4),
        )
        for name, at in zip("ab", start, strict=True)
    )
    means = np.repeat(start[:, None, :], 2, axis=1)
    sagittas = np.zeros((2, 1, 2))
    # Against the acceleration: the lower one's curve rises where it accelerates downwards.
    sagittas[:, 0, 1] = acceleration * np.array([-1.0, 1.0]) / 8.0
    return Scenario("passers", 1.0, 1, 0.05, vehicles), means, sagittas


def test_risk_between_sets_is_estimated_with_the_sagitta():
    scenario, means, sagittas = passers(0.5)
    noise = np.repeat(1e-4 * np.eye(2)[None, None], 2, axis=0).repeat(2, axis=1)
    apart = np.arange(2)
    straight = inter_set_risks(scenario, means, noise, apart)
    bent = inter_set_risks(scenario, means, noise, apart, sagittas)
    assert straight.get((0, 1), 0.0) < 1e-10
    assert bent[0, 1] > 0.5
    # Curves that bend away from each other keep their chords' distance.
    away = inter_set_risks(scenario, means, noise, apart, -sagittas)
    assert away == straight


def test_what_is_estimated_between_sets_counts_the_sagitta():
    scenario = scene("bow-merge-dear")
    made = Fleet.of(scenario, 1e-3, FOREVER)
    state = SearchState.of(made)
    first = made.first_unit_price(state.budget)
    state = solve_sets(made, state, made.singles, first, 1)
    points = [state.best(m).z for m in made.singles]
    means = np.array(
        [made.programs.problem(m).means(z)[0] for m, z in zip(made.singles, points, strict=True)]
    )
    straight = inter_set_risks(scenario, means, made.programs.covariances, np.arange(3))
    estimate = made.programs.pair_risks(made.singles, points)
    assert straight[0, 1] < 1e-3
    assert estimate[0, 1] > 0.05


@pytest.mark.slow
def test_sets_that_the_referee_blames_are_merged_whatever_is_estimated(monkeypatch):
    monkeypatch.setattr(programs, "pair_risks_across_sets", lambda *everything: {})
    result = plan(scene("bow-merge-limit"), "certified", time_limit=20.0)
    assert result.is_certified
    assert result.cost <= 8.3783 * (1.0 + 1e-3)
    assert any(len(members) > 1 for members in result.sets)
    assert all(coupling.value > 0.05 for coupling in result.record.couplings)


def verdict(certified, **pairs):
    rows = [LedgerRow("pair", name[0], name[1], 1, risk) for name, risk in pairs.items()]
    rows.append(LedgerRow("obstacle", "a", "rock", 1, certified - sum(pairs.values())))
    rows.append(LedgerRow("pair", "a", None, 1, 0.0))
    return Verdict(certified, tuple(rows))


NUMBERS = {"a": 0, "b": 1, "c": 2}


def test_only_rejected_plans_are_blamed_on_pairs_across_sets():
    apart = np.arange(3)
    assert verdict(0.04, ab=0.03).to_blame(apart, NUMBERS, 0.05) == {}
    assert verdict(0.07, ab=0.03).to_blame(apart, NUMBERS, 0.05) == {(0, 1): 0.03}
    # Without the pair it would be just as infeasible.
    assert verdict(0.9, ab=0.03).to_blame(apart, NUMBERS, 0.05) == {}
    # One set already.
    assert verdict(0.07, ab=0.03).to_blame(np.array([0, 0, 1]), NUMBERS, 0.05) == {}


def test_the_worst_pair_is_blamed_first_and_small_ones_are_left_apart():
    blamed = verdict(0.9, ab=0.5, bc=0.3, ca=1e-4).to_blame(np.arange(3), NUMBERS, 0.05)
    assert list(blamed) == [(0, 1), (1, 2)]


def test_a_row_may_take_one_half_and_the_fleet_more():
    scenario = replace(scene("bow-merge-dear"), risk_bound=0.1)
    made = Fleet.of(scenario, 1e-3, FOREVER)
    assert made.unit == pytest.approx(1.2)
    program = made.programs.problem((0, 1, 2)).program
    lp = RiskLp(program, made.unit, 1.0)
    assert lp.row_cap == 0.5
    assert lp.floor == 0.0
    rater = made.programs.problem((0, 1, 2)).rater
    assert rater.row_cap == 0.5


def test_where_the_fleet_may_risk_less_than_one_half_so_may_each_row():
    scenario = replace(scene("bow-merge-dear"), risk_bound=0.01)
    made = Fleet.of(scenario, 1e-3, FOREVER)
    assert made.unit == pytest.approx(0.12)
    assert RiskLp(made.programs.problem((0,)).program, made.unit, 1.0).row_cap == made.unit


def test_a_hard_budget_finds_what_no_price_leads_to():
    # Between two plans of other sides, which all prices choose, lies a third within the budget.
    scenario = scene("infeasible-price")
    made = Fleet.of(scenario, 1e-3, FOREVER)
    problem = made.programs.problem((0, 1))
    budget = 0.021
    tree = BudgetTree(
        problem.program,
        budget,
        1e-4,
        gap=5e-4,
        scale=1.0,
        limits=FOREVER,
        rater=Rater(problem.program, budget),
    )
    tree.run(2_000)
    assert not tree.is_limited
    assert tree.best.risk <= budget * (1.0 + OVER)
    assert tree.best.cost == pytest.approx(tree.bound, rel=2e-3)
    risks, state = [], SearchState.of(made)
    for price in np.geomspace(0.1, 100.0, 10):
        state = solve_sets(made, state, ((0, 1),), price, 4)
        risks.append(state.best((0, 1)).risk)
    between = [risk for risk in risks if 0.8 * budget <= risk <= budget]
    assert not between


def test_the_budget_stays_positive_where_the_starts_alone_exceed_the_bound():
    near = replace(scene("bow-merge-limit"), avoidance="steps", risk_bound=0.02)
    vehicles = tuple(replace(v, initial_covariance=2e-3 * np.eye(4)) for v in near.vehicles)
    made = Fleet.of(replace(near, vehicles=vehicles), 1e-3, FOREVER)
    assert made.initial > near.risk_bound
    assert 0.0 < made.clipped_budget(-1.0) < near.risk_bound


@pytest.mark.slow
def test_without_a_plan_half_spaces_are_turned_to_one_without_noise(monkeypatch):
    monkeypatch.setattr(searching, "first_plan", lambda *_, **__: FleetIncumbent())
    monkeypatch.setattr(PriceSearch, "run", lambda self, state: state)
    result = plan(paper(3, 2), "certified")
    assert result.is_certified
    assert result.cost <= 7.16


@pytest.mark.slow
def test_without_a_plan_the_search_goes_on_by_way_of_the_safest(monkeypatch):
    monkeypatch.setattr(searching, "first_plan", lambda *_, **__: FleetIncumbent())
    calls = []
    run = PriceSearch.run

    def late(self, state):
        calls.append(len(calls))
        return state if len(calls) == 1 else run(self, state)

    monkeypatch.setattr(PriceSearch, "run", late)
    monkeypatch.setattr(fallbacks, "turn_from_noiseless", lambda fleet, state, judge: state)
    result = plan(paper(3, 2), "certified")
    assert result.status is Status.OPTIMAL
    assert len(calls) == 2
