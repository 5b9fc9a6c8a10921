"""Whose numbers plainly keep what they claim, a whole fleet's looked at together.

A vehicle alone takes a dozen comparisons of small arrays; of a large fleet hardly one fails.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from radmpc.arrays import Tensor
from radmpc.model.plan import Plan, Trajectory
from radmpc.model.vehicle import Vehicle
from radmpc.referee.claims.tolerances import (
    beyond_limit,
    of_covariances,
    of_means,
    of_place,
    of_speeds,
)
from radmpc.referee.motion import FleetMotion

__all__ = ["differing", "exceeding_limits"]

Flags = npt.NDArray[np.bool_]


def differing(plan: Plan, motion: FleetMotion) -> list[int]:
    """Return the vehicles whose stated means or covariances are not the true ones.

    Parameters
    ----------
    plan : Plan
        With trajectories.
    motion : FleetMotion
        The true one.
    """
    found = []
    for i, (vehicle, stated) in enumerate(
        zip(plan.scenario.vehicles, plan.trajectories, strict=True)
    ):
        means, covariances = motion.states[i], motion.covariances[i]
        # Most are the same to the last bit.
        if np.array_equal(stated.means, means) and np.array_equal(stated.covariances, covariances):
            continue
        off = np.abs(stated.means - means) > of_means(vehicle, means)
        apart = np.abs(stated.covariances - covariances) > of_covariances(vehicle, covariances)
        if off.any() or apart.any():
            found.append(i)
    return found


def exceeding_limits(plan: Plan, motion: FleetMotion) -> list[int]:
    """Return the vehicles that exceed a limit or miss their goal, and those with more to keep.

    Parameters
    ----------
    plan : Plan
        With trajectories.
    motion : FleetMotion
        The true one.
    """
    vehicles = plan.scenario.vehicles
    found = [i for i, vehicle in enumerate(vehicles) if _asks_more(vehicle)]
    rest = sorted(set(range(len(vehicles))) - set(found))
    for which in _alike([_shape(vehicles[i]) for i in rest]):
        members = [rest[at] for at in which]
        some, paths = [vehicles[i] for i in members], [plan.trajectories[i] for i in members]
        off = _exceeds(some, paths, np.array([motion.states[i] for i in members]))
        found += np.array(members)[off].tolist()
    return sorted(found)


def _asks_more(vehicle: Vehicle) -> bool:
    """Return whether a vehicle has limits that depend on its noise, norms, or places to visit."""
    norms = vehicle.control_norm is not None or vehicle.speed_norm is not None
    visits = bool(vehicle.via) or vehicle.goal.within is not None
    return vehicle.gain is not None or norms or visits


def _shape(vehicle: Vehicle) -> tuple[object, ...]:
    """Return what vehicles must have in common to be looked at together."""
    system = vehicle.system
    velocity = None if system.velocity is None else tuple(system.velocity)
    return system.B.shape, tuple(system.position), velocity


def _alike(shapes: Sequence[object]) -> list[list[int]]:
    """Return the numbers of each shape."""
    groups: dict[object, list[int]] = {}
    for number, shape in enumerate(shapes):
        groups.setdefault(shape, []).append(number)
    return list(groups.values())


def _exceeds(vehicles: Sequence[Vehicle], paths: Sequence[Trajectory], states: Tensor) -> Flags:
    """Return which exceed a control, a speed or the goal, (g,) bool."""
    system = vehicles[0].system
    controls = np.array([path.controls for path in paths])
    limits = np.array([vehicle.control_limit for vehicle in vehicles])[:, None]
    over = (np.abs(controls) > limits + beyond_limit(limits, limits)).any(axis=(1, 2))
    place, beside = (
        states[:, -1, list(system.position)],
        np.array([[of_place(v)] for v in vehicles]),
    )
    over |= (place < np.array([v.goal.lower for v in vehicles]) - beside).any(axis=1)
    over |= (place > np.array([v.goal.upper for v in vehicles]) + beside).any(axis=1)
    if system.velocity is not None:
        speeds = np.abs(states[:, 1:, list(system.velocity)])
        free = np.full(speeds.shape[2], np.inf)
        fast = [free if v.speed_limit is None else v.speed_limit for v in vehicles]
        last = [free if v.goal.speed is None else v.goal.speed for v in vehicles]
        most = np.array([limit + beyond_limit(limit, limit) for limit in fast])
        over |= (speeds > most[:, None]).any(axis=(1, 2))
        slow = np.array(
            [limit + of_speeds(v, limit) for v, limit in zip(vehicles, last, strict=True)]
        )
        over |= (speeds[:, -1] > slow).any(axis=1)
    return np.asarray(over)
