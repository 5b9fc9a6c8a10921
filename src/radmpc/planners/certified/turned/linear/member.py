"""What one vehicle contributes to every linear program of turning: its columns and hard rows."""

from __future__ import annotations

import numpy as np

from radmpc.arrays import Vector
from radmpc.program.condensed import CondensedModel
from radmpc.program.limits.hard import hard_rows
from radmpc.records import dataclass
from radmpc.sparse_rows import SparseBlock, sparse_block

__all__ = ["Member", "member_of"]


@dataclass(frozen=True, slots=True, eq=False)
class Member:
    """One vehicle's columns ``u+``, then ``u-``, then the mean positions from step 1 on.

    Attributes
    ----------
    cost, lower, upper : (n,) array
        Of the columns.
    rows : SparseBlock
        Hard rows, and what positions are of controls.
    row_lower, row_upper : (h,) array
        Their bounds.
    """

    cost: Vector
    lower: Vector
    upper: Vector
    rows: SparseBlock
    row_lower: Vector
    row_upper: Vector


def member_of(model: CondensedModel) -> Member:
    """Return what a vehicle contributes.

    Parameters
    ----------
    model : CondensedModel
        The vehicle.
    """
    return model.kept.once(_member, model)


def _member(model: CondensedModel) -> Member:
    """Compute it."""
    span, positions = model.control_bounds.size, model.position[1:]
    count = positions.shape[0] * positions.shape[1]
    most = np.maximum(np.tile(model.control_bounds.ravel(), 2), 0.0)
    effort = np.full(2 * span, model.vehicle.cost_weight)
    free = np.full(count, np.inf)
    rows, lower, upper = hard_rows(model)
    prediction = positions.reshape(count, span)
    drift = model.drift_position[1:].ravel()
    hard = np.hstack([rows, -rows, np.zeros((len(rows), count))])
    motion = np.hstack([-prediction, prediction, np.eye(count)])
    return Member(
        cost=np.concatenate([effort, np.zeros(count)]),
        lower=np.concatenate([np.zeros(2 * span), -free]),
        upper=np.concatenate([most, free]),
        rows=sparse_block(np.vstack([hard, motion])),
        row_lower=np.concatenate([lower, drift]),
        row_upper=np.concatenate([upper, drift]),
    )
