"""Whether the mean makes its visits, one after the other, and arrives within its window."""

from __future__ import annotations

import numpy as np

from radmpc.arrays import Matrix, Vector
from radmpc.model.plan import Plan
from radmpc.model.vehicle import Vehicle
from radmpc.model.visits import Visit
from radmpc.referee.claims.tolerances import of_place, of_speed

__all__ = ["arrival_problems", "arrival_step", "time_to_come", "visit_problems"]


def visit_problems(vehicle: Vehicle, states: Matrix) -> list[str]:
    """Name the first visit that a mean does not make.

    Every visit is taken at the earliest step there is: if any choice of steps makes all visits in
    order, that one does.

    Parameters
    ----------
    vehicle : Vehicle
        With what it visits.
    states : (T+1, n) array
        Its mean states.

    Returns
    -------
    list of str
        Empty where all are made.
    """
    horizon, previous = len(states) - 1, 0
    for j, visit in enumerate(vehicle.via):
        first, last = (1, horizon - 1) if visit.between is None else visit.between
        beside = _beside(vehicle, visit, states)
        earliest = max(first, previous + 1)
        made = [k for k in range(earliest, last + 1) if beside[k] == 0.0]
        if made:
            previous = made[0]
            continue
        head = f"vehicle {vehicle.name!r}: does not visit via[{j}]"
        if earliest > last:
            return [
                f"{head}: the one before takes place at step {previous}, allowed is up to {last}"
            ]
        nearest = earliest + int(beside[earliest : last + 1].argmin())
        return [
            f"{head} at any step from {earliest} to {last}: its mean is nearest at step {nearest}, "
            f"beyond box or speed by {beside[nearest]:.3g}"
        ]
    return []


def _beside(vehicle: Vehicle, visit: Visit, states: Matrix) -> Vector:
    """Return by how much each mean state misses a visit's box or speed, (T+1,) [m, m/s].

    What may be missed is none.
    """
    positions = states[:, list(vehicle.system.position)]
    excess = np.maximum(visit.lower - positions, positions - visit.upper).max(axis=1)
    beside = np.where(excess > of_place(vehicle), excess, 0.0)
    if visit.speed is not None and vehicle.system.velocity is not None:
        speeds = np.abs(states[:, list(vehicle.system.velocity)])
        excess = (speeds - visit.speed).max(axis=1)
        beside = np.maximum(beside, np.where(excess > of_speed(vehicle), excess, 0.0))
    return np.asarray(beside)


def arrival_step(vehicle: Vehicle, states: Matrix) -> int:
    """Return the first step of a goal's window from which on the mean stays in the goal.

    Parameters
    ----------
    vehicle : Vehicle
        With the goal.
    states : (T+1, n) array
        Its mean states.

    Returns
    -------
    int
        The last step of the window where the mean is late.
    """
    goal, horizon = vehicle.goal, len(states) - 1
    first, last = (horizon, horizon) if goal.within is None else goal.within
    beside = _beside(vehicle, Visit(goal.lower, goal.upper, speed=goal.speed), states)
    step = last
    while step > first and beside[step - 1] == 0.0:
        step -= 1
    return step


def time_to_come(plan: Plan, passed: int) -> float:
    """Return what times until arrival still cost after some steps.

    Parameters
    ----------
    plan : Plan
        With trajectories.
    passed : int
        Steps.

    Returns
    -------
    float
        In units of effort; 0 for a vehicle that has arrived.
    """
    total = 0
    for vehicle, path in zip(plan.scenario.vehicles, plan.trajectories, strict=True):
        if vehicle.goal.within is None:
            continue
        arrived = arrival_step(vehicle, path.means)
        goal = Visit(vehicle.goal.lower, vehicle.goal.upper, speed=vehicle.goal.speed)
        # A window is open from its step 1 on at the earliest: a vehicle there before needs none.
        is_there = arrived == 1 and _beside(vehicle, goal, path.means[:1])[0] == 0.0
        total += max(arrived - is_there - passed, 0)
    return plan.scenario.time_weight * plan.scenario.dt * total


def arrival_problems(vehicle: Vehicle, states: Matrix) -> list[str]:
    """Name the last step at which a mean that should have arrived is not in its goal.

    Parameters
    ----------
    vehicle : Vehicle
        With the goal.
    states : (T+1, n) array
        Its mean states.

    Returns
    -------
    list of str
        Empty where it arrives in time and stays.
    """
    goal = vehicle.goal
    if goal.within is None:
        return []
    due = goal.within[1]
    beside = _beside(vehicle, Visit(goal.lower, goal.upper, speed=goal.speed), states)
    late = np.flatnonzero(beside[due:] > 0.0)
    if not late.size:
        return []
    step = due + int(late[-1])
    return [
        f"vehicle {vehicle.name!r}: is not in its goal from step {due} on: at step {step} its mean "
        f"is beyond box or speed by {beside[step]:.3g}"
    ]
