"""HiGHS as a mixed-integer backend; built in."""

from __future__ import annotations

import highspy
import numpy as np

from radmpc.errors import SolverError
from radmpc.records import dataclass
from radmpc.solvers.lp.quiet_highs import quiet_highs
from radmpc.solvers.milp.model import MilpAnswer, MilpModel
from radmpc.solvers.solution import Limits, Outcome

__all__ = ["HighsBackend"]

_FEASIBILITY_TOL = 1e-9
"""Feasibility tolerance of mixed-integer programs [m]: slack in the rows that define outputs would
lower the bound by more than small gaps."""


@dataclass(frozen=True, slots=True)
class HighsBackend:
    """HiGHS, the solver that every installation has.

    Attributes
    ----------
    name : str
        What users call it.
    most_nodes : int or None
        Nodes of its tree at most [-]; None for any number.
    """

    name: str = "highs"
    most_nodes: int | None = None

    def minimize(self, model: MilpModel, gap: float, limits: Limits) -> MilpAnswer:
        """Solve a model; see `radmpc.solvers.milp.model.Backend`.

        Parameters
        ----------
        model, gap, limits
            As there.

        Raises
        ------
        SolverError
            If HiGHS ends in a state that is neither an answer nor a limit.
        """
        highs = quiet_highs()
        highs.setOptionValue("mip_rel_gap", gap)
        for name in ("mip_feasibility_tolerance", "primal_feasibility_tolerance"):
            highs.setOptionValue(name, _FEASIBILITY_TOL)
        if self.most_nodes is not None:
            highs.setOptionValue("mip_max_nodes", self.most_nodes)
        if np.isfinite(limits.seconds_left):
            highs.setOptionValue("time_limit", limits.seconds_left)
        highs.passModel(_translated(model))

        def stop_if_asked(event: highspy.HighsCallbackEvent) -> None:
            if limits.reached:
                event.interrupt()

        highs.cbMipInterrupt += stop_if_asked
        highs.run()
        highs.cbMipInterrupt -= stop_if_asked
        status = highs.getModelStatus()
        info = highs.getInfo()
        statuses = highspy.HighsModelStatus
        if status == statuses.kInfeasible:
            return MilpAnswer(Outcome.INFEASIBLE, None, float("inf"), int(info.mip_node_count))
        ends = {
            statuses.kOptimal,
            statuses.kTimeLimit,
            statuses.kInterrupt,
            statuses.kSolutionLimit,
        }
        if status not in ends:
            raise SolverError(f"HiGHS stopped with {highs.modelStatusToString(status)}")
        has_point = info.primal_solution_status == 2
        x = np.array(highs.getSolution().col_value) if has_point else None
        done = status == statuses.kOptimal
        outcome = Outcome.OPTIMAL if done else Outcome.FEASIBLE if has_point else Outcome.LIMIT
        return MilpAnswer(outcome, x, float(info.mip_dual_bound), int(info.mip_node_count))


def _translated(model: MilpModel) -> highspy.HighsLp:
    """Return the model in HiGHS's own form."""
    lp = highspy.HighsLp()
    lp.num_col_, lp.num_row_ = model.cost.size, model.row_lower.size
    lp.col_cost_, lp.col_lower_, lp.col_upper_ = model.cost, model.lower, model.upper
    lp.row_lower_, lp.row_upper_ = model.row_lower, model.row_upper
    lp.a_matrix_.format_ = highspy.MatrixFormat.kRowwise
    lp.a_matrix_.start_ = model.matrix.indptr.astype(np.int32)
    lp.a_matrix_.index_ = model.matrix.indices.astype(np.int32)
    lp.a_matrix_.value_ = model.matrix.data
    kinds = highspy.HighsVarType
    lp.integrality_ = [
        kinds.kContinuous if i < model.num_continuous else kinds.kInteger
        for i in range(model.cost.size)
    ]
    return lp
