"""Controls for vehicles that were placed clear of each other: who has them is left alone."""

from __future__ import annotations

import numpy as np

from radmpc.planners.certified.turned.half_spaces import half_spaces
from radmpc.planners.certified.turned.narrow.tuning import TUNING as NARROW
from radmpc.planners.certified.turned.near import Near
from radmpc.planners.certified.turned.successive import SuccessiveLp
from radmpc.planners.certified.turned.tuning import TUNING
from radmpc.solvers.solution import Limits

__all__ = ["keep_places", "plan_near", "who_misses"]


def keep_places(
    successive: SuccessiveLp, clearance: float, max_sweeps: int, penalty: float, limits: Limits
) -> bool:
    """Plan every vehicle once, then those again that miss room, and those in their way.

    Who keeps clear of everything stays there until the others do: planned again for less effort,
    vehicles cut the corners that they were placed around, until half-spaces turned to such paths
    leave no way back (30 robots on 32 x 32 cells: 0.09 m missed after four sweeps of all, 0.5 m
    after sixteen; no miss after four sweeps of those that miss).

    Parameters
    ----------
    successive : SuccessiveLp
        Paths that refer to the places of all vehicles.
    clearance : float
        Standard deviations that everyone keeps from everything [-].
    max_sweeps : int
        Sweeps at most [-].
    penalty : float
        Of a meter missed in the first sweep, see `Tuning.first_penalty` [-].
    limits : Limits
        When to stop.

    Returns
    -------
    bool
        Whether nobody misses anything.
    """
    successive.missed[:] = np.inf
    least, num_stuck = np.inf, 0
    for sweep in range(max_sweeps):
        missing = who_misses(successive)
        if not missing:
            return True
        again = set(missing)
        if sweep >= NARROW.alone_sweeps:
            again |= _in_the_way(successive, missing, clearance)
        for i in sorted(again, reverse=sweep % 2 == 1):
            if limits.reached:
                return False
            plan_near(successive, i, clearance, penalty)
        missed = float(successive.missed.sum())
        num_stuck = num_stuck + 1 if missed > TUNING.stuck_at * least else 0
        least = min(least, missed)
        if num_stuck >= TUNING.stuck:
            break
        penalty = min(TUNING.penalty_growth * penalty, TUNING.last_penalty)
    return not who_misses(successive)


def who_misses(successive: SuccessiveLp) -> list[int]:
    """Return the vehicles whose latest paths miss any of their half-spaces, in order.

    Parameters
    ----------
    successive : SuccessiveLp
        The latest paths.
    """
    return np.flatnonzero(successive.missed > NARROW.negligible).tolist()


def plan_near(successive: SuccessiveLp, i: int, clearance: float, penalty: float) -> None:
    """Plan a vehicle; again, looking further around, where it strays into what was not seen.

    Who waits at its places may drift on between half-spaces turned to where it should be, through
    whatever is beyond: one of 50 robots passed through a box and missed nothing.

    Parameters
    ----------
    successive : SuccessiveLp
        The latest paths.
    i : int
        The vehicle.
    clearance, penalty
        As in `keep_places`.
    """
    places = successive.paths.means[i].copy()
    successive.plan_alone(i, clearance, penalty)
    reach = float(np.abs(successive.paths.means[i] - places).max())
    if reach <= successive.hazards.reaches[i] or not _lack(successive, i, clearance):
        return
    successive.refer(i, places)
    successive.plan_alone(i, clearance, penalty, NARROW.further * reach)
    successive.missed[i] = max(successive.missed[i], _lack(successive, i, clearance))


def _lack(successive: SuccessiveLp, i: int, clearance: float) -> float:
    """Return the most by which a vehicle's latest path comes too near anything [m]."""
    near = Near(clearance, 0.0, is_refined=False)
    spaces = half_spaces(successive.hazards, successive.paths, (i,), near)
    lacks = spaces.offsets + clearance * spaces.deviations - spaces.heights
    lacks[spaces.windows == 0, 0] = 0.0  # where it starts is given
    return float(np.where(lacks > NARROW.negligible, lacks, 0.0).max(initial=0.0))


def _in_the_way(successive: SuccessiveLp, missing: list[int], clearance: float) -> set[int]:
    """Return the vehicles of which others do not keep clear."""
    near = Near(clearance, 0.0, is_refined=False)
    spaces = half_spaces(successive.hazards, successive.paths, sorted(missing), near)
    is_close = (spaces.clearances < clearance - NARROW.negligible).any(axis=1)
    is_close &= spaces.second >= 0
    return {*spaces.first[is_close].tolist(), *spaces.second[is_close].tolist()}
