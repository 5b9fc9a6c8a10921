"""What a plan of RADMPC takes from the pool of risk, step by step (paper, Algorithm 2)."""

from __future__ import annotations

import numpy as np

from radmpc.arrays import Vector
from radmpc.planners.policies import Policy, Solved
from radmpc.program.program import DisjunctiveProgram

__all__ = ["charged_risks"]


def charged_risks(
    program: DisjunctiveProgram, solved: Solved, policy: Policy, first_step: int, horizon: int
) -> Vector:
    """Return what a plan was allocated at every absolute step.

    It leaves the pool as the plan is executed, also where later only its tail is kept.

    Parameters
    ----------
    program : DisjunctiveProgram
        The subproblem.
    solved : Solved
        Its solution and allocation.
    policy : Policy
        A pool may charge what is used instead of what is allocated.
    first_step : int
        Absolute step of the subproblem's start.
    horizon : int
        Number of steps T of the whole.

    Returns
    -------
    (T+1,) array
        Risk per step [-]; zero without a plan or an allocation.
    """
    charged = np.zeros(horizon + 1)
    solution = solved.solution
    if solved.allocation is None or solution.selection is None or solution.z is None:
        return charged
    steps = np.array([e.step for e in program.risk_items], dtype=np.int64)
    events = np.unique(program.rows.events[program.selected_rows(solution.selection)])
    risk_items = program.rows.risk_items[events]
    risks = solved.allocation[risk_items]
    if policy.charges_used:
        risks = np.minimum(risks, program.event_risks(solution.z, solution.selection)[events])
    np.add.at(charged, steps[risk_items], risks)
    if first_step == 0:
        charged[0] += program.initial_risk
    return charged
