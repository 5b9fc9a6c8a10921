"""The linear program of optimal risk allocation: chosen rows with a column each for their risk.

On clearances q >= 0 the tail Q is convex and q is affine in the variables, so the tangents

    t >= (Q(q₀) − φ(q₀) (q − q₀)) / unit

never exceed Q: the program underestimates the risk of the chosen rows, and its optimum bounds
that of every solution which chooses them. A column t is measured in units of the budget and at
most 1, or what 0.5 is of a larger unit; with the tangent at that risk's clearance, that keeps
q >= 0 without a row of its own.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from radmpc.arrays import Indices, Vector
from radmpc.gaussian import CONVEX_RISK, clearance_for, tail_probability, tail_slope
from radmpc.program.program import DisjunctiveProgram
from radmpc.solvers.lp.highs_lp import HighsLp, LpOutcome, Numbers
from radmpc.solvers.priced.tuning import TUNING

__all__ = ["RiskLp", "SetBound"]

_INF = float("inf")
_DEAR = 1e6
"""Price from which rows with prices in them are scaled down [cost]: HiGHS refuses entries of
1e15."""

_APART = 1e-4
"""Least distance of two tangents of a row [standard deviations]: closer ones are nearly
parallel."""


@dataclass(frozen=True, slots=True)
class SetBound:
    """A proven lower bound on some blocks: ``cost + price · risk / unit >= value``.

    Attributes
    ----------
    blocks : frozenset of int
        The blocks.
    value : float
        Lower bound in any solution, risks between these blocks and within each included.
    """

    blocks: frozenset[int]
    value: float


@dataclass(frozen=True, slots=True, eq=False)
class _Row:
    """A chance row in the linear program: its rows there, their right sides, their tangents."""

    numbers: list[int]
    lowers: list[float]
    clearances: list[float]


class RiskLp:
    """The program's hard rows, the chance rows seen so far, and their risk columns.

    Parameters
    ----------
    program : DisjunctiveProgram
        The program.
    unit : float
        Risk budget: the risk that a column's 1 stands for. The chosen rows may not risk more
        together, nor any of them more than `CONVEX_RISK`.
    price : float
        Cost of one unit of risk: the Lagrange multiplier of the risk bound.
    bounds : sequence of SetBound
        Proven lower bounds of parts, at this price.
    """

    def __init__(
        self,
        program: DisjunctiveProgram,
        unit: float,
        price: float,
        bounds: Sequence[SetBound] = (),
    ) -> None:
        self.program = program
        self.unit = unit
        self.price = price
        self.row_cap = min(unit, CONVEX_RISK)
        self.floor = float(clearance_for(self.row_cap))
        self._row_scale = 1.0 if price <= _DEAR else _DEAR / price
        self.dropped_solves = 0
        rows = program.rows
        self._right = rows.offsets - rows.normals @ program.constant
        self._coefficients: dict[int, tuple[Numbers, Vector]] = {}
        self._tangents = (self.floor, *(q for q in TUNING.first_tangents if q > self.floor + 0.2))
        self._bounds = tuple(sorted(bounds, key=lambda b: (len(b.blocks), sorted(b.blocks))))
        self._start()

    @property
    def solves(self) -> int:
        """Linear programs solved."""
        return self._lp.solves + self.dropped_solves

    def _start(self) -> None:
        """Load columns, hard rows and proven bounds; no chance row yet."""
        program = self.program
        self._rows: dict[int, _Row] = {}
        self._risk_columns: dict[int, int] = {}
        self._active: set[int] = set()
        self._lp = HighsLp(program.cost, program.lower, program.upper)
        self._lp.add_rows(program.hard, program.hard_lower, program.hard_upper)
        # No plan risks more than the whole unit, whatever the price.
        self._budget_row = self._lp.add_row(np.zeros(0, dtype=np.int32), np.zeros(0), -_INF, 1.0)
        self._bound_rows: list[tuple[frozenset[int], int]] = []
        remainders: dict[frozenset[int], int] = {}
        for bound in self._bounds:
            # What is risked beyond the chosen rows, by vehicle and by pair: charged once each.
            members = sorted(bound.blocks)
            parts = [frozenset(c) for size in (1, 2) for c in combinations(members, size)]
            for part in parts:
                if part not in remainders:
                    # The budget's row holds it to one unit anyway; said here, it is finite.
                    remainders[part] = self._lp.add_column(
                        self.price, 1.0, np.array([self._budget_row], dtype=np.int32), np.ones(1)
                    )
            inner = [remainders[part] for part in parts]
            columns = np.flatnonzero(np.isin(program.blocks, members))
            row = self._lp.add_row(
                np.append(columns, inner).astype(np.int32),
                self._row_scale * np.append(program.cost[columns], np.full(len(inner), self.price)),
                self._row_scale * bound.value,
                _INF,
            )
            self._bound_rows.append((bound.blocks, row))

    def activate(self, rows: Iterable[int]) -> None:
        """Switch exactly these chance rows on, adding those that are new."""
        target = set(rows)
        if self._lp.num_rows > TUNING.crowd + 12 * len(target):
            # Rows switched off still cost time in every pivot: begin again without them.
            self.dropped_solves += self._lp.solves
            self._start()
        for row in sorted(target - self._rows.keys()):
            self._add(row)
        numbers: list[int] = []
        lowers: list[float] = []
        for row in self._active - target:
            numbers += self._rows[row].numbers
            lowers += [-_INF] * len(self._rows[row].numbers)
        for row in target - self._active:
            numbers += self._rows[row].numbers
            lowers += self._rows[row].lowers
        self._lp.bound_rows(numbers, np.array(lowers), np.full(len(lowers), _INF))
        self._active = target

    def _add(self, row: int) -> None:
        """Append a chance row, switched off."""
        self._rows[row] = _Row([], [], [])
        if self.program.rows.deviations[row] > 0.0:
            self._add_risk_column(row)
            self._add_tangents(row, self._tangents, is_active=False)
            return
        columns, values = self._row_coefficients(row)
        number = self._lp.add_row(columns, -values, -_INF, _INF)
        self._rows[row].numbers.append(number)
        self._rows[row].lowers.append(-float(self._right[row]))

    def _add_risk_column(self, row: int) -> None:
        """Append the column of a row's event, if it has none yet."""
        event = int(self.program.rows.events[row])
        if event in self._risk_columns:
            return
        touched = frozenset(
            int(b) for b in np.unique(self.program.blocks[self._row_coefficients(row)[0]])
        )
        rows = [number for blocks, number in self._bound_rows if touched <= blocks]
        values = [self._row_scale * self.price] * len(rows)
        rows.append(self._budget_row)
        values.append(1.0)
        self._risk_columns[event] = self._lp.add_column(
            self.price, self.row_cap / self.unit, np.array(rows, dtype=np.int32), np.array(values)
        )

    def add_tangent(self, row: int, clearance: float) -> bool:
        """Add an active row's tangent, unless it has one close by; return whether it was added.

        Parameters
        ----------
        row : int
            A row with noise.
        clearance : float
            Where, >= 0 [standard deviations].
        """
        is_new = min(abs(clearance - q) for q in self._rows[row].clearances) > _APART
        if is_new:
            self._add_tangents(row, (clearance,), is_active=True)
        return is_new

    def _add_tangents(self, row: int, at: tuple[float, ...], *, is_active: bool) -> None:
        """Append tangents at some clearances."""
        columns, values = self._row_coefficients(row)
        clearances = np.array(at)
        slopes = -tail_slope(clearances) / self.unit
        steepness = slopes / float(self.program.rows.deviations[row])
        lowers = tail_probability(clearances) / self.unit + slopes * clearances
        lowers = lowers - steepness * float(self._right[row])
        count, width = len(at), columns.size + 1
        entries = np.ones((count, width))
        entries[:, :-1] = -steepness[:, None] * values
        where = np.empty((count, width), dtype=np.int32)
        where[:, :-1] = columns
        where[:, -1] = self._risk_columns[int(self.program.rows.events[row])]
        first = self._lp.add_dense_rows(where, entries, lowers if is_active else None)
        added = self._rows[row]
        added.numbers.extend(range(first, first + count))
        added.lowers.extend(lowers.tolist())
        added.clearances.extend(at)

    def _row_coefficients(self, row: int) -> tuple[Numbers, Vector]:
        """Return a chance row over the decision variables."""
        cached = self._coefficients.get(row)
        if cached is None:
            cached = self._coefficients[row] = self.program.column_row(row)
        return cached

    def solve(self, cutoff: float = _INF) -> tuple[LpOutcome, float]:
        """Minimize over the active rows; see `HighsLp.solve`."""
        return self._lp.solve(cutoff)

    def point(self) -> Vector:
        """Return the decision variables, then all other columns, of the last optimal solve."""
        return self._lp.point()

    def allocated(self, rows: Indices, point: Vector) -> Vector:
        """Return the risk that a point's columns allocate to active rows.

        Parameters
        ----------
        rows : (k,) int array
            Rows with noise.
        point : (c,) array
            All columns of a solution.

        Returns
        -------
        (k,) array
            Probabilities; rows of one event share a column.
        """
        events = self.program.rows.events[rows]
        columns = [self._risk_columns[int(e)] for e in events]
        return self.unit * point[columns]
