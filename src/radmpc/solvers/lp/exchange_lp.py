"""A linear program of which a part stays and a part is exchanged at every solve, kept warm.

For plans, not for proofs: its optimum is what HiGHS reports.
"""

from __future__ import annotations

import numpy as np
from scipy.sparse import csr_array

from radmpc.arrays import Indices, Vector
from radmpc.solvers.lp.quiet_highs import (
    FEASIBILITY_TOL,
    Flags,
    array_of,
    basic_of,
    begin_with,
    optimum,
    quiet_highs,
)

__all__ = ["ExchangeLp"]

_NO_NUMBERS = np.zeros(0, dtype=np.int32)
_NO_VALUES = np.zeros(0)

_PIVOTS = 20
"""Pivots per row and column after which a solve is given up [-], beside a thousand, since HiGHS can
cycle. No solve that ended needed a tenth of it."""


_DEVEX = 1
"""Weights of edges that cost nothing to begin with, for bases that are told."""


class ExchangeLp:
    """Columns and rows that stay, then those that are added for a solve and dropped after it.

    Attributes
    ----------
    num_rows, num_columns : int
        Rows and columns now, those exchanged included.
    work : float
        Pivots times rows and columns, summed over all solves [-]: a measure of time that is the
        same on any machine; a million takes 15 to 130 ms, the less the larger the program.
    """

    def __init__(self) -> None:
        self.num_rows = self.num_columns = 0
        self.work = 0.0
        self._exchanged_rows = self._exchanged_columns = 0
        self._highs = quiet_highs()
        self._highs.setOptionValue("presolve", "off")
        self._highs.setOptionValue("solver", "simplex")
        for kind in ("primal", "dual"):
            self._highs.setOptionValue(f"{kind}_feasibility_tolerance", FEASIBILITY_TOL)

    def add_columns(self, cost: Vector, lower: Vector, upper: Vector) -> int:
        """Append columns that stay; return the number of the first.

        Parameters
        ----------
        cost, lower, upper : (n,) array
            Costs and bounds, ±inf where there is none.
        """
        first = self.num_columns
        self._highs.addCols(cost.size, cost, lower, upper, 0, _NO_NUMBERS, _NO_NUMBERS, _NO_VALUES)
        self.num_columns += cost.size
        return first

    def add_rows(self, matrix: csr_array, lower: Vector, upper: Vector, first: int = 0) -> None:
        """Append rows that stay.

        Parameters
        ----------
        matrix : (k, n) sparse array
            Coefficients.
        lower, upper : (k,) array
            Bounds, ±inf where there is none.
        first : int
            The column that the matrix begins with.
        """
        starts = matrix.indptr[:-1].astype(np.int32)
        columns = (matrix.indices + first).astype(np.int32)
        count = int(matrix.shape[0])
        self._highs.addRows(count, lower, upper, matrix.nnz, starts, columns, matrix.data)
        self.num_rows += count

    def change_uppers(self, numbers: Indices, upper: Vector) -> None:
        """Give columns other upper bounds, and lower bounds of 0.

        Parameters
        ----------
        numbers : (n,) int array
            The columns.
        upper : (n,) array
            Upper bounds.
        """
        which = numbers.astype(np.int32)
        self._highs.changeColsBounds(upper.size, which, np.zeros(upper.size), upper)

    def change_rows(self, numbers: Indices, lower: Vector, upper: Vector) -> None:
        """Give rows that stay other bounds.

        Parameters
        ----------
        numbers : (n,) int array
            The rows.
        lower, upper : (n,) array
            Bounds, ±inf where there is none.
        """
        self._highs.changeRowsBounds(lower.size, numbers.astype(np.int32), lower, upper)

    def extend_columns(self, cost: Vector, upper: Vector) -> int:
        """Append columns, at least 0, that stay until the next `drop`.

        Parameters
        ----------
        cost, upper : (n,) array
            Costs and upper bounds, inf where there is none.

        Returns
        -------
        int
            The number of the first.
        """
        first = self.add_columns(cost, np.zeros(cost.size), upper)
        self._exchanged_columns += cost.size
        return first

    def extend_rows(self, matrix: csr_array, lower: Vector) -> None:
        """Append rows without upper bounds that stay until the next `drop`.

        Parameters
        ----------
        matrix : (k, n) sparse array
            Coefficients over all columns.
        lower : (k,) array
            Lower bounds.
        """
        self.add_rows(matrix, lower, np.full(lower.size, np.inf))
        self._exchanged_rows += lower.size

    def drop(self) -> None:
        """Take away what was exchanged last."""
        if self._exchanged_rows:
            first = self.num_rows - self._exchanged_rows
            numbers = np.arange(first, self.num_rows, dtype=np.int32)
            self._highs.deleteRows(numbers.size, numbers)
            self.num_rows, self._exchanged_rows = first, 0
        if self._exchanged_columns:
            first = self.num_columns - self._exchanged_columns
            numbers = np.arange(first, self.num_columns, dtype=np.int32)
            self._highs.deleteCols(numbers.size, numbers)
            self.num_columns, self._exchanged_columns = first, 0

    def bounds(
        self, num_columns: int, num_rows: int
    ) -> tuple[tuple[Vector, Vector], tuple[Vector, Vector]]:
        """Return lower and upper bounds of the first columns, and of the first rows.

        Parameters
        ----------
        num_columns, num_rows : int
            How many.
        """
        lp = self._highs.getLp()
        columns = (array_of(side)[:num_columns] for side in (lp.col_lower_, lp.col_upper_))
        rows = (array_of(side)[:num_rows] for side in (lp.row_lower_, lp.row_upper_))
        (lower, upper), (least, most) = columns, rows
        return (lower, upper), (least, most)

    def begin_with(self, columns: Indices, rows: Indices) -> None:
        """Begin the next solve with a basis, see `quiet_highs.begin_with`.

        Parameters
        ----------
        columns, rows : int array
            Where each is, those exchanged included.
        """
        self._highs.setOptionValue("simplex_dual_edge_weight_strategy", _DEVEX)
        begin_with(self._highs, columns, rows)

    def basic(self) -> tuple[Flags, Flags]:
        """Return which columns and which rows are basic where the last solve ended."""
        return basic_of(self._highs, self.num_columns, self.num_rows)

    def activities(self) -> Vector:
        """Return the left sides of all rows where the last solve ended."""
        return array_of(self._highs.getSolution().row_value)

    @property
    def objective(self) -> float:
        """The value of the last solve."""
        return float(self._highs.getInfo().objective_function_value)

    def solve(self, seconds: float = np.inf) -> Vector | None:
        """Minimize from where the last solve ended; return all columns, None without an optimum.

        Parameters
        ----------
        seconds : float
            After which it is given up [s].
        """
        # HiGHS counts the time of all solves so far.
        self._highs.setOptionValue("time_limit", self._highs.getRunTime() + seconds)
        most = 1000 + _PIVOTS * (self.num_rows + self.num_columns)
        self._highs.setOptionValue("simplex_iteration_limit", most)
        values = optimum(self._highs)
        pivots = self._highs.getInfo().simplex_iteration_count
        self.work += float(pivots) * (self.num_rows + self.num_columns)
        if values is None:
            self._highs.clearSolver()
        return values
