"""Paths of a few vehicles on a lattice, one after the other: later ones wait or make way."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from radmpc.arrays import Matrix, Tensor
from radmpc.planners.certified.lattice.motion import Motion
from radmpc.planners.certified.lattice.others import around_others
from radmpc.planners.certified.lattice.search import PathSearch, SlacksByKey
from radmpc.planners.certified.state.task import Task

__all__ = ["paths_in_turn"]

_MOST_RISK = 12.0
"""What one window may risk at most [Δ]: half-spaces that are turned risk less there."""


def paths_in_turn(task: Task, means: Tensor, price: float) -> Iterator[dict[int, Matrix]]:
    """Plan vehicles in turn, each among those before it, once for every vehicle that is first.

    Half-spaces push two that meet apart wherever they happen to meet. A lattice in space and time
    knows where one may wait for the other at less effort.

    Parameters
    ----------
    task : Task
        What is asked.
    means : (N, T+1, d) array
        Where everyone would be alone [m].
    price : float
        Cost of risk, per unit of probability.

    Yields
    ------
    dict of int to (T+1, 2) array
        Positions of all vehicles at the steps [m]; nothing in space, and for orders in which one
        finds no path.
    """
    models = task.hazards.models
    if task.program_alone is None or not all(Motion.of(model).is_planar for model in models):
        return
    count, most_risk = len(models), _MOST_RISK * task.risk_bound
    searches = [PathSearch(task.program_alone(i), models[i], most_risk) for i in range(count)]
    known: list[SlacksByKey] = [{} for _ in models]
    if not all(search.is_possible for search in searches):
        return
    for first in range(count):
        placed = {first: means[first]}
        for i in (*range(first + 1, count), *range(first)):
            at = np.array([placed.get(j, means[j]) for j in range(count)])
            others = around_others(task.hazards, i, np.array(list(placed)), at)
            path = searches[i].path_among(others, price, most_risk, task.limits, known[i])
            if path is None:
                break
            placed[i] = path
        if len(placed) == count:
            yield placed
