"""A small search around a way: sides that are clear are held, those in doubt are searched."""

from __future__ import annotations

import numpy as np

from radmpc.arrays import Vector
from radmpc.solvers.priced.nodes import Incumbent
from radmpc.solvers.priced.rating import Rater
from radmpc.solvers.priced.tree import RiskTree
from radmpc.solvers.solution import Limits

__all__ = ["search_around"]

_OPEN = 0.8
"""Two sides whose room differs by less, in longest moves, are both left to the search."""

_FAR = 1.0
"""Room, in longest moves, beyond which a side need not be held."""

_GAP = 1e-3


def search_around(
    rater: Rater,
    slacks: Vector,
    best: Incumbent | None,
    *,
    move: float,
    unit: float,
    price: float,
    scale: float,
    limits: Limits,
    max_nodes: int,
    is_rigid: bool = False,
) -> Incumbent | None:
    """Return the best plan near a way; a heuristic.

    Parameters
    ----------
    rater : Rater
        The program, laid out for rating.
    slacks : (r,) array
        Room that the way leaves on each row [m].
    best : Incumbent or None
        A plan to beat.
    move : float
        The longest move from step to step [m], the measure of what is near.
    unit, price : float
        The budget of risk, and what it costs.
    scale : float
        Value below which a gap is taken of this.
    limits : Limits
        When to stop early.
    max_nodes : int
        Nodes to spend.
    is_rigid : bool
        Whether all sides are held, also those in doubt.

    Returns
    -------
    Incumbent or None
        No worse than the plan given.
    """
    if rater.is_infeasible:
        return best
    held = _held(rater, slacks, move, is_rigid=is_rigid)
    tree = RiskTree(rater.program, unit, price, gap=_GAP, scale=scale, limits=limits, rater=rater)
    tree.resume(((-np.inf, held),), price, best)
    tree.run(max_nodes)
    return tree.best


def _held(rater: Rater, slacks: Vector, move: float, *, is_rigid: bool) -> tuple[int, ...]:
    """Return the sides with the most room, unless in doubt those only where others have less."""
    program = rater.program
    if program.num_avoidances == 0:
        return ()
    rooms = np.minimum.reduceat(slacks[program.alternative_rows], program.alternative_starts[:-1])
    rooms = np.where(rater.table < 0, -np.inf, rooms[rater.table])
    places = rooms.argmax(axis=1)
    every = np.arange(len(rooms))
    first = rooms[every, places]
    rooms[every, places] = -np.inf
    second = rooms.max(axis=1)
    is_held = (first < _FAR * move) & (second <= first - _OPEN * move)
    if is_rigid:
        is_held = first < _FAR * move
    sides = rater.table[every, places]
    return tuple(int(side) for side in sides[is_held])
