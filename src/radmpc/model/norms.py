"""Limits of Euclidean norms: how they bound each axis, and how feedback keeps its share of them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from radmpc.arguments import field_number
from radmpc.arrays import Matrix, Vector
from radmpc.errors import ScenarioError
from radmpc.geometry import inner_faces

if TYPE_CHECKING:
    from radmpc.model.vehicle import Vehicle

__all__ = ["control_face_bounds", "limits_under"]


def limits_under(vehicle: Vehicle) -> dict[str, float | Vector]:
    """Return a vehicle's norms as numbers, and limits per axis that none of them exceeds.

    Parameters
    ----------
    vehicle : Vehicle
        With arrays of the right length already.

    Returns
    -------
    dict
        Values by the names of its fields.

    Raises
    ------
    ScenarioError
        If a norm is not positive, or has no two or three axes.
    """
    found: dict[str, float | Vector] = {}
    if vehicle.control_norm is not None:
        count = vehicle.system.num_controls
        if count not in (2, 3):
            raise ScenarioError(
                f"needs two or three controls, got {count}: limit each axis", ("control_limit",)
            )
        norm = _positive(vehicle.control_norm, "control_limit")
        found |= {"control_norm": norm, "control_limit": np.minimum(vehicle.control_limit, norm)}
    if vehicle.speed_norm is not None:
        norm = _positive(vehicle.speed_norm, "speed_limit")
        per_axis = vehicle.speed_limit
        limit = np.full(vehicle.system.dimension, norm) if per_axis is None else per_axis
        found |= {"speed_norm": norm, "speed_limit": np.minimum(limit, norm)}
    for value in found.values():
        if isinstance(value, np.ndarray):
            value.flags.writeable = False
    return found


def _positive(value: object, name: str) -> float:
    """Return a norm, > 0."""
    norm = field_number(value, (name, "norm"))
    if not 0.0 < norm < float("inf"):
        raise ScenarioError(f"must be > 0, got {norm:g}", (name, "norm"))
    return norm


def control_face_bounds(vehicle: Vehicle, first_step: int, horizon: int) -> Matrix:
    """Return the largest nominal control along the normals of `inner_faces`.

    Parameters
    ----------
    vehicle : Vehicle
        With a limit of the control's norm.
    first_step : int
        Step of the vehicle's noise at which they begin.
    horizon : int
        Number of steps T.

    Returns
    -------
    (T, f) array
        What the polytope within the limit leaves less ``control_sigmas`` standard deviations of
        the feedback along each normal, from the noise of the whole mission.
    """
    normals, share = inner_faces(vehicle.system.num_controls)
    most = share * (vehicle.control_norm or 0.0)
    if vehicle.gain is None:
        return np.full((horizon, len(normals)), most)
    last = first_step + horizon
    if vehicle.measurement is None:
        covariances = vehicle.covariances(last)
    else:
        covariances = vehicle.spread(last).estimates
    pulls = normals @ vehicle.gain
    seen = covariances[first_step:last]
    variances = np.einsum("fn,knm,fm->kf", pulls, seen, pulls)
    return np.asarray(most - vehicle.control_sigmas * np.sqrt(np.maximum(variances, 0.0)))
