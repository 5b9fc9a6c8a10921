"""The compiled simplex method against another solver, however programs grow and change."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import linprog
from scipy.sparse import csr_array

from radmpc.experiments.families import paper
from radmpc.planning import plan
from radmpc.solvers.compiled_code import is_compiled
from radmpc.solvers.lp.choosing import bounded_lp
from radmpc.solvers.lp.highs_lp import HighsLp
from radmpc.solvers.lp.outcome import LpOutcome
from radmpc.solvers.lp.safe_bound import LpRecord

pytestmark = pytest.mark.skipif(not is_compiled(), reason="no compiled simplex method here")

if is_compiled():
    from radmpc.solvers import _compiled
    from radmpc.solvers.lp.simplex_lp import SimplexLp


class Copy:
    """A program, and the same as dense arrays for SciPy."""

    def __init__(self, rng: np.random.Generator) -> None:
        n = int(rng.integers(1, 25))
        self.cost = rng.normal(size=n) * (rng.random(n) < 0.8)
        if rng.random() < 0.5:
            # Many vertices of one cost, as in programs of least effort.
            self.cost = np.abs(np.round(self.cost))
        self.lower = -3.0 * rng.random(n)
        self.upper = self.lower + 5.0 * rng.random(n) * (rng.random(n) < 0.95)
        self.rows = np.zeros((0, n))
        self.row_lower, self.row_upper = np.zeros(0), np.zeros(0)
        self.lp = SimplexLp(self.cost, self.lower, self.upper)

    def grow(self, rng: np.random.Generator) -> None:
        """Append some rows: inequalities, ranges, equations, some without a point."""
        m, n = int(rng.integers(0, 16)), self.cost.size
        rows = rng.normal(size=(m, n)) * (rng.random((m, n)) < 0.6)
        if rng.random() < 0.3:
            rows = np.round(rows)
        at = rows @ (self.lower + rng.random(n) * (self.upper - self.lower))
        lower = np.where(rng.random(m) < 0.5, -np.inf, at - rng.random(m) * (rng.random(m) < 0.8))
        upper = np.where(rng.random(m) < 0.5, np.inf, at + rng.random(m))
        are_equal = rng.random(m) < 0.1
        lower[are_equal] = upper[are_equal] = at[are_equal]
        if m and rng.random() < 0.1:
            lower[0] = upper[0] = at[0] + 5.0
        self.lp.add_rows(csr_array(rows), lower, upper)
        self.rows = np.vstack([self.rows, rows])
        self.row_lower = np.append(self.row_lower, lower)
        self.row_upper = np.append(self.row_upper, upper)

    def widen(self, rng: np.random.Generator) -> None:
        """Append a column in some of the rows."""
        cost, upper = float(rng.normal()), float(rng.random())
        numbers = np.flatnonzero(rng.random(len(self.rows)) < 0.3).astype(np.int32)
        values = rng.normal(size=numbers.size)
        self.lp.add_column(cost, upper, numbers, values)
        column = np.zeros((len(self.rows), 1))
        column[numbers, 0] = values
        self.rows = np.hstack([self.rows, column])
        self.cost, self.lower = np.append(self.cost, cost), np.append(self.lower, 0.0)
        self.upper = np.append(self.upper, upper)

    def switch(self, rng: np.random.Generator) -> None:
        """Switch some rows off, or turn them."""
        numbers = np.flatnonzero(rng.random(len(self.rows)) < 0.2)
        off = np.full(numbers.size, np.inf)
        lower, upper = -off, off
        if rng.random() < 0.5:
            lower, upper = -self.row_upper[numbers], -self.row_lower[numbers]
        self.row_lower[numbers], self.row_upper[numbers] = lower, upper
        self.lp.bound_rows(numbers.tolist(), lower, upper)

    def charge(self, rng: np.random.Generator) -> None:
        """Change all costs."""
        self.cost = rng.normal(size=self.cost.size)
        self.lp.change_cost(self.cost)

    def least(self) -> float:
        """Return the least cost by SciPy; inf without a point."""
        has_lower, has_upper = np.isfinite(self.row_lower), np.isfinite(self.row_upper)
        rows = np.vstack([self.rows[has_upper], -self.rows[has_lower]])
        right = np.append(self.row_upper[has_upper], -self.row_lower[has_lower])
        bounds = np.column_stack([self.lower, self.upper])
        found = linprog(self.cost, rows, right, bounds=bounds)
        assert found.status in {0, 2}
        return float(found.fun) if found.status == 0 else np.inf


@pytest.mark.sampled(20)
@pytest.mark.parametrize("seed", range(400))
def test_it_finds_the_least_however_a_program_grew(seed: int) -> None:
    rng = np.random.default_rng(seed)
    copy = Copy(rng)
    basis = b""
    for _ in range(8):
        for change in (copy.grow, copy.widen, copy.switch, copy.charge):
            if rng.random() < 0.5:
                change(rng)
        if rng.random() < 0.3:
            copy.lp.begin_with(basis)
        least = copy.least()
        outcome, bound = copy.lp.solve()
        if least == np.inf:
            assert (outcome, bound) == (LpOutcome.INFEASIBLE, np.inf)
            continue
        assert outcome is LpOutcome.OPTIMAL
        assert least - 1e-6 * max(1.0, abs(least)) <= bound <= least + 1e-9
        point, activity = copy.lp.point(), copy.rows @ copy.lp.point()
        assert np.all((point >= copy.lower - 1e-9) & (point <= copy.upper + 1e-9))
        assert np.all((activity >= copy.row_lower - 1e-8) & (activity <= copy.row_upper + 1e-8))
        assert copy.cost @ point == pytest.approx(least, abs=1e-7)
        basis = copy.lp.basis()


@pytest.mark.parametrize("seed", range(20))
def test_begun_where_it_ended_nothing_is_left_to_do(seed: int) -> None:
    rng = np.random.default_rng(seed)
    copy = Copy(rng)
    copy.grow(rng)
    (outcome, bound), basis, cost = copy.lp.solve(), copy.lp.basis(), copy.cost
    copy.charge(rng)
    copy.lp.solve()
    copy.lp.change_cost(cost)
    copy.lp.begin_with(basis)
    before = copy.lp.compiled.pivots
    assert copy.lp.solve() == (outcome, pytest.approx(bound, abs=1e-9))
    if outcome is LpOutcome.OPTIMAL:
        assert copy.lp.compiled.pivots <= before + 2  # columns without cost are anywhere


@pytest.mark.parametrize("seed", range(20))
def test_its_proofs_are_those_of_the_record_that_looks_after_highs(seed: int) -> None:
    rng = np.random.default_rng(seed)
    copy = Copy(rng)
    for _ in range(3):
        copy.grow(rng)
    outcome, bound = copy.lp.solve()
    if outcome is not LpOutcome.OPTIMAL:
        return
    # Multipliers of the rows that are active, found again from the basis.
    rows, columns = np.frombuffer(copy.lp.basis(), dtype=np.int32).reshape(2, -1)
    multipliers = np.zeros(len(copy.rows))
    multipliers[rows] = np.linalg.solve(copy.rows[np.ix_(rows, columns)].T, copy.cost[columns])
    record = LpRecord(copy.cost, copy.lower, copy.upper)
    matrix = csr_array(copy.rows)
    parts = matrix.indptr, matrix.indices, matrix.data
    record.add_rows(*parts, copy.row_lower, copy.row_upper)
    assert record.least(multipliers) == pytest.approx(bound, abs=1e-7)


def test_what_takes_it_too_long_is_left_to_highs(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("radmpc.solvers.lp.simplex_lp.LEAST_PIVOTS", 0)
    monkeypatch.setattr("radmpc.solvers.lp.simplex_lp.PIVOTS", 0)
    asked = []
    honest = HighsLp.solve
    monkeypatch.setattr(HighsLp, "solve", lambda lp, *of: (asked.append(lp), honest(lp, *of))[1])
    solved = 0
    for seed in range(12):
        rng = np.random.default_rng(seed)
        copy = Copy(rng)
        copy.grow(rng)
        copy.widen(rng)
        least = copy.least()
        outcome, bound = copy.lp.solve()
        assert bound == pytest.approx(least, abs=1e-6)
        if outcome is LpOutcome.OPTIMAL:
            assert copy.cost @ copy.lp.point() == pytest.approx(least, abs=1e-6)
            solved += 1
    assert solved > 3
    assert asked


def test_an_unbounded_column_is_left_where_its_cost_wants_it() -> None:
    # min x + y over x + 2 y >= 3, without upper bounds; then with y dearer.
    lp = SimplexLp(np.ones(2), np.zeros(2), np.full(2, np.inf))
    lp.add_row(np.array([0, 1], dtype=np.int32), np.array([1.0, 2.0]), 3.0, np.inf)
    assert lp.solve()[0] is LpOutcome.OPTIMAL
    assert lp.point().tolist() == [0.0, 1.5]
    lp.change_cost(np.array([1.0, 5.0]))
    assert lp.solve()[0] is LpOutcome.OPTIMAL
    assert lp.point().tolist() == [3.0, 0.0]


@pytest.mark.parametrize(
    ("cost", "pivot"),
    [(858830233.8216937, 1.3022701777491792), (93175190.14656098, 8.49379732888058)],
)
def test_a_ratio_that_is_rounded_down_enters_all_the_same(cost: float, pivot: float) -> None:
    # Beside such a cost the tolerance is nothing: the least ratio times its pivot is less.
    assert (cost + 1e-9) / pivot * pivot < cost
    lp = SimplexLp(np.array([1.0, cost]), np.zeros(2), np.ones(2))
    lp.add_row(np.array([0, 1], dtype=np.int32), np.array([1e-12, pivot]), 1.0, np.inf)
    number, bound = lp.compiled.solve(np.inf, 10)
    assert number == 0
    assert bound == pytest.approx(cost / pivot)
    assert lp.point() == pytest.approx([0.0, 1.0 / pivot])


@pytest.mark.parametrize("wrong", [np.nan, np.inf])
def test_a_cost_that_is_no_number_proves_nothing(wrong: float) -> None:
    lp = SimplexLp(np.array([wrong, 1.0]), np.zeros(2), np.ones(2))
    lp.add_row(np.array([0, 1], dtype=np.int32), np.array([1.0, wrong]), 1.0, np.inf)
    assert lp.compiled.solve(np.inf, 10)[1] == -np.inf


@pytest.mark.parametrize(
    ("call", "said"),
    [
        (lambda p: p.add_rows(ints(0, 1), ints(7), np.ones(1), np.ones(1), np.ones(1)), "column"),
        (lambda p: p.add_rows(ints(0, 9), ints(0), np.ones(1), np.ones(1), np.ones(1)), "entries"),
        (lambda p: p.add_rows(ints(0), ints(0), np.ones(1), np.ones(1), np.ones(1)), "length"),
        (lambda p: p.add_column(1.0, 1.0, ints(3), np.ones(1)), "row"),
        (lambda p: p.bound_rows(ints(-1), np.ones(1), np.ones(1)), "row"),
        (lambda p: p.change_cost(np.ones(5)), "cost per column"),
        (lambda p: p.begin_with(b"\0\0\0\0\0\0\0\0"), "basis"),
        (lambda p: p.begin_with(b"\0"), "basis"),
        (lambda p: p.point(np.ones(9)), "number per column"),
    ],
)
def test_compiled_code_refuses_what_would_lead_it_astray(call, said: str) -> None:
    program = _compiled.Program(np.ones(2), np.zeros(2), np.ones(2), 1e-9)
    with pytest.raises(ValueError, match=said):
        call(program)
    with pytest.raises(TypeError, match="float64"):
        program.change_cost(np.ones(2, dtype=np.float32))
    assert program.solve(np.inf, 10) == (0, pytest.approx(0.0, abs=1e-12))


def ints(*numbers: int) -> np.ndarray:
    return np.array(numbers, dtype=np.int32)


@pytest.mark.slow
def test_without_compiled_code_plans_are_as_good(monkeypatch: pytest.MonkeyPatch) -> None:
    scenario = paper(4, 1)
    compiled = plan(scenario)
    monkeypatch.setattr("radmpc.solvers.compiled_code._compiled", None)
    assert isinstance(bounded_lp(np.ones(1), np.zeros(1), np.ones(1)), HighsLp)
    by_highs = plan(scenario)
    assert compiled.cost == pytest.approx(by_highs.cost, rel=1e-3)
    assert compiled.certified_lower_bound <= by_highs.cost + 1e-9
    assert by_highs.certified_lower_bound <= compiled.cost + 1e-9
