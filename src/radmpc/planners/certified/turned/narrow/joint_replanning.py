"""Joint replanning of the few that miss room, with those in their way, at a high price of risk."""

from __future__ import annotations

import numpy as np

from radmpc.planners.certified.merging import Members
from radmpc.planners.certified.turned.half_spaces import half_spaces
from radmpc.planners.certified.turned.narrow.at_pace import who_misses
from radmpc.planners.certified.turned.narrow.tuning import TUNING as NARROW
from radmpc.planners.certified.turned.near import Near
from radmpc.planners.certified.turned.successive import SuccessiveLp
from radmpc.planners.certified.turned.tuning import TUNING
from radmpc.solvers.solution import Limits

__all__ = ["replan_jointly"]


def replan_jointly(
    successive: SuccessiveLp, clearance: float, price: float, hopeful: float, limits: Limits
) -> bool:
    """Plan those that miss any room again, each together with those in its way.

    What one vehicle misses alone, two or three often have room for. Half-spaces turned to the paths
    of so few tell in a second whether their risk falls or stays, as where a path leads through an
    obstacle; turned to the paths of all fifty it takes fifteen.

    Parameters
    ----------
    successive : SuccessiveLp
        The latest paths.
    clearance : float
        Standard deviations that everyone was to keep from everything [-].
    price : float
        Cost of a unit of probability.
    hopeful : float
        Risk up to which turning the paths of all may succeed [-].
    limits : Limits
        When to stop.

    Returns
    -------
    bool
        Whether nobody planned again runs more than that, each with those in its way.
    """
    done: set[int] = set()
    for i in sorted(who_misses(successive), key=lambda i: -successive.missed[i]):
        if i in done:
            continue
        group = _with_those_in_its_way(successive, i, clearance)
        if _least_risk(successive, group, price, hopeful, limits) > hopeful:
            return False
        done.update(group)
    return True


def _least_risk(
    successive: SuccessiveLp, group: Members, price: float, hopeful: float, limits: Limits
) -> float:
    """Plan a group until its risk is small or stays; return it [-]."""
    enough, before = NARROW.joint_enough * hopeful, np.inf
    for number in range(NARROW.joint_rounds):
        spacing = max(TUNING.least_spacing, TUNING.spacing * TUNING.finer**number)
        risk = successive.share_risk(group, price, spacing)
        if limits.reached or risk <= enough or risk > NARROW.joint_stays * before:
            return risk
        before = risk
    return risk


def _with_those_in_its_way(successive: SuccessiveLp, i: int, clearance: float) -> Members:
    """Return a vehicle and others of which it does not keep clear, the nearest if many."""
    spaces = half_spaces(
        successive.hazards, successive.paths, (i,), Near(clearance, 0.0, is_refined=False)
    )
    least = spaces.clearances.min(axis=1)
    is_close = (least < clearance - NARROW.negligible) & (spaces.second >= 0)
    found = {i}
    for row in np.flatnonzero(is_close)[np.argsort(least[is_close], kind="stable")].tolist():
        if len(found) == NARROW.joint_count:
            break
        found |= {int(spaces.first[row]), int(spaces.second[row])}
    return tuple(sorted(found))
