"""The columns of visits' times, where their order needs them."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from scipy.sparse import block_diag, csr_array

from radmpc.arrays import Indices, Vector
from radmpc.model.visits import steps_of_visits
from radmpc.program.condensed import CondensedModel
from radmpc.records import dataclass

__all__ = [
    "ARRIVAL",
    "TimeColumns",
    "has_choice_of_arrival",
    "is_disjunctive",
    "time_columns",
    "timed_visits",
    "windows_of",
]

ARRIVAL = -1
"""Stands for the arrival among the numbers of visits."""


def is_disjunctive(model: CondensedModel) -> bool:
    """Whether a step has to be chosen for any visit of a vehicle, or for its arrival."""
    return has_choice_of_arrival(model) or any(first < last for first, last in windows_of(model))


def has_choice_of_arrival(model: CondensedModel) -> bool:
    """Whether arriving at another step of the window would cost less or more."""
    first, last = model.vehicle.goal.window(model.horizon)
    return model.time_cost > 0.0 and first < last


def windows_of(model: CondensedModel) -> tuple[tuple[int, int], ...]:
    """Return the steps of each visit of a vehicle."""
    return steps_of_visits(model.vehicle.via, model.horizon)


def timed_visits(model: CondensedModel) -> tuple[tuple[int, ...], tuple[bool, ...]]:
    """Return the visits that need a time, and whether each follows the one before at once."""
    windows = windows_of(model)
    overlaps = [one[1] >= two[0] for one, two in pairwise(windows)]
    befores = [False, *overlaps]
    afters = [*overlaps, False]
    timed = [j for j in range(len(windows)) if befores[j] or afters[j]]
    return tuple(timed), tuple(befores[j] for j in timed)


@dataclass(frozen=True, slots=True, eq=False)
class TimeColumns:
    """The columns of times of visits and arrivals; t of them, vehicle by vehicle.

    Attributes
    ----------
    blocks : (t,) int array
        The vehicle of each.
    visits : (t,) int array
        Which of its visits; `ARRIVAL` for its arrival.
    cost : (t,) array
        Of the time of the whole horizon.
    lower, upper : (t,) array
        Bounds [shares of the horizon].
    order : (o, t) sparse array
        Rows that keep times in order, ``order @ times >= 1 / T``.
    """

    blocks: Indices
    visits: Indices
    cost: Vector
    lower: Vector
    upper: Vector
    order: csr_array

    @property
    def count(self) -> int:
        """Number of columns."""
        return int(self.blocks.size)


def time_columns(models: Sequence[CondensedModel]) -> TimeColumns:
    """Return the columns of the times of vehicles' visits and arrivals.

    An arrival has one where time costs anything; its alternatives raise it, its cost lowers it.

    Parameters
    ----------
    models : sequence of CondensedModel
        The vehicles of a program.
    """
    blocks: list[int] = []
    visits: list[int] = []
    costs: list[float] = []
    bounds, orders = [], []
    for i, model in enumerate(models):
        timed, follows = timed_visits(model)
        blocks += [i] * len(timed)
        visits += timed
        bounds += [windows_of(model)[j] for j in timed]
        later = np.flatnonzero(follows)
        rows = np.zeros((later.size, len(timed) + (model.time_cost > 0.0)))
        rows[np.arange(later.size), later] = 1.0
        rows[np.arange(later.size), later - 1] = -1.0
        orders.append(rows)
        costs += [0.0] * len(timed)
        if model.time_cost > 0.0:
            blocks.append(i)
            visits.append(ARRIVAL)
            costs.append(model.time_cost)
            bounds.append(model.vehicle.goal.window(model.horizon))
    shares = np.array(bounds, dtype=np.float64).reshape(-1, 2) / models[0].horizon
    return TimeColumns(
        np.array(blocks, dtype=np.int64),
        np.array(visits, dtype=np.int64),
        np.array(costs),
        shares[:, 0],
        shares[:, 1],
        csr_array(block_diag([csr_array(order) for order in orders])),
    )
