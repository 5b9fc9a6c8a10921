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
from itertools import combinations

import numpy as np

from radmpc.arrays import Indices, Matrix, Vector
from radmpc.program.program import DisjunctiveProgram
from radmpc.records import dataclass
from radmpc.solvers.lp.choosing import bounded_lp
from radmpc.solvers.lp.outcome import LpOutcome, Numbers
from radmpc.solvers.priced.row_tangents import RowTangents, Touching
from radmpc.solvers.priced.tuning import TUNING

__all__ = ["Basis", "RiskLp", "SetBound"]

Basis = tuple[int, bytes]
"""A vertex of a `RiskLp`: how often it was loaded by then, and the basis there."""

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
    tangents : RowTangents or None
        The tangents of the program's rows for this unit, if at hand.
    """

    def __init__(
        self,
        program: DisjunctiveProgram,
        unit: float,
        price: float,
        bounds: Sequence[SetBound] = (),
        tangents: RowTangents | None = None,
    ) -> None:
        self.program = program
        self.unit = unit
        self.price = price
        self._tangents = RowTangents(program, unit) if tangents is None else tangents
        self.row_cap, self.floor = self._tangents.row_cap, self._tangents.floor
        self._row_scale = 1.0 if price <= _DEAR else _DEAR / price
        self.dropped_solves = 0
        self._starts = 0
        self._bounds = tuple(sorted(bounds, key=lambda b: (len(b.blocks), sorted(b.blocks))))
        self._start()

    @property
    def solves(self) -> int:
        """Linear programs solved."""
        return self._lp.solves + self.dropped_solves

    def _start(self) -> None:
        """Load columns, hard rows and proven bounds; no chance row yet."""
        program = self.program
        self._starts += 1
        self._rows: dict[int, _Row] = {}
        self._risk_columns: dict[int, int] = {}
        self._active: set[int] = set()
        self._lp = bounded_lp(program.cost, program.lower, program.upper)
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
        new = sorted(target - self._rows.keys())
        numbers: list[int] = []
        lowers: list[float] = []
        for row in self._active - target:
            numbers += self._rows[row].numbers
            lowers += [-_INF] * len(self._rows[row].numbers)
        for row in target - self._active:
            if row in self._rows:
                numbers += self._rows[row].numbers
                lowers += self._rows[row].lowers
        self._lp.bound_rows(numbers, np.array(lowers), np.full(len(lowers), _INF))
        for row in new:
            self._add(row)
        self._active = target

    def _add(self, row: int) -> None:
        """Append a chance row, switched on."""
        self._rows[row] = _Row([], [], [])
        if self._tangents.is_noisy[row]:
            column = self._risk_column(row)
            self._append(row, self._tangents.first, self._tangents.beginning(row, column))
            return
        columns, values = self._tangents.coefficients(row)
        lower = -float(self._tangents.right[row])
        number = self._lp.add_row(columns, -values, lower, _INF)
        self._rows[row].numbers.append(number)
        self._rows[row].lowers.append(lower)

    def _risk_column(self, row: int) -> int:
        """Return the column of a row's event, appended if it has none yet."""
        event = self._tangents.events[row]
        known = self._risk_columns.get(event)
        if known is not None:
            return known
        touched: frozenset[int] = frozenset()
        if self._bound_rows:
            columns, _ = self._tangents.coefficients(row)
            touched = frozenset(self.program.blocks[columns].tolist())
        rows = [number for blocks, number in self._bound_rows if touched <= blocks]
        values = [self._row_scale * self.price] * len(rows)
        rows.append(self._budget_row)
        values.append(1.0)
        column = self._lp.add_column(
            self.price, self.row_cap / self.unit, np.array(rows, dtype=np.int32), np.array(values)
        )
        self._risk_columns[event] = column
        return column

    def add_tangents(self, rows: list[int], clearances: Vector) -> bool:
        """Add one tangent to each of some active rows, unless it has one close by.

        Parameters
        ----------
        rows : (k,) list of int
            Rows with noise.
        clearances : (k,) array
            Where, >= 0 [standard deviations].

        Returns
        -------
        bool
            Whether any was added.
        """
        added = False
        for i, (row, at) in enumerate(zip(rows, clearances.tolist(), strict=True)):
            if min(abs(at - q) for q in self._rows[row].clearances) > _APART:
                touching = Touching.at(clearances[i : i + 1], self.unit, self._tangents.tail)
                column = self._risk_column(row)
                self._append(row, touching, self._tangents.tangents(row, touching, column))
                added = True
        return added

    def _append(self, row: int, touching: Touching, rows: tuple[Numbers, Matrix, Vector]) -> None:
        """Append tangents to a row, switched on."""
        columns, entries, lowers = rows
        first = self._lp.add_dense_rows(columns, entries, lowers)
        added = self._rows[row]
        added.numbers.extend(range(first, first + lowers.size))
        added.lowers.extend(lowers.tolist())
        added.clearances.extend(touching.clearances.tolist())

    def solve(self, cutoff: float = _INF) -> tuple[LpOutcome, float]:
        """Minimize over the active rows; see `BoundedLp.solve`."""
        return self._lp.solve(cutoff)

    def basis(self) -> Basis:
        """Return where the last solve ended."""
        return self._starts, self._lp.basis()

    def begin_with(self, basis: Basis) -> None:
        """Begin the next solve where another one ended, unless rows were dropped since.

        Parameters
        ----------
        basis : (int, bytes)
            From `basis`.
        """
        starts, vertex = basis
        if starts == self._starts:
            self._lp.begin_with(vertex)

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
        columns = [self._risk_columns[self._tangents.events[row]] for row in rows.tolist()]
        return self.unit * point[columns]
