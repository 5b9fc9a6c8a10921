"""Gurobi as a mixed-integer backend; the extra ``gurobi``.

Without a license it solves models of at most 2,000 columns and rows.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from radmpc.errors import SolverError
from radmpc.records import dataclass
from radmpc.solvers.milp.model import MilpAnswer, MilpModel
from radmpc.solvers.solution import Limits, Outcome

__all__ = ["GurobiBackend"]


@dataclass(frozen=True, slots=True)
class GurobiBackend:
    """Gurobi through gurobipy.

    Attributes
    ----------
    name : str
        What users call it.
    """

    name: str = "gurobi"

    def minimize(self, model: MilpModel, gap: float, limits: Limits) -> MilpAnswer:
        """Solve a model; see `radmpc.solvers.milp.model.Backend`.

        Parameters
        ----------
        model, gap, limits
            As there.

        Raises
        ------
        SolverError
            If gurobipy is not installed, refuses the model's size, or ends in no answer.
        """
        try:
            import gurobipy  # noqa: PLC0415 - optional
        except ImportError as error:
            raise SolverError("backend 'gurobi' needs: pip install 'radmpc[gurobi]'") from error
        try:
            with gurobipy.Env(params={"OutputFlag": 0}) as env, gurobipy.Model(env=env) as gurobi:
                return _minimize(gurobipy, gurobi, model, gap, limits)
        except gurobipy.GurobiError as error:
            raise SolverError(f"Gurobi refused: {error}") from error


def _minimize(
    gurobipy: Any, gurobi: Any, model: MilpModel, gap: float, limits: Limits
) -> MilpAnswer:
    """Declare and solve on an open model."""
    gurobi.Params.MIPGap = gap
    gurobi.Params.Threads = 1
    if np.isfinite(limits.seconds_left):
        gurobi.Params.TimeLimit = limits.seconds_left
    kinds = ["C" if i < model.num_continuous else "B" for i in range(model.cost.size)]
    x = gurobi.addMVar(model.cost.size, lb=model.lower, ub=model.upper, obj=model.cost, vtype=kinds)
    for sense, sides, sign in (("upper", model.row_upper, 1.0), ("lower", model.row_lower, -1.0)):
        rows = np.flatnonzero(np.isfinite(sides))
        if rows.size:
            gurobi.addConstr(sign * model.matrix[rows] @ x <= sign * sides[rows], name=sense)

    def stop_if_asked(running: Any, where: int) -> None:
        del where
        if limits.is_stopped():
            running.terminate()

    gurobi.optimize(stop_if_asked)
    codes, nodes = gurobipy.GRB, int(gurobi.NodeCount)
    if gurobi.Status in {codes.INFEASIBLE, codes.INF_OR_UNBD}:
        return MilpAnswer(Outcome.INFEASIBLE, None, float("inf"), nodes)
    if gurobi.Status not in {codes.OPTIMAL, codes.TIME_LIMIT, codes.INTERRUPTED}:
        raise SolverError(f"Gurobi stopped with status {gurobi.Status}")
    has_point = gurobi.SolCount > 0
    done = gurobi.Status == codes.OPTIMAL
    outcome = Outcome.OPTIMAL if done else Outcome.FEASIBLE if has_point else Outcome.LIMIT
    return MilpAnswer(outcome, np.array(x.X) if has_point else None, float(gurobi.ObjBound), nodes)
