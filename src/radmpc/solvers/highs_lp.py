"""One linear programme kept alive in HiGHS: grown by rows and columns, solved warm."""

from __future__ import annotations

from enum import Enum

import highspy
import numpy as np
import numpy.typing as npt
from scipy.sparse import csr_array

from radmpc.arrays import Matrix, Vector
from radmpc.errors import SolverError

__all__ = ["FEASIBILITY_TOL", "HighsLp", "LpOutcome", "Numbers", "quiet_highs"]

FEASIBILITY_TOL = 1e-9

Numbers = npt.NDArray[np.int32]
"""Row and column numbers as HiGHS takes them."""

_NONE: Numbers = np.zeros(0, dtype=np.int32)
_NO_VALUES = np.zeros(0)

_DUAL_SIMPLEX = (
    ("presolve", "off"),
    ("solver", "simplex"),
    ("simplex_strategy", 1),
    # Few pivots follow each change: exact edge weights cost more than they save.
    ("simplex_dual_edge_weight_strategy", 0),
    ("primal_feasibility_tolerance", FEASIBILITY_TOL),
    ("dual_feasibility_tolerance", FEASIBILITY_TOL),
)


class LpOutcome(Enum):
    """How a linear programme ended."""

    OPTIMAL = "optimal"
    INFEASIBLE = "infeasible"
    CUTOFF = "worse than the cutoff"


def quiet_highs() -> highspy.Highs:
    """Return a HiGHS instance that is silent, single-threaded and repeatable."""
    highs = highspy.Highs()
    for name, value in (
        ("output_flag", False),
        ("threads", 1),
        ("random_seed", 0),
    ):
        highs.setOptionValue(name, value)
    return highs


class HighsLp:
    """Columns and rows in the order they were added; minimised by dual simplex.

    Parameters
    ----------
    cost, lower, upper : (n,) array
        Of the first columns.
    """

    def __init__(self, cost: Vector, lower: Vector, upper: Vector) -> None:
        self.solves = 0
        self.num_columns = int(cost.size)
        self.num_rows = 0
        self._cutoff = float("inf")
        self._highs = quiet_highs()
        for name, value in _DUAL_SIMPLEX:
            self._highs.setOptionValue(name, value)
        _check(
            self._highs.addCols(self.num_columns, cost, lower, upper, 0, _NONE, _NONE, _NO_VALUES)
        )

    def add_rows(self, matrix: csr_array, lower: Vector, upper: Vector) -> int:
        """Append rows; return the number of the first."""
        _check(
            self._highs.addRows(
                matrix.shape[0],
                lower,
                upper,
                matrix.nnz,
                matrix.indptr[:-1].astype(np.int32),
                matrix.indices.astype(np.int32),
                matrix.data,
            )
        )
        first = self.num_rows
        self.num_rows += int(matrix.shape[0])
        return first

    def add_dense_rows(self, columns: Numbers, values: Matrix, lower: Vector | None) -> int:
        """Append rows of equal length, bounded below or (None) free; return the first's number."""
        count, width = values.shape
        infinite = np.full(count, np.inf)
        _check(
            self._highs.addRows(
                count,
                -infinite if lower is None else lower,
                infinite,
                count * width,
                np.arange(0, count * width, width, dtype=np.int32),
                columns.ravel(),
                values.ravel(),
            )
        )
        first = self.num_rows
        self.num_rows += count
        return first

    def add_row(self, columns: Numbers, values: Vector, lower: float, upper: float) -> int:
        """Append one row; return its number."""
        _check(self._highs.addRow(lower, upper, len(columns), columns, values))
        self.num_rows += 1
        return self.num_rows - 1

    def add_column(
        self, cost: float, upper: float, rows: Numbers = _NONE, values: Vector = _NO_VALUES
    ) -> int:
        """Append one column, at least 0; return its number."""
        _check(self._highs.addCol(cost, 0.0, upper, len(rows), rows, values))
        self.num_columns += 1
        return self.num_columns - 1

    def bound_rows(self, rows: list[int], lower: Vector, upper: Vector) -> None:
        """Change the bounds of some rows."""
        if rows:
            numbers = np.array(rows, dtype=np.int32)
            _check(self._highs.changeRowsBounds(len(rows), numbers, lower, upper))

    def solve(self, cutoff: float = float("inf")) -> tuple[LpOutcome, float]:
        """Minimise.

        Parameters
        ----------
        cutoff : float
            Give up as soon as the cost is known to be above this.

        Returns
        -------
        (LpOutcome, float)
            The outcome and the least cost (inf where infeasible).

        Raises
        ------
        SolverError
            If HiGHS fails twice, the second time from scratch.
        """
        if cutoff != self._cutoff:
            self._highs.setOptionValue("objective_bound", cutoff)
            self._cutoff = cutoff
        for attempt in range(2):
            self.solves += 1
            self._highs.run()
            status = self._highs.getModelStatus()
            if status == highspy.HighsModelStatus.kOptimal:
                return LpOutcome.OPTIMAL, float(self._highs.getInfo().objective_function_value)
            if status == highspy.HighsModelStatus.kInfeasible:
                return LpOutcome.INFEASIBLE, float("inf")
            if status == highspy.HighsModelStatus.kObjectiveBound:
                return LpOutcome.CUTOFF, cutoff
            if attempt == 0:
                self._highs.clearSolver()
        raise SolverError(f"HiGHS stopped with {self._highs.modelStatusToString(status)}")

    def point(self) -> Vector:
        """Return the columns of the last optimal solve."""
        return np.array(self._highs.getSolution().col_value)


def _check(status: highspy.HighsStatus) -> None:
    """Turn a failed call into an error."""
    if status == highspy.HighsStatus.kError:
        raise SolverError("HiGHS refused a row, a column or a bound")
