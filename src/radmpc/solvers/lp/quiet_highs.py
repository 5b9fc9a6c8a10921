"""HiGHS, silent and repeatable."""

from __future__ import annotations

import highspy
import numpy as np

from radmpc.arrays import Vector
from radmpc.errors import SolverError

__all__ = ["FEASIBILITY_TOL", "array_of", "checked", "optimum", "quiet_highs"]

FEASIBILITY_TOL = 1e-9
"""Primal and dual feasibility tolerance of linear programs [m, m/s, cost]: the least that HiGHS
takes is 1e-10; larger ones let points violate rows by more than plans may."""


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
    return np.array(highs.getSolution().col_value)


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
