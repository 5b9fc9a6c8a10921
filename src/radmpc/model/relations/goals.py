"""Goals that vehicles share: any berth will do, but each for one."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from radmpc.errors import ScenarioError
from radmpc.model.goal import Goal

if TYPE_CHECKING:
    from radmpc.model.vehicle import Vehicle
    from radmpc.model.workspace import Workspace

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


def places_of(goals: Sequence[Goal], assigned: Sequence[Goal]) -> tuple[int | None, ...]:
    """Return which of some goals vehicles have, each at most once; None where it is none of them.

    Parameters
    ----------
    goals : sequence of Goal
        To choose from.
    assigned : sequence of Goal
        One per vehicle.
    """
    left = list(range(len(goals)))
    places: list[int | None] = []
    for goal in assigned:
        found = next((k for k in left if same_goal(goals[k], goal)), None)
        if found is not None:
            left.remove(found)
        places.append(found)
    return tuple(places)


def check_goals(
    goals: Sequence[Goal],
    vehicles: Sequence[Vehicle],
    horizon: int,
    workspace: Workspace | None = None,
) -> None:
    """Check that every vehicle has one of the goals that are shared, and might have any of them.

    Parameters
    ----------
    goals : sequence of Goal
        To choose from.
    vehicles : sequence of Vehicle
        The vehicles, with a goal each.
    horizon : int
        Number of steps T.
    workspace : Workspace or None
        None is unbounded.

    Raises
    ------
    ScenarioError
        With the first that has none, or that somebody cannot have.
    """
    if len(goals) < len(vehicles):
        raise ScenarioError(
            f"must be as many as vehicles at least, {len(vehicles)}, got {len(goals)}", ("goals",)
        )
    speedless = next((v.name for v in vehicles if v.system.velocity is None), None)
    for k, goal in enumerate(goals):
        _check_goal(goal, k, (vehicles[0].system.dimension, horizon), workspace)
        if goal.speed is not None and speedless is not None:
            raise _no_velocity(goal, speedless, ("goals", k, "speed"))
    places = places_of(goals, [vehicle.goal for vehicle in vehicles])
    if None not in places:
        return
    odd = places.index(None)
    path = ("vehicles", odd, "goal")
    goal = vehicles[odd].goal
    # Where a goal gives no speed, files read 0 for vehicles with a velocity, and none for others.
    if goal.speed is not None and speedless is not None:
        raise _no_velocity(goal, speedless, (*path, "speed"))
    raise ScenarioError("must be one of the goals that are shared, and of no other vehicle", path)


def _no_velocity(goal: Goal, speedless: str, path: tuple[str | int, ...]) -> ScenarioError:
    """Return the error of a shared goal that asks for a speed which a vehicle does not have."""
    speed = np.asarray(goal.speed).tolist()
    return ScenarioError(
        f"the dynamics of {speedless!r}, which might go there, have no velocity: goals that are "
        f"shared must all have the speed null, got {speed} (in files the default is 0)",
        path,
    )


def _check_goal(goal: Goal, k: int, sizes: tuple[int, int], workspace: Workspace | None) -> None:
    """Check one of the goals against coordinates and steps, and the workspace."""
    d, horizon = sizes
    if goal.lower.size != d:
        raise ScenarioError(
            f"must have {d} coordinates like the others, got {goal.lower.size}", ("goals", k)
        )
    if goal.within is not None and goal.within[1] > horizon:
        raise ScenarioError(
            f"must end at the horizon of {horizon} steps at the latest, got {goal.within[1]}",
            ("goals", k, "within"),
        )
    if workspace is None:
        return
    low, high = workspace.lower, workspace.upper
    if np.any(goal.lower > high) or np.any(goal.upper < low):
        raise ScenarioError(
            f"must touch the workspace {low.tolist()} to {high.tolist()}, "
            f"got {goal.lower.tolist()} to {goal.upper.tolist()}",
            ("goals", k),
        )
