"""SCIP as a mixed-integer backend; the extra ``scip``."""

from __future__ import annotations

import threading
from types import ModuleType
from typing import Any

import numpy as np

from radmpc.errors import SolverError
from radmpc.records import dataclass
from radmpc.solvers.milp.model import MilpAnswer, MilpModel
from radmpc.solvers.solution import Limits, Outcome

__all__ = ["ScipBackend"]


@dataclass(frozen=True, slots=True)
class ScipBackend:
    """SCIP through PySCIPOpt.

    Attributes
    ----------
    name : str
        What users call it.
    """

    name: str = "scip"

    def minimize(self, model: MilpModel, gap: float, limits: Limits) -> MilpAnswer:
        """Solve a model; see `radmpc.solvers.milp.model.Backend`.

        Parameters
        ----------
        model, gap, limits
            As there.

        Raises
        ------
        SolverError
            If PySCIPOpt is not installed or SCIP ends in a state that is no answer.
        """
        try:
            import pyscipopt  # noqa: PLC0415 - optional
        except ImportError as error:
            raise SolverError("backend 'scip' needs: pip install 'radmpc[scip]'") from error
        scip = pyscipopt.Model()
        scip.hideOutput()
        scip.setParam("limits/gap", gap)
        columns = _declare(pyscipopt, scip, model, limits)
        if limits.reached:
            return MilpAnswer(Outcome.LIMIT, None, -float("inf"), 0)
        # What is left now: declaring a large model takes seconds.
        if np.isfinite(limits.seconds_left):
            scip.setParam("limits/time", limits.seconds_left)
        _run(scip, limits)
        status = scip.getStatus()
        nodes = int(scip.getNNodes())
        if status == "infeasible":
            return MilpAnswer(Outcome.INFEASIBLE, None, float("inf"), nodes)
        if status not in {"optimal", "gaplimit", "timelimit", "userinterrupt"}:
            raise SolverError(f"SCIP stopped with {status}")
        has_point = scip.getNSols() > 0
        x = np.array([scip.getVal(column) for column in columns]) if has_point else None
        done = status in {"optimal", "gaplimit"}
        outcome = Outcome.OPTIMAL if done else Outcome.FEASIBLE if has_point else Outcome.LIMIT
        return MilpAnswer(outcome, x, float(scip.getDualbound()), nodes)


def _declare(pyscipopt: ModuleType, scip: Any, model: MilpModel, limits: Limits) -> list[Any]:
    """Declare columns and rows, as far as the limits allow; return the columns."""
    columns = [
        scip.addVar(
            lb=float(model.lower[i]),
            ub=float(model.upper[i]),
            obj=float(model.cost[i]),
            vtype="C" if i < model.num_continuous else "B",
        )
        for i in range(model.cost.size)
    ]
    matrix = model.matrix
    for r in range(model.row_lower.size):
        if limits.reached:
            break
        span = slice(matrix.indptr[r], matrix.indptr[r + 1])
        row = pyscipopt.quicksum(
            float(value) * columns[j]
            for j, value in zip(matrix.indices[span], matrix.data[span], strict=True)
        )
        if np.isfinite(model.row_lower[r]):
            scip.addCons(row >= float(model.row_lower[r]))
        if np.isfinite(model.row_upper[r]):
            scip.addCons(row <= float(model.row_upper[r]))
    return columns


def _run(scip: Any, limits: Limits) -> None:
    """Optimize in a thread, so that a stop is heard: SCIP ignores Ctrl-C otherwise."""
    worker = threading.Thread(target=scip.optimizeNogil)
    worker.start()
    while worker.is_alive():
        worker.join(0.05)
        if limits.is_stopped():
            scip.interruptSolve()
