"""Nodes of a search at a price, solved by compiled code in one go."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from radmpc.solvers import _compiled
from radmpc.solvers.lp.simplex_lp import LEAST_PIVOTS, PIVOTS
from radmpc.solvers.priced.branching import FACTORS, BranchingChoice
from radmpc.solvers.priced.compiled_risk_rows import CompiledRiskRows
from radmpc.solvers.priced.nodes import Incumbent, NodeState
from radmpc.solvers.priced.rating import Rater
from radmpc.solvers.priced.risk_rows import RiskRows
from radmpc.solvers.priced.tuning import TUNING
from radmpc.solvers.priced.value import ROUNDING, Precision
from radmpc.solvers.solution import INSIDE

__all__ = ["CompiledNodes", "Solved", "compiled_nodes"]


class Solved(NamedTuple):
    """A node's answer.

    Attributes
    ----------
    state : NodeState
        What became of it.
    bound : float
        Its lower bound.
    avoidance : int
        What to branch on.
    solves : int
        Linear programs solved.
    attempt : int
        How often tangents were added by then.
    basis : bytes
        Where its linear program ended, if it is branched on.
    is_better : bool
        Whether a point of it is the best so far.
    cost, risk : float
        Those of that point.
    """

    state: NodeState
    bound: float
    avoidance: int
    solves: int
    attempt: int
    basis: bytes
    is_better: bool
    cost: float
    risk: float


class CompiledNodes:
    """The nodes of one search, on one loaded linear program.

    Parameters
    ----------
    rows : CompiledRiskRows
        The chance rows of its linear program.
    rater : Rater
        The program laid out for rating.
    choice : BranchingChoice
        Where to branch.
    unit : float
        Risk budget.
    precision : Precision
        Of the search.

    Attributes
    ----------
    short : (v, w) array
        By how much each alternative misses the reference clearance at the point solved last [m].
    """

    def __init__(
        self,
        rows: CompiledRiskRows,
        rater: Rater,
        choice: BranchingChoice,
        unit: float,
        precision: Precision,
    ) -> None:
        program = rater.program
        self._lp = rows.lp
        self.short = np.empty(rater.table.shape)
        self._point = np.empty(program.num_columns)
        self._selection = np.empty(program.num_avoidances, np.int64)
        most_of_row = rater.row_cap * (1.0 + ROUNDING)
        most_risk = precision.most_units * unit
        self._nodes = _compiled.Nodes(
            rows.compiled,
            rater.compiled,
            choice.owners.astype(np.int32),
            choice.is_refined,
            choice.weights,
            FACTORS,
            self._point,
            self._selection,
            self.short,
            (precision.gap, precision.scale, INSIDE, TUNING.headroom, TUNING.tie),
            (most_of_row, most_risk, precision.missing),
            (precision.rounds, LEAST_PIVOTS, PIVOTS, rows.crowd, TUNING.crowd_each),
        )

    def solve(self, chosen: tuple[int, ...], basis: bytes, bound: float, value: float) -> Solved:
        """Solve a node.

        Parameters
        ----------
        chosen : tuple of int
            Its alternatives.
        basis : bytes
            Where to begin; empty where the last solve ended.
        bound : float
            Its lower bound so far.
        value : float
            That of the incumbent; inf without one.
        """
        answer = self._nodes.solve(chosen, basis, bound, value, value < float("inf"))
        solved = Solved(NodeState(answer[0]), *answer[1:])
        self._lp.note(solved.solves)
        return solved

    def best(self, solved: Solved) -> Incumbent:
        """Return the point of a node solved just now that is the best so far."""
        return Incumbent(self._point.copy(), self._selection.copy(), solved.cost, solved.risk)


def compiled_nodes(
    rows: RiskRows, rater: Rater, choice: BranchingChoice, unit: float, precision: Precision
) -> CompiledNodes | None:
    """Return the nodes of a search, if compiled code keeps its chance rows.

    Parameters
    ----------
    rows : RiskRows
        The chance rows of its linear program.
    rater, choice, unit, precision
        As in `CompiledNodes`.
    """
    if not isinstance(rows, CompiledRiskRows):
        return None
    return CompiledNodes(rows, rater, choice, unit, precision)
