"""A linear program with bounded columns, grown by rows and columns and solved warm."""

from __future__ import annotations

from abc import ABC, abstractmethod

import numpy as np
from scipy.sparse import csr_array

from radmpc.arrays import Matrix, Vector
from radmpc.solvers.lp.outcome import NO_NUMBERS, NO_VALUES, LpOutcome, Numbers

__all__ = ["BoundedLp", "floats"]


class BoundedLp(ABC):
    """Columns and rows in the order they were added; minimized from where the last solve ended.

    Attributes
    ----------
    solves : int
        Times that a solver was asked.
    """

    def __init__(self) -> None:
        self.solves = 0

    @property
    @abstractmethod
    def num_columns(self) -> int:
        """Columns now."""

    @property
    @abstractmethod
    def num_rows(self) -> int:
        """Rows now."""

    def add_rows(self, matrix: csr_array, lower: Vector, upper: Vector) -> int:
        """Append rows; return the number of the first.

        Parameters
        ----------
        matrix : (k, n) sparse array
            Coefficients.
        lower, upper : (k,) array
            Bounds, ±inf where there is none.
        """
        starts, columns = matrix.indptr.astype(np.int32), matrix.indices.astype(np.int32)
        return self.add_packed_rows(
            starts, columns, floats(matrix.data), floats(lower), floats(upper)
        )

    def add_dense_rows(self, columns: Numbers, values: Matrix, lower: Vector) -> int:
        """Append rows of equal length without upper bounds; return the number of the first.

        Parameters
        ----------
        columns : (k, w) int array
            Columns of each row's entries.
        values : (k, w) array
            Its coefficients.
        lower : (k,) array
            Lower bounds.
        """
        count, width = values.shape
        starts = np.arange(0, (count + 1) * width, width, dtype=np.int32)
        return self.add_packed_rows(starts, columns, values, lower, np.full(count, np.inf))

    def add_row(self, columns: Numbers, values: Vector, lower: float, upper: float) -> int:
        """Append one row; return its number.

        Parameters
        ----------
        columns : (w,) int array
            Columns of its entries.
        values : (w,) array
            Its coefficients.
        lower, upper : float
            Bounds, ±inf where there is none.
        """
        starts = np.array([0, len(columns)], dtype=np.int32)
        bounds = np.array([lower], dtype=float), np.array([upper], dtype=float)
        return self.add_packed_rows(starts, columns, floats(values), *bounds)

    def add_packed_rows(
        self, starts: Numbers, columns: Numbers, values: Matrix, lower: Vector, upper: Vector
    ) -> int:
        """Append rows as compiled code takes them; return the number of the first.

        Parameters
        ----------
        starts : (k+1,) int array
            Row i has the entries from ``starts[i]`` to ``starts[i + 1]``.
        columns : (e,) int array
            Their columns.
        values : (e,) array
            Their coefficients.
        lower, upper : (k,) array
            Bounds, ±inf where there is none.
        """
        first = self.num_rows
        self._append_rows(starts, columns, values, lower, upper)
        return first

    def add_column(
        self, cost: float, upper: float, rows: Numbers = NO_NUMBERS, values: Vector = NO_VALUES
    ) -> int:
        """Append one column, at least 0; return its number.

        Parameters
        ----------
        cost, upper : float
            Its cost and upper bound.
        rows : (w,) int array
            Rows of its entries.
        values : (w,) array
            Its coefficients.
        """
        self._append_column(cost, upper, rows, values)
        return self.num_columns - 1

    def bound_rows(self, rows: list[int], lower: Vector, upper: Vector) -> None:
        """Change the bounds of some rows.

        Parameters
        ----------
        rows : list of int
            Their numbers.
        lower, upper : (k,) array
            New bounds, ±inf where there is none.
        """
        if rows:
            self._bound_rows(np.array(rows, dtype=np.int32), floats(lower), floats(upper))

    def change_cost(self, cost: Vector) -> None:
        """Give all columns other costs; the next solves go on from the last vertex.

        Parameters
        ----------
        cost : (n,) array
            Of every column.
        """
        self._change_cost(floats(cost))

    @abstractmethod
    def solve(self, cutoff: float = float("inf")) -> tuple[LpOutcome, float]:
        """Minimize.

        Parameters
        ----------
        cutoff : float
            Give up as soon as the cost is proven to be at least this.

        Returns
        -------
        (LpOutcome, float)
            The outcome and a proven lower bound on the cost: near the least where optimal, inf
            where infeasible, at least the cutoff where cut off; where no solver had an answer, what
            is proven.
        """

    @abstractmethod
    def point(self) -> Vector:
        """Return the columns of the last optimal solve."""

    def basis(self) -> bytes:
        """Return where the last solve ended; empty where that is not to be had."""
        return b""

    def begin_with(self, basis: bytes) -> None:
        """Begin the next solve where another one ended; if that is empty, where the last one did.

        Parameters
        ----------
        basis : bytes
            From `basis` of this program.
        """
        del basis  # HiGHS goes on from where it ended

    @abstractmethod
    def _append_rows(
        self, starts: Numbers, columns: Numbers, values: Matrix, lower: Vector, upper: Vector
    ) -> None:
        """Append rows."""

    @abstractmethod
    def _append_column(self, cost: float, upper: float, rows: Numbers, values: Vector) -> None:
        """Append one column."""

    @abstractmethod
    def _bound_rows(self, rows: Numbers, lower: Vector, upper: Vector) -> None:
        """Change the bounds of rows."""

    @abstractmethod
    def _change_cost(self, cost: Vector) -> None:
        """Change all costs."""


def floats(values: Vector) -> Vector:
    """Return an array as compiled code takes it: itself, if it is so.

    Parameters
    ----------
    values : array
        Of any kind of numbers.
    """
    return np.ascontiguousarray(values, dtype=np.float64)
