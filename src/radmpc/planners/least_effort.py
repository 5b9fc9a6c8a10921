"""What one vehicle costs at least with nothing in the way, and the controls that take it there."""

from __future__ import annotations

import numpy as np

from radmpc.arrays import Matrix
from radmpc.program.assembly import decision_columns
from radmpc.program.condensed import CondensedModel
from radmpc.program.limits.hard import split_hard_rows
from radmpc.records import dataclass
from radmpc.solvers.lp.bounded_lp import BoundedLp
from radmpc.solvers.lp.choosing import bounded_lp
from radmpc.solvers.lp.outcome import LpOutcome
from radmpc.sparse_rows import diagonal_rows

__all__ = ["LeastEffort", "alone_in_space", "least_effort"]


@dataclass(frozen=True, slots=True, eq=False)
class LeastEffort:
    """The plan of one vehicle in empty space.

    Attributes
    ----------
    cost : float
        Proven least cost; 0 where it cannot reach its goal.
    controls : (T, m) array or None
        The plan; None where there is none, or where steps of visits are open.
    basis : bytes
        Where its program ended, for `alone_in_space`; empty where that is not to be had.
    is_out_of_reach : bool
        Whether its program has no solution, which proves that it cannot reach its goal.
    """

    cost: float
    controls: Matrix | None
    basis: bytes = b""
    is_out_of_reach: bool = False


def least_effort(model: CondensedModel) -> LeastEffort:
    """Return a vehicle's plan in empty space, made once.

    Parameters
    ----------
    model : CondensedModel
        The vehicle.
    """
    return model.kept.once(_least_effort, model)


def alone_in_space(model: CondensedModel) -> BoundedLp:
    """Return the linear program of a vehicle's controls with nothing in the way.

    Parameters
    ----------
    model : CondensedModel
        The vehicle; the steps of its visits are fixed.

    Returns
    -------
    BoundedLp
        Columns ``u+``, then ``u-``; begun where `least_effort` ended.
    """
    hard, upper = split_hard_rows(model), np.maximum(np.tile(model.control_bounds.ravel(), 2), 0.0)
    lp = bounded_lp(np.full(upper.size, model.vehicle.cost_weight), np.zeros(upper.size), upper)
    lp.add_rows(diagonal_rows([hard.rows]), hard.lower, hard.upper)
    lp.begin_with(least_effort(model).basis)
    return lp


def _least_effort(model: CondensedModel) -> LeastEffort:
    """Make it."""
    columns = decision_columns((model,))
    lp = bounded_lp(columns.cost, columns.lower, columns.upper)
    lp.add_rows(columns.hard, columns.hard_lower, columns.hard_upper)
    outcome, cost = lp.solve()
    if outcome is not LpOutcome.OPTIMAL:
        return LeastEffort(0.0, None, is_out_of_reach=outcome is LpOutcome.INFEASIBLE)
    if columns.times is not None:
        return LeastEffort(cost, None)
    plus, minus = np.split(lp.point(), 2)
    controls = (plus - minus).reshape(model.control_bounds.shape)
    return LeastEffort(cost, controls, lp.basis())
