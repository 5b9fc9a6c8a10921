"""The solver for short warm solves: compiled code where it was installed, else HiGHS.

``RADMPC_COMPILED=none`` in the environment leaves everything to HiGHS, to compare.
"""

from __future__ import annotations

import os

from radmpc.arrays import Vector
from radmpc.solvers.lp.bounded_lp import BoundedLp

try:
    from radmpc.solvers.lp import _simplex
except ImportError:
    _simplex = None  # type: ignore[assignment]  # installed where there was no compiler

__all__ = ["bounded_lp", "is_compiled"]


def is_compiled() -> bool:
    """Whether the compiled simplex method was installed."""
    return _simplex is not None and os.environ.get("RADMPC_COMPILED") != "none"


def bounded_lp(cost: Vector, lower: Vector, upper: Vector) -> BoundedLp:
    """Return a linear program without rows.

    Parameters
    ----------
    cost, lower, upper : (n,) array
        Of the first columns; an infinite bound leaves nothing to be proven.
    """
    if is_compiled():
        from radmpc.solvers.lp.simplex_lp import SimplexLp  # noqa: PLC0415 - only where compiled

        return SimplexLp(cost, lower, upper)
    from radmpc.solvers.lp.highs_lp import HighsLp  # noqa: PLC0415 - compiled code waits for no HiGHS

    return HighsLp(cost, lower, upper)
