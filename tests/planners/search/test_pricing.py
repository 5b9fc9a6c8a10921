"""The next price of risk, and the fit of the risks to the budget at the end."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from radmpc.experiments.families import paper
from radmpc.planners.certified.fleet import Fleet
from radmpc.planners.certified.pricing import next_price
from radmpc.planners.certified.repair import AllocatedPrograms, repair
from radmpc.planners.certified.set_searches import solve_sets
from radmpc.planners.certified.state.search_state import SearchState
from radmpc.solvers.solution import Limits

BUDGET = 0.05


def test_a_price_at_which_the_budget_is_just_used_stays():
    assert next_price([(2.0, 0.99 * BUDGET)], BUDGET) == 2.0


@pytest.mark.parametrize("risk", [1.5, 3.0, 100.0])
def test_too_much_risk_makes_it_dearer_and_at_most_five_times(risk):
    assert 2.0 < next_price([(2.0, risk * BUDGET)], BUDGET) <= 10.0


@pytest.mark.parametrize("risk", [0.9, 0.3, 0.0])
def test_too_little_risk_makes_it_cheaper_and_at_most_to_a_fifth(risk):
    assert 0.4 <= next_price([(2.0, risk * BUDGET)], BUDGET) < 2.0


@pytest.mark.parametrize("risk", [0.5, 3.0])
def test_a_price_after_risk_was_free_moves_as_after_none(risk):
    tried = (1.0, risk * BUDGET)
    assert next_price([(0.0, 2.0 * BUDGET), tried], BUDGET) == next_price([tried], BUDGET)


def test_between_prices_on_both_sides_of_the_budget_lies_the_next():
    tried = [(1.0, 4.0 * BUDGET), (8.0, 0.2 * BUDGET)]
    found = next_price(tried, BUDGET)
    assert 1.0 < found < 8.0
    # Nearer to the price that misses the budget by the smaller factor.
    nearer = next_price([(1.0, 1.2 * BUDGET), (8.0, 0.2 * BUDGET)], BUDGET)
    assert 1.0 < nearer < found


def test_where_risk_falls_in_proportion_to_its_price_few_prices_lead_to_the_budget():
    tried = [(1.0, 40.0 * BUDGET)]
    while not 0.97 * BUDGET <= tried[-1][1] <= BUDGET:
        price = next_price(tried, BUDGET)
        tried.append((price, 40.0 * BUDGET / price))
        assert len(tried) < 10
    assert tried[-1][0] == pytest.approx(40.0, rel=0.04)


def test_risk_that_barely_moves_is_followed_in_longer_steps():
    moved = next_price([(1.0, 8.0 * BUDGET), (4.0, 2.0 * BUDGET)], BUDGET)
    stuck = next_price([(1.0, 2.01 * BUDGET), (4.0, 2.0 * BUDGET)], BUDGET)
    assert stuck > 1.5 * moved


@pytest.fixture(scope="module")
def singles():
    """Return three vehicles, each planned alone at the first price."""
    return planned_alone(3, 2)


def planned_alone(count, seed):
    """Return vehicles and their plans at the first price."""
    fleet = Fleet.of(paper(count, seed), 1e-3, Limits())
    state = SearchState.of(fleet)
    first = fleet.first_unit_price(state.budget)
    state = solve_sets(fleet, state, fleet.singles, first, 1)
    problems = [fleet.programs.problem(m) for m in fleet.singles]
    return problems, [state.best(m) for m in fleet.singles]


def risk_and_cost(singles, points):
    """Return what points risk by the sides of the plans given, and what they cost."""
    problems, found = singles
    together = list(zip(problems, points, found, strict=True))
    risk = sum(p.program.event_risks(z, plan.selection).sum() for p, z, plan in together)
    return risk, sum(float(p.program.cost @ z) for p, z, _ in together)


@pytest.mark.parametrize("avoidance", ["steps", "intervals"])
def test_risks_of_a_plans_sides_are_those_of_the_program(avoidance):
    fleet = Fleet.of(replace(paper(3, 1), avoidance=avoidance), 1e-3, Limits())
    state = SearchState.of(fleet)
    sets = ((0, 1), (2,))
    state = solve_sets(fleet, state, sets, fleet.first_unit_price(state.budget), 1)
    programs, rng = AllocatedPrograms(), np.random.default_rng(0)
    for members in sets:
        problem, plan = fleet.programs.problem(members), state.best(members)
        program = problem.program
        span = program.upper - program.lower
        points = [plan.z, *(plan.z + 0.1 * span * rng.normal(size=span.size) for _ in range(20))]
        for z in points:
            expected = program.event_risks(z, plan.selection)
            assert programs.risks(problem, plan, z) == pytest.approx(expected, abs=1e-12)


def test_fitted_risks_use_the_budget_and_do_not_exceed_it(singles):
    risk, _ = risk_and_cost(singles, [plan.z for plan in singles[1]])
    for share, least in ((0.3, 0.27), (1.5, 1.2)):
        rescaled = repair(*singles, share * risk, AllocatedPrograms())
        assert rescaled is not None
        assert least * risk <= risk_and_cost(singles, rescaled)[0] <= share * risk


def test_a_larger_budget_never_costs_more(singles):
    risk, _ = risk_and_cost(singles, [plan.z for plan in singles[1]])
    budgets = risk * np.array([0.2, 0.5, 1.0, 2.0])
    costs = [
        risk_and_cost(singles, repair(*singles, budget, AllocatedPrograms()))[1]
        for budget in budgets
    ]
    assert costs == sorted(costs, reverse=True)
    assert costs[-1] < costs[0]


@pytest.mark.parametrize("budget", [0.0, -0.01])
def test_where_nothing_may_be_risked_nothing_fits(singles, budget):
    assert repair(*singles, budget, AllocatedPrograms()) is None


def test_of_a_large_fleet_so_few_sets_are_rescaled_as_come_to_the_budget():
    singles = planned_alone(8, 0)
    found = singles[1]
    risk, cost = risk_and_cost(singles, [plan.z for plan in found])
    moved = []
    for share in (0.97, 0.3):
        points = repair(*singles, share * risk, AllocatedPrograms(), is_large=True)
        assert points is not None
        left, dearer = risk_and_cost(singles, points)
        assert left <= share * risk
        assert dearer > cost
        moved.append(sum(z is not plan.z for z, plan in zip(points, found, strict=True)))
    assert moved[0] == 1 < moved[1]
