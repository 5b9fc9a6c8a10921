"""Joint routes made shorter: one vehicle after the other, around where all others are.

A depth-first search over configurations ends with the first solution, in which vehicles wander.
With all others fixed tick by tick, the route of one is a shortest path over (node, tick).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from radmpc.arrays import Indices, Matrix
from radmpc.planners.certified.turned.narrow.joint_search import Configuration, Neighbors

__all__ = ["shortened"]

_MOVE = 1e-3
"""Cost of a move, as a share of a tick away from the goal [-]: between routes as quick."""


def shortened(
    neighbors: Neighbors, configurations: Sequence[Configuration], passes: int
) -> list[Configuration]:
    """Return joint routes in which nobody comes later to its goal, to stay there.

    Parameters
    ----------
    neighbors : sequence of sequence of int
        Nodes next to each node.
    configurations : sequence of tuple of int
        One per tick: no two vehicles at a node, or across an edge; the goals last.
    passes : int
        Times that every vehicle is routed anew, at most [-].

    Returns
    -------
    list of tuple of int
        The same way, of as many ticks or fewer.
    """
    at = np.array(configurations)
    choices = _choices(neighbors)
    for _ in range(passes):
        before = at.copy()
        # Who arrives last sets the number of ticks.
        for i in np.argsort(-_arrivals(at)).tolist():
            at[:, i] = _route(choices, at, i)
        if np.array_equal(at, before):
            break
    last = int(_arrivals(at).max(initial=0))
    return [tuple(each) for each in at[: last + 1].tolist()]


def _choices(neighbors: Neighbors) -> Indices:
    """Return where one may be a tick later, (n, m): the node itself first, and as padding."""
    most = 1 + max((len(each) for each in neighbors), default=0)
    return np.array(
        [[k, *each, *([k] * (most - 1 - len(each)))] for k, each in enumerate(neighbors)]
    )


def _arrivals(at: Indices) -> Indices:
    """Return the tick from which on each vehicle stays at its goal, (N,)."""
    away = at != at[-1]
    return np.where(away.any(axis=0), len(at) - away[::-1].argmax(axis=0), 0)


def _route(choices: Indices, at: Indices, i: int) -> Indices:
    """Return the shortest route of a vehicle around all others, (K,)."""
    num_ticks, goal = len(at), at[-1, i]
    others = np.delete(at, i, axis=1)
    moves = (choices != np.arange(len(choices))[:, None]) * _MOVE
    values: Matrix = np.full((num_ticks, len(choices)), np.inf)
    values[-1, goal] = 0.0
    taken = np.empty((num_ticks - 1, len(choices)), dtype=np.int64)
    rows = np.arange(len(choices))
    away = np.ones(len(choices))
    away[goal] = 0.0
    for k in range(num_ticks - 2, -1, -1):
        costs = values[k + 1][choices] + moves
        # Nobody goes where another comes from while that one goes where it was.
        begin, end = others[k], others[k + 1]
        vehicle, place = np.nonzero((choices[end] == begin[:, None]) & (begin != end)[:, None])
        costs[end[vehicle], place] = np.inf
        best = costs.argmin(axis=1)
        taken[k] = choices[rows, best]
        values[k] = costs[rows, best] + away
        values[k, begin] = np.inf
    route = [int(at[0, i])]
    for k in range(num_ticks - 1):
        route.append(int(taken[k, route[-1]]))
    return np.array(route)
