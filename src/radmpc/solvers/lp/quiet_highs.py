"""HiGHS, silent and repeatable."""

from __future__ import annotations

import highspy
import numpy as np
import numpy.typing as npt

from radmpc.arrays import Indices, Vector
from radmpc.errors import SolverError

__all__ = [
    "BASIC",
    "FEASIBILITY_TOL",
    "FREE",
    "LOWER",
    "UPPER",
    "Flags",
    "array_of",
    "basic_of",
    "begin_with",
    "checked",
    "optimum",
    "quiet_highs",
]

Flags = npt.NDArray[np.bool_]
"""One for each column or row."""

LOWER, BASIC, UPPER, FREE = range(4)
"""Where a column or a row is: at a bound, basic, or at 0 without any bound."""

_STATUS = np.array(
    [
        highspy.HighsBasisStatus.kLower,
        highspy.HighsBasisStatus.kBasic,
        highspy.HighsBasisStatus.kUpper,
        highspy.HighsBasisStatus.kZero,
    ],
    dtype=object,
)

FEASIBILITY_TOL = 1e-9
"""Primal and dual feasibility tolerance of linear programs [m, m/s, cost]: the least that HiGHS
takes is 1e-10; larger ones let points violate rows by more than plans may."""


class _SilentHighs(highspy.Highs):  # type: ignore[misc] # its stubs are skipped, see pyproject.toml
    """HiGHS without output from the first call on.

    From 1.16 on HiGHS prints its version at the first call that finds output switched on, and the
    constructor of highspy makes one itself: it enables callbacks.
    """

    def enableCallbacks(self) -> None:  # noqa: N802 - the name in highspy
        """Switch output off before anything is called."""
        self.setOptionValue("output_flag", False)
        super().enableCallbacks()


def quiet_highs() -> highspy.Highs:
    """Return a HiGHS instance that is silent, single-threaded and repeatable."""
    highs = _SilentHighs()
    for name, value in (("threads", 1), ("random_seed", 0)):
        highs.setOptionValue(name, value)
    return highs


def optimum(highs: highspy.Highs) -> Vector | None:
    """Solve; return all columns, None without an optimum.

    Parameters
    ----------
    highs : Highs
        Loaded.
    """
    highs.run()
    if highs.getModelStatus() != highspy.HighsModelStatus.kOptimal:
        return None
    return array_of(highs.getSolution().col_value)


def array_of(values: list[float]) -> Vector:
    """Return what HiGHS hands out as a list; `np.array` takes twice as long to see its type.

    Parameters
    ----------
    values : list of float
        From a solution.
    """
    return np.fromiter(values, np.float64, len(values))


def checked(status: highspy.HighsStatus) -> None:
    """Turn a failed call into an error.

    Parameters
    ----------
    status : HighsStatus
        What the call returned.

    Raises
    ------
    SolverError
        If it was refused.
    """
    if status == highspy.HighsStatus.kError:
        raise SolverError("HiGHS refused a row, a column or a bound")


def basic_of(highs: highspy.Highs, num_columns: int, num_rows: int) -> tuple[Flags, Flags]:
    """Return which columns and which rows are basic where the last solve ended.

    Parameters
    ----------
    highs : Highs
        Solved.
    num_columns, num_rows : int
        Of the program.
    """
    _, numbers = highs.getBasicVariables()
    columns, rows = np.zeros(num_columns, dtype=bool), np.zeros(num_rows, dtype=bool)
    columns[numbers[numbers >= 0]] = True
    # Rows are numbered downward from -1.
    rows[-1 - numbers[numbers < 0]] = True
    return columns, rows


def begin_with(highs: highspy.Highs, columns: Indices, rows: Indices) -> None:
    """Have the next solve begin with a basis, mended by HiGHS where it is none.

    Parameters
    ----------
    highs : Highs
        Loaded.
    columns, rows : int array
        Where each is: `LOWER`, `BASIC`, `UPPER` or `FREE`.
    """
    basis = highspy.HighsBasis()
    basis.col_status, basis.row_status = _STATUS[columns].tolist(), _STATUS[rows].tolist()
    basis.valid = True
    # HiGHS looks into it, and factors, where it may be none: with as many basic as there are rows
    # that is left to the solve.
    basis.alien = np.count_nonzero(columns == BASIC) + np.count_nonzero(rows == BASIC) != rows.size
    highs.setBasis(basis)
