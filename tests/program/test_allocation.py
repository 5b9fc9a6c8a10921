"""What allocations may and may not do."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.stats import norm

from radmpc.errors import RiskError
from radmpc.experiments.families import paper
from radmpc.gaussian import clearance_for, tail_probability, tail_slope
from radmpc.program.allocation import allocated, margins_of, reallocate, uniform_allocation
from radmpc.program.build import build_program, condensed_models
from radmpc.solvers.branch.branch import Branch
from radmpc.solvers.solution import Limits
from sampling import examples


def _program(seed=0, num_vehicles=2, avoidance="steps"):
    scenario = replace(paper(num_vehicles, seed), avoidance=avoidance)
    return build_program(scenario, condensed_models(scenario), risk_bound=scenario.risk_bound)


@pytest.mark.slow
@pytest.mark.parametrize("avoidance", ["steps", "intervals"])
@settings(max_examples=examples(30), deadline=None)
@given(seed=st.integers(0, 10**6))
def test_no_selection_pays_more_than_a_uniform_allocation_spreads(avoidance, seed):
    program = _program(avoidance=avoidance)
    allocation = uniform_allocation(program, program.budget)
    rng = np.random.default_rng(seed)
    starts = program.avoidance_starts
    selection = np.array([rng.integers(a, b) for a, b in pairwise(starts)])
    assert allocated(program, allocation, selection) <= program.budget * (1 + 1e-12)


def test_a_uniform_allocation_under_steps_is_the_budget_over_the_avoidances():
    program = _program()
    allocation = uniform_allocation(program, program.budget)
    assert allocation == pytest.approx(program.budget / program.num_avoidances)


def test_a_margin_is_the_deviation_times_the_clearance_of_the_risk():
    program = _program()
    margins = margins_of(program, np.full(len(program.risk_items), 0.01))
    assert margins == pytest.approx(program.rows.deviations * norm.isf(0.01), rel=1e-12)


@pytest.mark.parametrize("avoidance", ["steps", "intervals"])
def test_reallocation_keeps_the_sum_and_never_goes_below_what_is_used(avoidance):
    program = _program(0, 2, avoidance)
    budget = program.budget
    allocation = uniform_allocation(program, budget)
    solution = Branch().solve(program, margins_of(program, allocation), gap=1e-3, limits=Limits())
    upper = reallocate(
        program, allocation, solution.selection, solution.z, budget, active_tol=0.01, keep=0.7
    )
    assert allocated(program, upper.allocation, solution.selection) <= budget * (1 + 1e-12)
    risks = program.event_risks(solution.z, solution.selection)
    chosen = risks > 0.0
    given_ = upper.allocation[program.rows.risk_items]
    assert np.all(given_[chosen] >= risks[chosen] * (1 - 1e-6))
    assert 0 < upper.num_active <= upper.num_chosen
    assert upper.used <= budget


def test_an_active_risk_item_receives_and_an_inactive_one_gives():
    program = _program(0, 2)
    allocation = uniform_allocation(program, program.budget)
    solution = Branch().solve(program, margins_of(program, allocation), gap=1e-3, limits=Limits())
    upper = reallocate(
        program,
        allocation,
        solution.selection,
        solution.z,
        program.budget,
        active_tol=0.01,
        keep=0.7,
    )
    changed = upper.allocation / allocation
    assert (changed > 1.0).sum() == upper.num_active
    assert changed.min() >= 0.7 - 1e-12


def test_tails_are_right_where_one_minus_the_distribution_is_zero():
    q = np.array([0.0, 1.0, 5.0, 9.0, 20.0])
    assert tail_probability(q) == pytest.approx(norm.sf(q), rel=1e-12)
    assert tail_slope(q) == pytest.approx(-norm.pdf(q), rel=1e-12)
    assert clearance_for(np.array([1e-17, 0.5])) == pytest.approx([norm.isf(1e-17), 0.0])


@pytest.mark.parametrize("risk", [0.0, 0.6, -1e-3, float("nan")])
def test_a_clearance_for_no_risk_or_more_than_half_is_refused(risk):
    with pytest.raises(RiskError, match=r"risk must lie in \(0, 0.5\]"):
        clearance_for(risk)
