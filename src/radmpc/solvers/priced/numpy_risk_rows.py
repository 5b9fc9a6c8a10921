"""Chance rows in a linear program, where there is no compiled code."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from radmpc.arrays import Matrix, Vector
from radmpc.records import dataclass
from radmpc.solvers.lp.outcome import Numbers
from radmpc.solvers.priced.rating import Rating
from radmpc.solvers.priced.risk_rows import FLAT, RiskRows, Surroundings
from radmpc.solvers.priced.row_tangents import RowTangents, Touching
from radmpc.solvers.priced.tuning import TUNING

__all__ = ["NumpyRiskRows"]

_INF = float("inf")

_APART = 1e-4
"""Least distance of two tangents of a row [standard deviations]: closer ones are nearly parallel.
The same in `compiled/risk_rows.c`."""


@dataclass(frozen=True, slots=True, eq=False)
class _Row:
    """A chance row in the linear program: its rows there, their right sides, their tangents."""

    numbers: list[int]
    lowers: list[float]
    clearances: list[float]


class NumpyRiskRows(RiskRows):
    """`RiskRows` in Python.

    Parameters
    ----------
    around : Surroundings
        What rows are added to.
    tangents : RowTangents
        The tangents of the program's rows for its unit.
    """

    def __init__(self, around: Surroundings, tangents: RowTangents) -> None:
        self._around, self._tangents = around, tangents
        self._lp = around.lp
        self._flat = float(tangents.tail.clearance_for(FLAT * around.unit))
        self._rows: dict[int, _Row] = {}
        self._risk_columns: dict[int, int] = {}
        self._active: set[int] = set()

    def activate(self, alternatives: tuple[int, ...]) -> bool:
        """Switch the rows of alternatives on, see `RiskRows.activate`.

        Parameters
        ----------
        alternatives : tuple of int
            Their numbers.
        """
        target = {row for chosen in alternatives for row in self._tangents.rows_of[chosen]}
        if self._lp.num_rows > self._around.crowd + TUNING.crowd_each * len(target):
            return False
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
        for row in sorted(target - self._rows.keys()):
            self._add(row)
        self._active = target
        return True

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
        around = self._around
        columns, _ = self._tangents.coefficients(row)
        touched = frozenset(around.program.blocks[columns].tolist())
        rows = [number for blocks, number in around.bound_rows if touched <= blocks]
        values = [around.row_scale * around.price] * len(rows)
        rows.append(around.budget_row)
        values.append(1.0)
        column = self._lp.add_column(
            around.price,
            self._tangents.row_cap / around.unit,
            np.array(rows, dtype=np.int32),
            np.array(values),
        )
        self._risk_columns[event] = column
        return column

    def refine(self, rating: Rating, point: Vector, tolerance: float) -> bool:
        """Add tangents where risk is underestimated, see `RiskRows.refine`.

        Parameters
        ----------
        rating : Rating
            Of the decision variables of a point.
        point : (c,) array
            All columns of it.
        tolerance : float
            Share of the unit by which risks may be underestimated in all [-].
        """
        noisy = sorted(row for row in self._active if self._tangents.is_noisy[row])
        if not noisy:
            return False
        rows = np.array(noisy)
        columns = [self._risk_columns[self._tangents.events[row]] for row in noisy]
        # Rows of one event share a column: a row below its share must not offset another above.
        missing = np.maximum(rating.risks(rows) / self._around.unit - point[columns], 0.0)
        if missing.sum() <= tolerance:
            return False
        rows = rows[missing > tolerance / (4.0 * rows.size)]
        clearances = rating.clearances[rows]
        is_near = clearances < self._flat
        at = np.maximum(clearances[is_near], self._tangents.floor)
        return self._touch(rows[is_near].tolist(), at)

    def _touch(self, rows: Sequence[int], clearances: Vector) -> bool:
        """Add a tangent to each of some rows that has none close by; tell whether any was added."""
        added = False
        for i, (row, at) in enumerate(zip(rows, clearances.tolist(), strict=True)):
            if min(abs(at - q) for q in self._rows[row].clearances) > _APART:
                touching = Touching.at(
                    clearances[i : i + 1], self._around.unit, self._tangents.tail
                )
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
