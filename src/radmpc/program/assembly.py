"""Stacking what each vehicle and each avoidance contributes into the arrays of one program."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from scipy.sparse import block_diag, csr_array

from radmpc.arrays import Indices, Vector
from radmpc.program.avoidance import RowBlock
from radmpc.program.condensed import CondensedModel
from radmpc.program.layout import RiskItems
from radmpc.program.limits.hard import split_hard_rows
from radmpc.program.program import ChanceRows
from radmpc.records import dataclass
from radmpc.sparse_rows import SparseBlock, diagonal_rows, rows_of_entries, sparse_block

if TYPE_CHECKING:
    from radmpc.program.visits.columns import TimeColumns

__all__ = [
    "DecisionColumns",
    "all_outputs",
    "decision_columns",
    "joined_parents",
    "run_starts",
    "stacked_chance_rows",
]


@dataclass(frozen=True, slots=True, eq=False)
class DecisionColumns:
    """The decision variables of a program, and the rows that hold in any case.

    Attributes
    ----------
    cost, lower, upper : (n,) array
        As in `DisjunctiveProgram`: the controls of all vehicles, then the times of visits.
    blocks : (n,) int array
        The vehicle of each.
    hard : (h, n) sparse array
        Coefficients of the rows.
    hard_lower, hard_upper : (h,) array
        Their bounds.
    times : TimeColumns or None
        The times of visits; None where nothing is visited.
    """

    cost: Vector
    lower: Vector
    upper: Vector
    blocks: Indices
    hard: csr_array
    hard_lower: Vector
    hard_upper: Vector
    times: TimeColumns | None


def decision_columns(models: Sequence[CondensedModel]) -> DecisionColumns:
    """Return the columns of a program of some vehicles.

    Parameters
    ----------
    models : sequence of CondensedModel
        The vehicles.
    """
    if len(models) == 1:
        return models[0].kept.once(_columns_of_one, models[0])
    return _columns(models)


def _columns_of_one(model: CondensedModel) -> DecisionColumns:
    """Return those of a vehicle alone."""
    return _columns((model,))


def _columns(models: Sequence[CondensedModel]) -> DecisionColumns:
    """Return those of some vehicles."""
    cost, upper = _cost_and_upper_bounds(models)
    hard, hard_lower, hard_upper = _stacked_hard_rows(models)
    lower = np.zeros(cost.size)
    blocks = np.repeat(np.arange(len(models)), [2 * s.control_bounds.size for s in models])
    if not any(model.vehicle.via or model.time_cost for model in models):
        return DecisionColumns(cost, lower, upper, blocks, hard, hard_lower, hard_upper, None)
    from radmpc.program.visits.columns import time_columns  # noqa: PLC0415 - few visit anything

    times = time_columns(models)
    num_orders = times.order.shape[0]
    return DecisionColumns(
        np.concatenate([cost, times.cost]),
        np.concatenate([lower, times.lower]),
        np.concatenate([upper, times.upper]),
        np.concatenate([blocks, times.blocks]),
        csr_array(block_diag([hard, times.order])),
        np.concatenate([hard_lower, np.full(num_orders, 1.0 / models[0].horizon)]),
        np.concatenate([hard_upper, np.full(num_orders, np.inf)]),
        times,
    )


def _cost_and_upper_bounds(models: Sequence[CondensedModel]) -> tuple[Vector, Vector]:
    """Return cost and upper bounds of the columns, (n,) each.

    A negative upper bound, from feedback that needs more than the control limit, leaves no
    solution.
    """
    bounds = [np.tile(s.control_bounds.ravel(), 2) for s in models]
    weights = [s.vehicle.cost_weight for s in models]
    cost = np.concatenate([np.full(b.size, w) for b, w in zip(bounds, weights, strict=True)])
    return cost, np.concatenate(bounds)


def all_outputs(models: Sequence[CondensedModel], num_columns: int) -> tuple[csr_array, Vector]:
    """Return what rows may ask for, over the columns: all mean positions, then the columns.

    Parameters
    ----------
    models : sequence of CondensedModel
        The vehicles.
    num_columns : int
        Columns of the program.

    Returns
    -------
    rows : (p + n, n) sparse array
        Coefficients.
    constant : (p + n,) array
        What is added: the drift of positions [m].
    """
    blocks = [model.kept.once(_position_rows, model) for model in models]
    drift = [model.drift_position.ravel() for model in models]
    rows = diagonal_rows(blocks, num_columns, num_units=num_columns)
    return rows, np.concatenate([*drift, np.zeros(num_columns)])


def _position_rows(model: CondensedModel) -> SparseBlock:
    """Return a vehicle's mean positions over its columns, but for its drift."""
    prediction = model.position.reshape(-1, model.position.shape[2])
    return sparse_block(np.hstack([prediction, -prediction]))


def _stacked_hard_rows(models: Sequence[CondensedModel]) -> tuple[csr_array, Vector, Vector]:
    """Return the hard rows of all vehicles over the columns, with lower and upper bounds."""
    every = [split_hard_rows(model) for model in models]
    lower, upper = [one.lower for one in every], [one.upper for one in every]
    return diagonal_rows([one.rows for one in every]), np.concatenate(lower), np.concatenate(upper)


def stacked_chance_rows(
    blocks: Sequence[RowBlock], items: Sequence[RiskItems], num_outputs: int
) -> ChanceRows:
    """Return the rows of all blocks, numbers of rows, events and risk items counted through.

    Parameters
    ----------
    blocks : sequence of RowBlock
        The rows of each avoidance; numbers count from 0 within a block.
    items : sequence of RiskItems
        Those of each block, alike.
    num_outputs : int
        Outputs of the program p.
    """
    row_base = event_base = item_base = 0
    entry_rows, events, risk_items = [], [], []
    for block, one in zip(blocks, items, strict=True):
        entry_rows.append(block.entry_rows + row_base)
        events.append(block.events + event_base)
        risk_items.append(one.numbers + item_base)
        row_base += block.offsets.size
        event_base += block.event_steps.size
        item_base += len(one.risk_items)
    values = _join([b.entry_values for b in blocks], np.float64)
    where = _join(entry_rows, np.int64), _join([b.entry_outputs for b in blocks], np.int64)
    return ChanceRows(
        normals=rows_of_entries(*where, values, (row_base, num_outputs)),
        offsets=_join([b.offsets for b in blocks], np.float64),
        deviations=_join([b.deviations for b in blocks], np.float64),
        events=_join(events, np.int32),
        risk_items=_join(risk_items, np.int32),
    )


def joined_parents(blocks: Sequence[RowBlock]) -> Indices | None:
    """Return which alternative each refines, counted through; None where none does."""
    if all(block.alternative_parents is None for block in blocks):
        return None
    base, joined = 0, []
    for block in blocks:
        count = block.alternative_sizes.size
        parents = np.full(count, -1)
        if block.alternative_parents is not None:
            parents = np.where(block.alternative_parents >= 0, block.alternative_parents + base, -1)
        joined.append(parents)
        base += count
    return _join(joined, np.int64)


def run_starts(sizes: Sequence[Indices]) -> Indices:
    """Return where each run starts, and the end, from the lengths of runs in several lists."""
    return np.concatenate([[0], np.cumsum(_join(sizes, np.int64))]).astype(np.int64)


def _join(parts: Sequence[np.ndarray], kind: type) -> np.ndarray:
    """Concatenate arrays; without any, an empty one of a kind."""
    if not parts:
        return np.zeros(0, dtype=kind)
    return np.concatenate(parts, dtype=kind, casting="same_kind")
