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
from radmpc.referee.motion import FleetMotion

__all__ = ["differing", "exceeding_limits", "is_beyond"]

Flags = npt.NDArray[np.bool_]


def differing(plan: Plan, motion: FleetMotion, tolerance: float) -> list[int]:
    """Return the vehicles whose stated means or covariances are not the true ones.

    Parameters
    ----------
    plan : Plan
        With trajectories.
    motion : FleetMotion
        The true one.
    tolerance : float
        Of a difference, relative above one [-].
    """
    found = []
    for members in _alike([states.shape for states in motion.states]):
        some = [plan.trajectories[i] for i in members]
        means = np.array([each.means for each in some])
        covariances = np.array([each.covariances for each in some])
        off = _differs(means, np.array([motion.states[i] for i in members]), tolerance)
        off |= _differs(covariances, np.array([motion.covariances[i] for i in members]), tolerance)
        found += np.array(members)[off].tolist()
    return sorted(found)


def exceeding_limits(plan: Plan, motion: FleetMotion, tolerance: float) -> list[int]:
    """Return the vehicles that exceed a limit or miss their goal, and those with more to keep.

    Parameters
    ----------
    plan : Plan
        With trajectories.
    motion : FleetMotion
        The true one.
    tolerance : float
        Of what exceeds a limit, relative above one; of the goal absolute [m].
    """
    vehicles = plan.scenario.vehicles
    found = [i for i, vehicle in enumerate(vehicles) if _asks_more(vehicle)]
    rest = sorted(set(range(len(vehicles))) - set(found))
    for which in _alike([_shape(vehicles[i]) for i in rest]):
        members = [rest[at] for at in which]
        some, paths = [vehicles[i] for i in members], [plan.trajectories[i] for i in members]
        off = _exceeds(some, paths, np.array([motion.states[i] for i in members]), tolerance)
        found += np.array(members)[off].tolist()
    return sorted(found)


def is_beyond(values: Tensor, limits: Tensor, tolerance: float) -> Flags:
    """Return which values exceed their limits in size, as broadcast.

    Parameters
    ----------
    values, limits : array
        Of one unit; shapes that can be broadcast.
    tolerance : float
        What they may do so by, relative where limits exceed one [-].
    """
    return np.asarray(np.abs(values) > limits + tolerance * np.maximum(1.0, np.abs(limits)))


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


def _differs(stated: Tensor, true: Tensor, tolerance: float) -> Flags:
    """Return whose numbers are off, (g,) bool."""
    off = np.abs(stated - true) > tolerance * np.maximum(1.0, np.abs(true))
    return np.asarray(off.any(axis=tuple(range(1, off.ndim))))


def _exceeds(
    vehicles: Sequence[Vehicle], paths: Sequence[Trajectory], states: Tensor, tolerance: float
) -> Flags:
    """Return which exceed a control, a speed or the goal, (g,) bool."""
    system = vehicles[0].system
    controls = np.array([path.controls for path in paths])
    limits = np.array([vehicle.control_limit for vehicle in vehicles])
    over = is_beyond(controls, limits[:, None], tolerance).any(axis=(1, 2))
    place = states[:, -1, list(system.position)]
    over |= (place < np.array([v.goal.lower for v in vehicles]) - tolerance).any(axis=1)
    over |= (place > np.array([v.goal.upper for v in vehicles]) + tolerance).any(axis=1)
    if system.velocity is not None:
        speeds = states[:, 1:, list(system.velocity)]
        free = np.full(speeds.shape[2], np.inf)
        fast = np.array([free if v.speed_limit is None else v.speed_limit for v in vehicles])
        last = np.array([free if v.goal.speed is None else v.goal.speed for v in vehicles])
        over |= is_beyond(speeds, fast[:, None], tolerance).any(axis=(1, 2))
        over |= is_beyond(speeds[:, -1], last, tolerance).any(axis=1)
    return np.asarray(over)
