"""A small search around a path: clear alternatives are held, those in doubt are searched."""

from __future__ import annotations

import numpy as np

from radmpc.arrays import Vector
from radmpc.solvers.priced.nodes import Incumbent
from radmpc.solvers.priced.rating import Rater
from radmpc.solvers.priced.tree import RiskTree
from radmpc.solvers.priced.tuning import TUNING
from radmpc.solvers.solution import Limits

__all__ = ["search_around"]


def search_around(
    rater: Rater,
    slacks: Vector,
    best: Incumbent | None,
    *,
    longest_step: float,
    unit: float,
    price: float,
    scale: float,
    limits: Limits,
    max_nodes: int,
    is_rigid: bool = False,
) -> Incumbent | None:
    """Return the best plan near a path; a heuristic.

    Parameters
    ----------
    rater : Rater
        The program, laid out for rating.
    slacks : (r,) array
        Slack of each row along the path [m].
    best : Incumbent or None
        A plan to beat.
    longest_step : float
        The longest move from step to step [m], the measure of what is near.
    unit, price : float
        Risk budget, and the cost of risking it: the Lagrange multiplier of the risk bound.
    scale : float
        Values below this count as this in relative gaps.
    limits : Limits
        When to stop early.
    max_nodes : int
        Nodes to spend.
    is_rigid : bool
        Whether alternatives in doubt are held, too.

    Returns
    -------
    Incumbent or None
        No worse than the plan given.
    """
    if rater.is_infeasible:
        return best
    held = _held(rater, slacks, longest_step, is_rigid=is_rigid)
    tree = RiskTree(
        rater.program, unit, price, gap=TUNING.around_gap, scale=scale, limits=limits, rater=rater
    )
    tree.resume(((-np.inf, held),), price, best)
    tree.run(max_nodes)
    return tree.best


def _held(rater: Rater, slacks: Vector, longest_step: float, *, is_rigid: bool) -> tuple[int, ...]:
    """Return the alternatives of most slack near the path; in doubt none, unless rigid."""
    program = rater.program
    if program.num_avoidances == 0:
        return ()
    slack = np.minimum.reduceat(slacks[program.alternative_rows], program.alternative_starts[:-1])
    slack = np.where(rater.table < 0, -np.inf, slack[rater.table])
    places = slack.argmax(axis=1)
    every = np.arange(len(slack))
    first = slack[every, places]
    slack[every, places] = -np.inf
    second = slack.max(axis=1)
    far, open_by = TUNING.far_slack * longest_step, TUNING.open_slack * longest_step
    is_held = (first < far) & (second <= first - open_by)
    if is_rigid:
        is_held = first < far
    best = rater.table[every, places]
    return tuple(int(alternative) for alternative in best[is_held])
