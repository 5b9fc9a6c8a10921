"""Limits: what feedback leaves of those of norms, and which a plan uses up."""

from __future__ import annotations

from typing import Literal

import numpy as np

from radmpc.arrays import Matrix, Tensor, Vector
from radmpc.geometry import inner_faces
from radmpc.model.plan import Plan, Trajectory
from radmpc.model.scenario import Scenario
from radmpc.model.vehicle import Vehicle
from radmpc.records import dataclass, replace

__all__ = [
    "TightLimit",
    "all_outside_norms",
    "control_face_bounds",
    "outside_norms",
    "tight_limits",
    "within_limits",
]

_CLOSE = 1e-6
"""Share of a limit below which what is left of it is rounding."""


@dataclass(frozen=True, slots=True)
class TightLimit:
    """A limit that a vehicle uses up.

    Attributes
    ----------
    vehicle : str
        The vehicle.
    limit : {'control', 'speed'}
        Which: the control limit less the feedback's reserve, or the speed limit.
    num_steps : int
        At how many steps, on any axis.
    """

    vehicle: str
    limit: Literal["control", "speed"]
    num_steps: int


def tight_limits(plan: Plan) -> tuple[TightLimit, ...]:
    """Return the limits that a plan uses up, those in use longest first.

    Parameters
    ----------
    plan : Plan
        Any; without trajectories none is in use.

    Returns
    -------
    tuple of TightLimit
        At most two per vehicle.
    """
    found = []
    for vehicle, trajectory in zip(plan.scenario.vehicles, plan.trajectories, strict=False):
        controls = np.abs(trajectory.controls)
        bounds = vehicle.control_bounds(trajectory.covariances)
        used = _num_used(controls, bounds, vehicle.control_limit)
        if vehicle.control_norm is not None:
            normals, _ = inner_faces(controls.shape[1])
            faces = control_face_bounds(vehicle, 0, len(controls))
            along = trajectory.controls @ normals.T
            used = max(used, _num_used(along, faces, np.full(len(normals), vehicle.control_norm)))
        found.append(TightLimit(vehicle.name, "control", used))
        found.append(TightLimit(vehicle.name, "speed", _num_fast(vehicle, trajectory)))
    used_up = [limit for limit in found if limit.num_steps]
    return tuple(sorted(used_up, key=lambda limit: -limit.num_steps))


def _num_fast(vehicle: Vehicle, trajectory: Trajectory) -> int:
    """Return at how many steps the mean speed is at its limit."""
    if vehicle.speed_limit is None or vehicle.system.velocity is None:
        return 0
    speeds = trajectory.means[1:, list(vehicle.system.velocity)]
    limit = vehicle.speed_limit
    per_axis = _num_used(np.abs(speeds), np.broadcast_to(limit, speeds.shape), limit)
    if vehicle.speed_norm is None:
        return per_axis
    normals, share = inner_faces(speeds.shape[1])
    most = np.full((len(speeds), len(normals)), share * vehicle.speed_norm)
    return max(per_axis, _num_used(speeds @ normals.T, most, most[0]))


def _num_used(values: Matrix, bounds: Matrix, scale: Matrix) -> int:
    """Return in how many rows some value reaches its bound."""
    if values.shape != bounds.shape:
        return 0
    return int(np.count_nonzero(np.any(values >= bounds - _CLOSE * scale, axis=1)))


def control_face_bounds(
    vehicle: Vehicle, first_step: int, horizon: int, faces: tuple[Tensor, Vector] | None = None
) -> Matrix:
    """Return the largest nominal control along the normals of a polytope's faces.

    Parameters
    ----------
    vehicle : Vehicle
        With a limit of the control's norm.
    first_step : int
        Step of the vehicle's noise at which they begin.
    horizon : int
        Number of steps T.
    faces : ((T, f, m) array, (f,) array) or None
        The normals of every step, and how much each face leaves of the norm [-]; None is those of
        `inner_faces` at all.

    Returns
    -------
    (T, f) array
        What the polytope within the limit leaves less ``control_sigmas`` standard deviations of
        the feedback along each normal, from the noise of the whole mission.
    """
    if faces is None:
        normals, share = inner_faces(vehicle.system.num_controls)
        faces = np.broadcast_to(normals, (horizon, *normals.shape)), np.full(len(normals), share)
    most = np.tile(faces[1] * (vehicle.control_norm or 0.0), (horizon, 1))
    if vehicle.gain is None:
        return most
    last = first_step + horizon
    if vehicle.measurement is None:
        covariances = vehicle.covariances(last)
    else:
        covariances = vehicle.spread(last).estimates
    pulls = faces[0] @ vehicle.gain
    seen = covariances[first_step:last]
    variances = np.einsum("kfn,knm,kfm->kf", pulls, seen, pulls)
    return np.asarray(most - vehicle.control_sigmas * np.sqrt(np.maximum(variances, 0.0)))


def outside_norms(vehicle: Vehicle) -> Vehicle:
    """Return a vehicle whose programs leave it all that its norms do, and a little more.

    Programs keep to polytopes within norms. Within these larger norms they touch the given ones
    from outside: what no such program does, no plan does.

    Parameters
    ----------
    vehicle : Vehicle
        Any; the same where its norms are free.
    """
    control, speed = vehicle.control_norm, vehicle.speed_norm
    if control is None and speed is None:
        return vehicle
    if control is not None:
        control /= inner_faces(vehicle.system.num_controls)[1]
    if speed is not None:
        speed /= inner_faces(vehicle.system.dimension)[1]
    return replace(vehicle, control_norm=control, speed_norm=speed)


def all_outside_norms(scenario: Scenario) -> Scenario:
    """Return a scenario with all its vehicles `outside_norms`; the same where norms are free.

    Parameters
    ----------
    scenario : Scenario
        Any.
    """
    vehicles = tuple(map(outside_norms, scenario.vehicles))
    if all(one is other for one, other in zip(vehicles, scenario.vehicles, strict=True)):
        return scenario
    return replace(scenario, vehicles=vehicles)


def within_limits(vehicle: Vehicle, control: Vector) -> Vector:
    """Return what an autopilot makes of a control that is asked for.

    Parameters
    ----------
    vehicle : Vehicle
        With its limits.
    control : (m,) array
        What is asked for.

    Returns
    -------
    (m,) array
        Cut off along each axis, then shortened to the norm, its direction kept.
    """
    held: Vector = np.clip(control, -vehicle.control_limit, vehicle.control_limit)
    if vehicle.control_norm is None:
        return held
    norm = float(np.sqrt(held @ held))
    return held if norm <= vehicle.control_norm else held * (vehicle.control_norm / norm)
