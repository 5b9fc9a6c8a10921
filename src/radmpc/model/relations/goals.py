"""Goals that vehicles share: any berth will do, but each for one."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from radmpc.errors import ScenarioError
from radmpc.model.goal import Goal

__all__ = ["check_goals", "places_of", "same_goal"]


def same_goal(one: Goal, other: Goal) -> bool:
    """Return whether two goals are equal, bit for bit.

    Parameters
    ----------
    one, other : Goal
        The goals.
    """
    speeds = [goal.speed for goal in (one, other) if goal.speed is not None]
    return (
        np.array_equal(one.lower, other.lower)
        and np.array_equal(one.upper, other.upper)
        and one.within == other.within
        and len(speeds) != 1
        and (not speeds or np.array_equal(speeds[0], speeds[1]))
    )


def places_of(goals: Sequence[Goal], taken: Sequence[Goal]) -> tuple[int | None, ...]:
    """Return which of some goals vehicles have, each at most once; None where it is none of them.

    Parameters
    ----------
    goals : sequence of Goal
        To choose from.
    taken : sequence of Goal
        One per vehicle.
    """
    left = list(range(len(goals)))
    places: list[int | None] = []
    for goal in taken:
        found = next((k for k in left if same_goal(goals[k], goal)), None)
        if found is not None:
            left.remove(found)
        places.append(found)
    return tuple(places)


def check_goals(goals: Sequence[Goal], taken: Sequence[Goal], horizon: int) -> None:
    """Check that every vehicle has one of the goals that are shared, whose windows fit.

    Parameters
    ----------
    goals : sequence of Goal
        To choose from.
    taken : sequence of Goal
        One per vehicle.
    horizon : int
        Number of steps T.

    Raises
    ------
    ScenarioError
        With the first that has none.
    """
    if len(goals) < len(taken):
        raise ScenarioError(
            f"must be as many as vehicles at least, {len(taken)}, got {len(goals)}", ("goals",)
        )
    for k, goal in enumerate(goals):
        if goal.lower.size != taken[0].lower.size:
            raise ScenarioError(
                f"must have {taken[0].lower.size} coordinates like the others, "
                f"got {goal.lower.size}",
                ("goals", k),
            )
        if goal.within is not None and goal.within[1] > horizon:
            raise ScenarioError(
                f"must end at the horizon of {horizon} steps at the latest, got {goal.within[1]}",
                ("goals", k, "within"),
            )
    places = places_of(goals, taken)
    if None in places:
        raise ScenarioError(
            "must be one of the goals that are shared, and of no other vehicle",
            ("vehicles", places.index(None), "goal"),
        )
