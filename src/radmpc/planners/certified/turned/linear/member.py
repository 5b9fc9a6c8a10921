"""What one vehicle contributes to every linear program of turning: its columns and hard rows."""

from __future__ import annotations

import numpy as np

from radmpc.arrays import Vector
from radmpc.program.condensed import CondensedModel
from radmpc.program.limits.hard import split_hard_rows
from radmpc.records import dataclass
from radmpc.sparse_rows import SparseBlock, negated, side_by_side, sparse_block

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
    hard, drift = split_hard_rows(model), model.drift_position[1:].ravel()
    moved, each = sparse_block(positions.reshape(count, span)), np.arange(count)
    held = SparseBlock(np.ones(count), each, each + 1, count)
    motion = side_by_side([negated(moved), moved, held])
    begun = hard.rows.ends[-1] if hard.rows.ends.size else 0
    rows = SparseBlock(
        np.concatenate([hard.rows.values, motion.values]),
        np.concatenate([hard.rows.columns, motion.columns]),
        np.concatenate([hard.rows.ends, motion.ends + begun]),
        motion.width,
    )
    return Member(
        cost=np.concatenate([effort, np.zeros(count)]),
        lower=np.concatenate([np.zeros(2 * span), -free]),
        upper=np.concatenate([most, free]),
        rows=rows,
        row_lower=np.concatenate([hard.lower, drift]),
        row_upper=np.concatenate([hard.upper, drift]),
    )
