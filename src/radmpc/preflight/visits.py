"""How soon a vehicle can make its visits, one after the other, and reach its goal after them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import pairwise

import numpy as np

from radmpc.arrays import Matrix, Vector
from radmpc.model.scenario import Scenario
from radmpc.model.vehicle import Vehicle
from radmpc.model.visits import steps_of_visits
from radmpc.preflight.pace import ARRIVED, Pace
from radmpc.records import dataclass

__all__ = ["describe_visits", "earliest_visits", "is_in_time"]

_TIGHT = 0.9
"""Share of the time until the goal is due that visits may take before it is a concern [-], as that
of the horizon without visits."""


@dataclass(frozen=True, slots=True, eq=False)
class _Box:
    """A box to be in at a step of a window, at most at a speed; inf is free."""

    lower: Vector
    upper: Vector
    speed: Vector
    window: tuple[int, int]


def earliest_visits(vehicle: Vehicle, pace: Pace, bounds: Matrix) -> tuple[int | None, ...]:
    """Return the earliest step of each visit, and of the arrival, through empty space.

    No plan is earlier: every leg is as short as speed and control allow on each axis by itself,
    from wherever in a box to wherever in the next. Where a window is missed, None from there on.

    Parameters
    ----------
    vehicle : Vehicle
        With visits.
    pace : Pace
        Of the vehicle.
    bounds : (T, m) array
        Largest control at each step, >= 0.

    Returns
    -------
    tuple of (int or None)
        One per visit, and the goal.
    """
    horizon, free = len(bounds), np.full(pace.gains.size, np.inf)
    windows = steps_of_visits(vehicle.via, horizon)
    boxes = [_Box(pace.place, pace.place, free, (0, 0))]
    boxes += [
        _Box(visit.lower, visit.upper, free if visit.speed is None else visit.speed, window)
        for visit, window in zip(vehicle.via, windows, strict=True)
    ]
    goal = vehicle.goal
    boxes.append(_Box(goal.lower, goal.upper, pace.last, (1, goal.window(horizon)[1])))
    spent = np.zeros((horizon + 1, pace.gains.size))
    np.cumsum(bounds[:, pace.controls] * pace.gains, axis=0, out=spent[1:])
    found: list[int | None] = []
    step: int | None = 0
    for before, after in pairwise(boxes):
        if step is not None:
            step = _earliest(pace, spent, (before, after), step)
        found.append(step)
    return tuple(found)


def _earliest(pace: Pace, spent: Matrix, leg: tuple[_Box, _Box], earliest: int) -> int | None:
    """Return the earliest step in a box, after one from some step on in the box before."""
    before, after = leg
    first, last = after.window
    best = last + 1
    for leaves in range(earliest, before.window[1] + 1):
        arrives = max(leaves + 1, first)
        while arrives < best and not _gets_there(pace, spent, leg, (leaves, arrives)):
            arrives += 1
        best = min(best, arrives)
        if best <= leaves + 2 or best == first:
            break
    return best if best <= last else None


def _gets_there(pace: Pace, spent: Matrix, leg: tuple[_Box, _Box], steps: tuple[int, int]) -> bool:
    """Whether each axis by itself gets from box to box between two steps."""
    (before, after), (leaves, arrives) = leg, steps
    span = slice(leaves, arrives + 1)
    gained = spent[span] - spent[leaves]
    left = spent[arrives] - spent[span]
    most = np.minimum(before.speed + gained, after.speed + left)
    for sign in (1.0, -1.0):
        limit = np.minimum(sign * pace.speed + spent[span], pace.limit)
        fastest = np.minimum(most, limit)
        if leaves == 0:
            fastest[0] = sign * pace.speed
        far = 0.5 * pace.dt * (fastest[:-1] + fastest[1:]).sum(axis=0)
        gap = after.lower - before.upper if sign > 0.0 else before.lower - after.upper
        if np.any(gap > far + ARRIVED):
            return False
    return True


def describe_visits(
    vehicle: Vehicle, earliest: Sequence[int | None], horizon: int
) -> Iterator[tuple[str, float]]:
    """Yield what is to be said of visits that are too late, or of a goal after them.

    Parameters
    ----------
    vehicle : Vehicle
        With visits.
    earliest : sequence of (int or None)
        See `earliest_visits`.
    horizon : int
        Number of steps T.

    Yields
    ------
    str and float
        A sentence without the vehicle's name, and how bad it is: inf where no plan can be in time.
    """
    arrival, due = earliest[-1], vehicle.goal.window(horizon)[1]
    if arrival is not None:
        if arrival > _TIGHT * due:
            text = (
                f"goal {arrival} steps away at least by way of its visits, due at step {due}: "
                "little is left for paths around obstacles and others"
            )
            yield text, arrival / due
        return
    late = list(earliest).index(None)
    is_goal = late == len(vehicle.via)
    last = due if is_goal else steps_of_visits(vehicle.via, horizon)[late][1]
    since = "" if late == 0 else f" after via[{late - 1}], at step {earliest[late - 1]} at best"
    text = f"cannot be at {'its goal' if is_goal else f'via[{late}]'} by step {last}{since}"
    yield text, float("inf")


def is_in_time(scenario: Scenario, vehicle: Vehicle, horizon: int) -> bool:
    """Whether a vehicle makes its visits and reaches its goal after them, with some time left.

    Parameters
    ----------
    scenario : Scenario
        Whose step counts.
    vehicle : Vehicle
        With visits.
    horizon : int
        Number of steps T.
    """
    pace = Pace.of(vehicle)
    if pace is None:
        return False
    bounds = np.maximum(vehicle.control_bounds(vehicle.covariances(horizon)), 0.0)
    earliest = earliest_visits(vehicle, pace, bounds)
    if list(describe_visits(vehicle, earliest, horizon)):
        return False
    from radmpc.preflight.general import makes_all_visits  # noqa: PLC0415 - a solver

    return makes_all_visits(scenario, vehicle, horizon)
