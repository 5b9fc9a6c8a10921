"""Limits end a search with what it has, and say so."""

from __future__ import annotations

import time

import numpy as np
import pytest

from radmpc.errors import ScenarioError
from radmpc.experiments.families import paper
from radmpc.planners.coarse_search import propose_alternatives
from radmpc.program.allocation import margins_of, uniform_allocation
from radmpc.program.build import build_program, condensed_models
from radmpc.solvers.branch.branch import Branch
from radmpc.solvers.lp.outcome import LpOutcome
from radmpc.solvers.lp.warm_lp import WarmLp
from radmpc.solvers.milp.big_m import BigM
from radmpc.solvers.selection import violations_of
from radmpc.solvers.solution import Limits, Outcome, relative_gap


def _paper(num_vehicles, seed):
    scenario = paper(num_vehicles, seed)
    program = build_program(scenario, condensed_models(scenario), risk_bound=scenario.risk_bound)
    return program, margins_of(program, uniform_allocation(program, program.budget))


@pytest.mark.slow
def test_a_node_limit_leaves_a_solution_with_an_honest_gap():
    program, margins = _paper(8, 0)
    full = Branch().solve(program, margins, gap=1e-3, limits=Limits())
    cut = Branch(max_nodes=300).solve(program, margins, gap=1e-3, limits=Limits())
    assert full.outcome is Outcome.OPTIMAL
    assert cut.outcome is Outcome.FEASIBLE
    assert cut.bound <= full.cost <= cut.cost
    assert cut.gap > 1e-3


@pytest.mark.slow
def test_the_same_node_limit_gives_the_same_solution_twice():
    program, margins = _paper(6, 4)
    first, second = (
        Branch(max_nodes=200).solve(program, margins, gap=1e-3, limits=Limits()) for _ in range(2)
    )
    assert first.cost == second.cost
    assert np.array_equal(first.z, second.z)


def test_a_stop_before_any_solution_is_told_apart_from_infeasible():
    program, margins = _paper(4, 0)
    stopped = Limits(is_stopped=lambda: True)
    solution = Branch().solve(program, margins, gap=1e-3, limits=stopped)
    assert solution.outcome is Outcome.LIMIT
    assert solution.z is None
    assert BigM().solve(program, margins, gap=1e-3, limits=stopped).outcome in {
        Outcome.LIMIT,
        Outcome.FEASIBLE,
    }


def test_a_start_survives_an_immediate_stop():
    program, margins = _paper(4, 0)
    known = Branch().solve(program, margins, gap=1e-3, limits=Limits())
    again = Branch().solve(
        program,
        margins,
        gap=1e-3,
        limits=Limits(is_stopped=lambda: True),
        start=known.selection,
    )
    assert again.cost == pytest.approx(known.cost, rel=1e-9)


def test_a_deadline_in_the_past_counts_as_reached():
    assert Limits(deadline=time.monotonic() - 1.0).reached
    assert Limits(deadline=time.monotonic() - 1.0).seconds_left == 0.0
    assert not Limits().reached


def test_an_unknown_backend_is_refused_by_name():
    with pytest.raises(ScenarioError, match="backend must be one of highs, scip, gurobi"):
        BigM("cplex")


def test_the_gap_of_no_solution_is_infinite_and_of_equal_ones_zero():
    assert relative_gap(np.inf, 1.0) == np.inf
    assert relative_gap(2.0, 2.0) == 0.0
    assert relative_gap(2.0, 1.0) == 0.5


def test_the_warm_lp_switches_rows_by_their_bounds_and_forgets_nothing():
    program, margins = _paper(3, 0)
    lp = WarmLp(program, margins)
    _, free = lp.solve()
    chosen = program.rows_of(int(violations_of(program, margins, lp.point()).argmax()))
    lp.activate(chosen)
    outcome, held = lp.solve()
    assert outcome is LpOutcome.INFEASIBLE or held >= free
    lp.activate([])
    assert lp.solve()[1] == pytest.approx(free, rel=1e-9)


def test_an_opposed_row_is_held_the_other_way_round():
    program, margins = _paper(2, 0)
    lp = WarmLp(program, margins)
    lp.solve()
    slack = program.slacks(lp.point()) - margins
    row = int(np.flatnonzero(slack > 0.5)[0])
    lp.activate([], [row])
    outcome, _ = lp.solve()
    if outcome is LpOutcome.OPTIMAL:
        assert program.slacks(lp.point())[row] <= margins[row] + 1e-7
    else:
        assert outcome is LpOutcome.INFEASIBLE


@pytest.mark.slow
def test_a_proposal_of_sides_ends_with_the_limits():
    scenario = paper(8, 0)
    models = condensed_models(scenario)
    program, margins = _paper(8, 0)
    assert propose_alternatives(program, models, margins, Limits()) is not None
    asked = []

    def stop_at_the_third():
        asked.append(None)
        return len(asked) >= 3

    limits = Limits(is_stopped=stop_at_the_third)
    assert propose_alternatives(program, models, margins, limits) is None
    # Once more in `place`, and no step further.
    assert len(asked) <= 5


def test_scip_does_not_begin_where_declaring_took_the_time():
    pytest.importorskip("pyscipopt")
    program, margins = _paper(4, 0)
    solution = BigM("scip").solve(program, margins, gap=1e-3, limits=Limits(deadline=0.0))
    assert solution.outcome is Outcome.LIMIT
    assert solution.z is None
    assert solution.bound <= 0.0
