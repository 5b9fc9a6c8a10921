"""The solver for short warm solves: compiled code where it was installed, else HiGHS."""

from __future__ import annotations

from radmpc.arrays import Vector
from radmpc.solvers.compiled_code import is_compiled
from radmpc.solvers.lp.bounded_lp import BoundedLp

__all__ = ["bounded_lp"]


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
