"""Bounds that hold whatever the solver reports, and searches that live with its failures."""

from __future__ import annotations

import numpy as np
import pytest
from highspy import HighsModelStatus
from scipy.optimize import linprog
from scipy.sparse import csr_array

from radmpc.experiments.families import paper
from radmpc.gaussian import clearance_for
from radmpc.program.build import build_program, condensed_models
from radmpc.solvers.branch.tree import Tree
from radmpc.solvers.compiled_code import is_compiled
from radmpc.solvers.lp.bounded_lp import BoundedLp
from radmpc.solvers.lp.choosing import bounded_lp
from radmpc.solvers.lp.highs_lp import HighsLp
from radmpc.solvers.lp.outcome import LpOutcome
from radmpc.solvers.lp.safe_bound import LpRecord
from radmpc.solvers.priced.tree import RiskTree
from radmpc.solvers.solution import Limits

KINDS = [HighsLp]
if is_compiled():
    from radmpc.solvers.lp.simplex_lp import SimplexLp

    KINDS.append(SimplexLp)


def random_lp(seed):
    """Return cost, bounds and rows of a small program, feasible or not."""
    rng = np.random.default_rng(seed)
    n, m = int(rng.integers(2, 9)), int(rng.integers(1, 12))
    cost = rng.normal(size=n)
    lower = -rng.uniform(0.0, 3.0, n)
    upper = rng.uniform(0.0, 3.0, n)
    matrix = np.where(rng.random((m, n)) < 0.6, rng.normal(size=(m, n)), 0.0)
    center = matrix @ rng.uniform(lower, upper) + 0.3 * rng.normal(size=m)
    width = rng.uniform(0.0, 1.0, m)
    row_lower = np.where(rng.random(m) < 0.7, center - width, -np.inf)
    row_upper = np.where(rng.random(m) < 0.7, center + width, np.inf)
    return cost, lower, upper, matrix, row_lower, row_upper


def least_of(cost, lower, upper, matrix, row_lower, row_upper):
    """Return the least cost by another road; inf without a point."""
    has_upper, has_lower = np.isfinite(row_upper), np.isfinite(row_lower)
    rows = np.vstack([matrix[has_upper], -matrix[has_lower]])
    right = np.concatenate([row_upper[has_upper], -row_lower[has_lower]])
    found = linprog(cost, rows, right, bounds=np.column_stack([lower, upper]))
    return float(found.fun) if found.status == 0 else np.inf


def recorded(kind, problem):
    """Return a record or a live program of a problem."""
    cost, lower, upper, matrix, row_lower, row_upper = problem
    lp = kind(cost, lower, upper)
    rows = csr_array(matrix)
    if issubclass(kind, BoundedLp):
        lp.add_rows(rows, row_lower, row_upper)
    else:
        lp.add_rows(rows.indptr, rows.indices, rows.data, row_lower, row_upper)
    return lp


@pytest.mark.parametrize("seed", range(40))
def test_whatever_the_dual_values_their_bound_holds(seed):
    problem = random_lp(seed)
    least = least_of(*problem)
    record, rng = recorded(LpRecord, problem), np.random.default_rng(seed)
    for scale in (1e-9, 0.1, 1.0, 10.0, 1e6):
        assert record.least(scale * rng.normal(size=problem[4].size)) <= least


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("seed", range(40))
def test_the_bound_of_a_solved_program_is_close_and_below(seed, kind):
    problem = random_lp(seed)
    least = least_of(*problem)
    outcome, bound = recorded(kind, problem).solve()
    assert outcome is (LpOutcome.INFEASIBLE if least == np.inf else LpOutcome.OPTIMAL)
    if least < np.inf:
        assert least - 1e-7 <= bound <= least + 1e-9


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("seed", range(40))
def test_a_cutoff_is_reported_only_where_it_is_proven(seed, kind):
    problem = random_lp(seed)
    least = least_of(*problem)
    if least == np.inf:
        return
    for cutoff in (least - 1.0, least - 1e-3, least + 1e-3):
        outcome, bound = recorded(kind, problem).solve(cutoff)
        assert bound <= least + 1e-9
        assert outcome is LpOutcome.OPTIMAL or bound >= cutoff
        assert not (outcome is LpOutcome.CUTOFF and cutoff > least)


def test_a_ray_proves_that_there_is_no_point_only_if_it_does():
    # x + y >= 2.5 within the unit square.
    record = LpRecord(np.ones(2), np.zeros(2), np.ones(2))
    record.add_rows(np.array([0, 2]), np.array([0, 1]), np.ones(2), 2.5, np.inf)
    assert record.has_no_point(np.array([1.0]))
    assert record.has_no_point(np.array([-1.0]))
    record.bound_rows(np.array([0]), np.array([1.5]), np.array([np.inf]))
    assert not record.has_no_point(np.array([1.0]))
    assert record.least(np.array([1.0])) == pytest.approx(1.5)


def test_late_columns_and_rows_count():
    # min x + 3 t with x + t >= 2, x <= 1, t <= 5: one unit of t is needed.
    record = LpRecord(np.ones(1), np.zeros(1), np.ones(1))
    record.add_rows(np.array([0, 1]), np.array([0]), np.ones(1), 2.0, np.inf)
    assert record.has_no_point(np.ones(1))
    record.add_column(3.0, 5.0, np.array([0]), np.ones(1))
    assert not record.has_no_point(np.ones(1))
    assert record.least(np.array([3.0])) == pytest.approx(4.0)
    assert record.least(np.array([3.0])) <= 4.0


@pytest.mark.parametrize("kind", KINDS)
def test_crossed_column_bounds_have_no_point(kind):
    lp = kind(np.ones(2), np.array([0.0, 1.0]), np.array([1.0, 0.5]))
    assert lp.solve() == (LpOutcome.INFEASIBLE, np.inf)


def failing(monkeypatch, lies):
    """Let the solver fail at every n-th program, n = lies, however often it is asked."""
    kind = type(bounded_lp(np.zeros(1), np.zeros(1), np.zeros(1)))
    honest = kind.solve
    state = {"count": 0}

    def solve(self, cutoff=np.inf):
        state["count"] += 1
        if state["count"] % lies == 0:
            return LpOutcome.FAILED, -np.inf
        return honest(self, cutoff)

    monkeypatch.setattr(kind, "solve", solve)


def program_of(scenario):
    return build_program(scenario, condensed_models(scenario), risk_bound=scenario.risk_bound)


@pytest.mark.slow
@pytest.mark.sampled(2)
@pytest.mark.parametrize("lies", [1, 2, 7, 30])
def test_a_priced_search_lives_with_programs_that_no_solver_solves(lies, monkeypatch):
    program = program_of(paper(8, 0).subset((0, 3), 0.05))
    honest = RiskTree(program, 0.05, 0.2, gap=1e-4, scale=1e-3, limits=Limits())
    honest.run(10_000)
    failing(monkeypatch, lies)
    tree = RiskTree(program, 0.05, 0.2, gap=1e-4, scale=1e-3, limits=Limits())
    tree.run(10_000)
    assert tree.bound <= honest.value + 1e-9
    assert tree.value >= honest.bound - 1e-9
    # What was left over is said to be, and solved once the solver solves again.
    assert tree.is_limited or tree.value - tree.bound <= 1e-4 * max(tree.value, 1e-3)
    monkeypatch.undo()
    again = RiskTree(program, 0.05, 0.2, gap=1e-4, scale=1e-3, limits=Limits())
    again.resume(tree.frontier, 0.2, tree.best)
    again.run(10_000)
    assert again.value == pytest.approx(honest.value, rel=2e-4)
    assert not again.is_limited


@pytest.mark.parametrize("lies", [1, 2, 7, 30])
def test_a_search_at_fixed_margins_lives_with_programs_that_no_solver_solves(lies, monkeypatch):
    program = program_of(paper(8, 0).subset((0, 3), 0.05))
    margins = program.rows.deviations * clearance_for(np.full(program.rows.count, 1e-3))
    honest = Tree(program, margins, gap=1e-4, limits=Limits())
    honest.run(10_000)
    failing(monkeypatch, lies)
    tree = Tree(program, margins, gap=1e-4, limits=Limits())
    tree.run(10_000)
    assert tree.bound <= honest.cost + 1e-9
    assert tree.cost >= honest.bound - 1e-9


class _Stubborn:
    """HiGHS that answers Unknown so many times, then as it is."""

    def __init__(self, highs, times):
        self._highs, self.left = highs, times

    def __getattr__(self, name):
        return getattr(self._highs, name)

    def getModelStatus(self):  # noqa: N802 - as highspy spells it
        self.left -= 1
        return HighsModelStatus.kUnknown if self.left >= 0 else self._highs.getModelStatus()


@pytest.mark.parametrize("times", [1, 2])
def test_where_highs_fails_a_fresh_one_is_asked(times):
    problem = random_lp(3)
    lp = recorded(HighsLp, problem)
    lp._highs = _Stubborn(lp._highs, times)
    outcome, bound = lp.solve()
    assert outcome is LpOutcome.OPTIMAL
    assert bound == pytest.approx(least_of(*problem), abs=1e-6)
    assert lp.solves == 1 + times
    cost, lower, upper, *_ = problem
    point = lp.point()
    assert cost @ point == pytest.approx(bound, abs=1e-6)
    assert np.all((point >= lower - 1e-9) & (point <= upper + 1e-9))


def test_where_highs_goes_round_in_circles_a_fresh_one_is_asked(monkeypatch):
    problem = next(p for p in map(random_lp, range(6, 40)) if np.isfinite(least_of(*p)))
    lp = recorded(HighsLp, problem)
    # One pivot is not enough, as no number of pivots is in a circle.
    monkeypatch.setattr("radmpc.solvers.lp.highs_lp._PIVOTS", 0)
    monkeypatch.setattr("radmpc.solvers.lp.highs_lp._LEAST_PIVOTS", 1)
    monkeypatch.setattr("radmpc.solvers.lp.highs_lp._FRESH", 1_000)
    outcome, bound = lp.solve()
    assert outcome is LpOutcome.OPTIMAL
    assert bound == pytest.approx(least_of(*problem), abs=1e-6)
    assert lp.solves == 3
