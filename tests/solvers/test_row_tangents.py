"""Tangents to the risk of rows: below it, touching it, and shared by searches of one program."""

from __future__ import annotations

import pickle

import numpy as np
import pytest
from problems import random_problem
from scipy.stats import norm

from radmpc.program.build import build_program, condensed_models
from radmpc.program.program import DisjunctiveProgram
from radmpc.solvers.lp.outcome import LpOutcome
from radmpc.solvers.priced.lp import RiskLp
from radmpc.solvers.priced.rating import Rater
from radmpc.solvers.priced.row_tangents import RowTangents, Touching
from radmpc.solvers.priced.tree import RiskTree
from radmpc.solvers.solution import Limits

UNIT, PRICE = 0.1, 0.2


def program_of(seed: int) -> DisjunctiveProgram:
    """Return one of the random problems."""
    scenario = random_problem(seed)
    return build_program(scenario, condensed_models(scenario), risk_bound=scenario.risk_bound)


def first_sides(program: DisjunctiveProgram, count: int) -> tuple[int, ...]:
    """Return the first alternatives of some avoidances."""
    return tuple(program.avoidance_starts[:count].tolist())


def test_a_tangent_touches_the_tail_and_is_nowhere_above_it() -> None:
    at = np.array([0.0, 1.5, 3.0, 6.0])
    tangents = Touching.at(at, UNIT)
    q = np.linspace(0.0, 8.0, 401)
    below = tangents.heights[:, None] - tangents.slopes[:, None] * q
    assert np.all(below <= norm.sf(q) / UNIT * (1.0 + 1e-12))
    there = tangents.heights - tangents.slopes * at
    assert there == pytest.approx(norm.sf(at) / UNIT, rel=1e-9)


def test_the_rows_of_a_tangent_say_what_the_tangent_says() -> None:
    program = program_of(1)
    tangents = RowTangents(program, UNIT)
    rng = np.random.default_rng(0)
    z, risk = rng.uniform(0.0, 1.0, program.num_columns), 0.3
    clearances = program.clearances(z)
    point = np.append(z, risk)
    for row in np.flatnonzero(program.rows.deviations > 0.0)[:20].tolist():
        columns, entries, lowers = tangents.beginning(row, z.size)
        left = (entries * point[columns]).sum(axis=1) - lowers
        first = tangents.first
        assert left == pytest.approx(risk + first.slopes * clearances[row] - first.heights)


@pytest.mark.parametrize("seed", range(4))
def test_linear_programs_that_share_tangents_do_not_disturb_each_other(seed: int) -> None:
    program = program_of(seed)
    shared = Rater(program, UNIT)
    sides = first_sides(program, 3)
    one, other = (RiskLp(program, UNIT, PRICE, rater=shared) for _ in range(2))
    # The same rows in another order: their risks are other columns there.
    for side in sides:
        one.activate((side,))
    for side in reversed(sides):
        other.activate((side,))
    found = []
    for lp in (one, other, RiskLp(program, UNIT, PRICE)):
        lp.activate(sides)
        outcome, bound = lp.solve()
        found.append(bound if outcome is LpOutcome.OPTIMAL else outcome)
    assert found[0] == pytest.approx(found[2], abs=1e-7)
    assert found[1] == pytest.approx(found[2], abs=1e-7)


def test_a_rater_made_for_another_unit_serves_a_search_all_the_same() -> None:
    program = program_of(1)
    values = []
    for rater in (Rater(program, UNIT), Rater(program, UNIT / 2.0)):
        tree = RiskTree(program, UNIT, PRICE, gap=1e-4, scale=1e-3, limits=Limits(), rater=rater)
        tree.run(2_000)
        values.append(tree._solver.lp.floor)
    assert values[0] == values[1] == pytest.approx(norm.isf(UNIT))


def test_tangents_are_not_sent_with_a_rater() -> None:
    rater = Rater(program_of(1), UNIT)
    before = len(pickle.dumps(rater))
    row = int(np.flatnonzero(rater.program.rows.deviations > 0.0)[0])
    rater.tangents.beginning(row, 0)
    again = pickle.dumps(rater)
    assert len(again) == before
    assert pickle.loads(again).tangents.floor == rater.tangents.floor
