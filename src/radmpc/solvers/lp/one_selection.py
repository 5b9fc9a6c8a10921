"""The linear program of one selection."""

from __future__ import annotations

import time

from radmpc.arrays import Indices, Vector
from radmpc.program.program import DisjunctiveProgram
from radmpc.solvers.lp.outcome import LpOutcome
from radmpc.solvers.lp.warm_lp import WarmLp
from radmpc.solvers.solution import Outcome, Solution

__all__ = ["solve_selection"]


def solve_selection(program: DisjunctiveProgram, margins: Vector, selection: Indices) -> Solution:
    """Minimize the cost with every avoidance's alternative given.

    Parameters
    ----------
    program : DisjunctiveProgram
        The program.
    margins : (r,) array
        Back-off of each row [m].
    selection : (v,) int array
        One alternative per avoidance.

    Returns
    -------
    Solution
        Its bound holds for this selection only.
    """
    begun = time.perf_counter()
    lp = WarmLp(program, margins)
    lp.activate(program.selected_rows(selection))
    outcome, bound = lp.solve()
    seconds = time.perf_counter() - begun
    if outcome is not LpOutcome.OPTIMAL:
        ended = Outcome.INFEASIBLE if outcome is LpOutcome.INFEASIBLE else Outcome.LIMIT
        return Solution(ended, None, None, float("inf"), bound, 1, lp.solves, seconds)
    z = lp.point()
    cost = float(program.cost @ z)
    return Solution(Outcome.OPTIMAL, z, selection, cost, min(bound, cost), 1, lp.solves, seconds)
