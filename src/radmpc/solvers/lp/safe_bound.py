"""What dual values prove of a linear program, whatever the solver says and how it rounds.

For any ``y`` and bounded columns, with ``r = c − Aᵀy``,

    min c·x over L <= Ax <= U, l <= x <= u  >=  Σᵢ yᵢ (Lᵢ if yᵢ > 0 else Uᵢ) + Σⱼ min(rⱼlⱼ, rⱼuⱼ)

(Neumaier and Shcherbina 2004). Evaluated on a copy of the program, and lowered by what the
evaluation itself may round, it holds whatever ``y`` came from: a wrong ``y`` makes it weak, never
wrong. With ``c = 0`` and a positive value it proves that no ``x`` exists.
"""

from __future__ import annotations

from math import isfinite

import numpy as np
import numpy.typing as npt

from radmpc.arrays import Indices, Integers, Vector

__all__ = ["LpRecord"]

_ULP = float(np.finfo(np.float64).eps)
"""Twice the largest relative error of one operation."""

_BEGIN = 256
"""Initial capacity of a growing array [-]; it doubles from there."""


class _Growing:
    """An array that grows as values are appended."""

    def __init__(self, kind: npt.DTypeLike) -> None:
        self.size = 0
        self._data = np.zeros(_BEGIN, dtype=kind)

    def append(self, values: npt.ArrayLike, count: int) -> None:
        """Append ``count`` values, or one value ``count`` times."""
        last = self.size + count
        if last > self._data.size:
            grown = np.zeros(2 * last, dtype=self._data.dtype)
            grown[: self.size] = self.all
            self._data = grown
        self._data[self.size : last] = values
        self.size = last

    def at(self, places: Indices) -> np.ndarray:
        """Return a copy of what is at some places that were appended."""
        return self._data.take(places)

    @property
    def all(self) -> np.ndarray:
        """What was appended so far, as a writable view."""
        return self._data[: self.size]


class LpRecord:
    """A copy of a linear program's columns and rows, kept in step with the solver's.

    Parameters
    ----------
    cost, lower, upper : (n,) array
        Of the first columns; an infinite bound leaves next to nothing to be proven.
    """

    def __init__(self, cost: Vector, lower: Vector, upper: Vector) -> None:
        self._cost = _Growing(np.float64)
        self._lower, self._upper = _Growing(np.float64), _Growing(np.float64)
        self._largest = _Growing(np.float64)
        """Largest magnitude of each column."""
        self._row_lower, self._row_upper = _Growing(np.float64), _Growing(np.float64)
        # Entries that came with their row: of row i, so many from its start.
        self._starts, self._sizes = _Growing(np.int64), _Growing(np.int64)
        self._columns, self._values = _Growing(np.int64), _Growing(np.float64)
        # Entries that came with their column.
        self._late_rows, self._late_columns = _Growing(np.int64), _Growing(np.int64)
        self._late_values = _Growing(np.float64)
        largest = np.maximum(np.abs(lower), np.abs(upper))
        self._cost.append(cost, cost.size)
        self._lower.append(lower, cost.size)
        self._upper.append(upper, cost.size)
        self._largest.append(largest, cost.size)
        self._cost_weight = float(np.abs(cost) @ largest)
        self.is_contradictory = bool(np.any(lower > upper))

    def add_rows(
        self,
        starts: Integers,
        columns: Integers,
        values: Vector,
        lower: npt.ArrayLike,
        upper: npt.ArrayLike,
    ) -> None:
        """Append k rows; row i has the entries from ``starts[i]`` to ``starts[i + 1]``.

        Parameters
        ----------
        starts : (k+1,) int array
            Where each row's entries start, and the end.
        columns, values : (entries,) array
            Columns and coefficients.
        lower, upper : (k,) array or float
            Bounds, ±inf where there is none.
        """
        count = starts.size - 1
        self._starts.append(self._values.size + starts[:-1], count)
        self._sizes.append(starts[1:] - starts[:-1], count)
        self._row_lower.append(lower, count)
        self._row_upper.append(upper, count)
        self._columns.append(columns, values.size)
        self._values.append(values, values.size)

    def add_column(self, cost: float, upper: float, rows: Integers, values: Vector) -> None:
        """Append a column that is at least 0.

        Parameters
        ----------
        cost, upper : float
            Its cost and upper bound.
        rows, values : (w,) array
            Rows and coefficients of its entries.
        """
        self._late_rows.append(rows, values.size)
        self._late_columns.append(self._cost.size, values.size)
        self._late_values.append(values, values.size)
        self._cost.append(cost, 1)
        self._lower.append(0.0, 1)
        self._upper.append(upper, 1)
        self._largest.append(upper, 1)
        self._cost_weight += abs(cost) * upper

    def bound_rows(self, rows: Integers, lower: Vector, upper: Vector) -> None:
        """Change the bounds of rows.

        Parameters
        ----------
        rows : (k,) int array
            Their numbers.
        lower, upper : (k,) array
            New bounds, ±inf where there is none.
        """
        self._row_lower.all[rows] = lower
        self._row_upper.all[rows] = upper

    def change_cost(self, cost: Vector) -> None:
        """Change the costs of all columns.

        Parameters
        ----------
        cost : (n,) array
            Of every column.
        """
        self._cost.all[:] = cost
        self._cost_weight = float(np.abs(cost) @ self._largest.all)

    def cost_at(self, point: Vector) -> float:
        """Return what a point costs."""
        return float(self._cost.all @ point)

    def least(self, duals: Vector) -> float:
        """Return a lower bound on the cost of every point; −inf if these values prove none.

        Parameters
        ----------
        duals : (r,) array
            A value per row, from anywhere.
        """
        return self._proven(duals, self._cost.all, self._cost_weight)

    def has_no_point(self, ray: Vector) -> bool:
        """Whether a dual ray proves that no point satisfies the rows, in either direction."""
        nothing = np.zeros(self._cost.size)
        return any(self._proven(sign * ray, nothing, 0.0) > 0.0 for sign in (1.0, -1.0))

    def _proven(self, duals: Vector, cost: Vector, cost_weight: float) -> float:
        """Evaluate the bound, rounded down."""
        (used,) = duals.nonzero()
        chosen = duals[used]
        is_lower = chosen > 0.0
        bounds = np.where(is_lower, self._row_lower.at(used), self._row_upper.at(used))
        by_rows = chosen * bounds
        from_rows = float(by_rows.sum())
        if not isfinite(from_rows):
            # A dual value on an infinite bound proves nothing: leave it out.
            left = np.zeros(duals.size)
            left[used] = np.where(np.isfinite(by_rows), chosen, 0.0)
            return self._proven(left, cost, cost_weight)
        columns, terms = self._terms(used, chosen, duals)
        reduced = cost - np.bincount(columns, terms, minlength=cost.size)
        by_columns = np.minimum(reduced * self._lower.all, reduced * self._upper.all)
        # No sum below, nor any in `reduced`, has more terms than this, and none of their terms
        # add up to more than `size`: twice what rounding can do.
        count = used.size + cost.size + 8
        size = cost_weight + float(np.abs(terms) @ self._largest.at(columns))
        size += float(np.abs(by_rows).sum())
        value = from_rows + float(by_columns.sum()) - count * _ULP * size
        return value if isfinite(value) else -np.inf

    def _terms(self, used: Indices, chosen: Vector, duals: Vector) -> tuple[Indices, Vector]:
        """Return entries times their row's dual value, of rows that have one, by column."""
        sizes = self._sizes.at(used)
        ends = sizes.cumsum()
        starts = self._starts.at(used) - ends
        starts += sizes
        places = starts.repeat(sizes)
        places += np.arange(places.size)
        columns = self._columns.at(places)
        terms = self._values.at(places)
        terms *= chosen.repeat(sizes)
        late = duals[self._late_rows.all]
        if not late.any():
            return columns, terms
        late *= self._late_values.all
        return (
            np.concatenate([columns, self._late_columns.all]),
            np.concatenate([terms, late]),
        )
