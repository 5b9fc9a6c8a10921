"""A first plan of a fleet by successive linear programs, before anything is searched."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from radmpc.gaussian import CONVEX_RISK, clearance_for
from radmpc.planners.certified.hazards import Hazards
from radmpc.planners.certified.state.incumbent import FleetIncumbent
from radmpc.planners.certified.turned.detours import detours
from radmpc.planners.certified.turned.half_spaces import Near, half_spaces
from radmpc.planners.certified.turned.tuning import TUNING
from radmpc.planners.certified.turned.turning import Task, Turning
from radmpc.planners.components import components

__all__ = ["first_plan"]


def first_plan(task: Task, price: float) -> FleetIncumbent:
    """Plan a fleet one vehicle after the other, then all at a price of risk.

    Vehicles begin with what they do alone; those that an obstacle stops begin with the shortest way
    around. Where few get in each other's way, searching their sets is as quick, and nothing is
    done.

    Parameters
    ----------
    task : Task
        What is asked.
    price : float
        First guess of the shadow price of the risk, as a share of what plans cost without hazards.

    Returns
    -------
    FleetIncumbent
        A certified plan; none where none was found.
    """
    hazards, nothing = task.hazards, FleetIncumbent()
    sets = tuple((i,) for i in range(hazards.count))
    turning = Turning(task, nothing, sets, 0.0)
    successive = turning.successive
    share = TUNING.first_share * task.risk_bound / hazards.count
    clearance = float(clearance_for(min(share, CONVEX_RISK)))
    if not successive.begin_alone():
        return nothing
    stopped = _stopped(hazards, turning)
    if stopped.size:
        for i, path in detours(hazards, stopped).items():
            successive.refer(i, path)
    elif not _is_crowded(hazards, turning, clearance):
        return nothing
    turning.price = price * successive.paths.cost() / task.risk_bound
    if not successive.keep_apart(clearance, TUNING.max_sweeps):
        return nothing
    return turning.run(TUNING.rounds)


def _stopped(hazards: Hazards, turning: Turning) -> np.ndarray:
    """Return the vehicles whose paths alone run into an obstacle, noise aside."""
    near = Near(0.0, 0.0, is_refined=False)
    everyone = tuple(range(hazards.count))
    spaces = half_spaces(hazards, turning.successive.paths, everyone, near)
    is_hit = (spaces.heights < spaces.offsets).any(axis=1) & (spaces.second < 0)
    return np.unique(spaces.first[is_hit])


def _is_crowded(hazards: Hazards, turning: Turning, clearance: float) -> bool:
    """Whether many vehicles get in each other's way, directly or through others, if alone."""
    near = Near(clearance, 0.0, is_refined=False)
    everyone = tuple(range(hazards.count))
    spaces = half_spaces(hazards, turning.successive.paths, everyone, near)
    meets = (spaces.clearances < clearance).any(axis=1) & (spaces.second >= 0)
    pairs: Sequence[tuple[int, int]] = list(
        zip(spaces.first[meets].tolist(), spaces.second[meets].tolist(), strict=True)
    )
    return max(len(group) for group in components(hazards.count, pairs)) >= TUNING.many
