"""Hard rows: what the mean must keep in any case (paper, Eq. 3, and the goals)."""

from __future__ import annotations

import numpy as np

from radmpc.arrays import Matrix, Vector
from radmpc.geometry import inner_faces
from radmpc.program.condensed import CondensedModel

__all__ = ["hard_rows"]


def hard_rows(model: CondensedModel) -> tuple[Matrix, Vector, Vector]:
    """Return one vehicle's rows over its controls: goal, speed, norms, fixed visits; their bounds.

    Parameters
    ----------
    model : CondensedModel
        The vehicle.

    Returns
    -------
    (h, T*m), (h,) and (h,) array
        Rows, lower and upper bounds; speed limits that cannot bind are left out.
    """
    vehicle, last = model.vehicle, model.horizon
    arrived = range(vehicle.goal.window(last)[1], last + 1)
    rows = [model.position[k] for k in arrived]
    lowers = [vehicle.goal.lower - model.drift_position[k] for k in arrived]
    uppers = [vehicle.goal.upper - model.drift_position[k] for k in arrived]
    if model.velocity is not None and model.drift_velocity is not None:
        d = vehicle.system.dimension
        limits = np.full((last + 1, d), np.inf)
        if vehicle.speed_limit is not None:
            limits[:] = vehicle.speed_limit
        if vehicle.goal.speed is not None:
            limits[arrived[0] :] = np.minimum(limits[arrived[0] :], vehicle.goal.speed)
        largest = np.abs(model.velocity) @ np.maximum(model.control_bounds, 0.0).ravel()
        binding = np.abs(model.drift_velocity) + largest > limits
        binding[0] = False
        rows.append(model.velocity[binding])
        lowers.append((-limits - model.drift_velocity)[binding])
        uppers.append((limits - model.drift_velocity)[binding])
    if vehicle.via:
        from radmpc.program.visits.rows import fixed_visit_rows  # noqa: PLC0415 - few visit anything

        visits, lower, upper = fixed_visit_rows(model)
        rows.append(visits)
        lowers.append(lower)
        uppers.append(upper)
    if vehicle.control_norm is not None or vehicle.speed_norm is not None:
        normed, upper = _norm_rows(model)
        rows.append(normed)
        lowers.append(np.full(upper.size, -np.inf))
        uppers.append(upper)
    return np.vstack(rows), np.concatenate(lowers), np.concatenate(uppers)


def _norm_rows(model: CondensedModel) -> tuple[Matrix, Vector]:
    """Return the rows of polytopes within the limits of norms, and what they are at most."""
    vehicle, last = model.vehicle, model.horizon
    span = model.position.shape[2]
    rows: list[Matrix] = [np.zeros((0, span))]
    uppers: list[Vector] = [np.zeros(0)]
    if model.face_bounds is not None:
        normals, _ = inner_faces(span // last)
        rows.append(np.asarray(np.kron(np.eye(last), normals), dtype=np.float64))
        uppers.append(model.face_bounds.ravel())
    if vehicle.speed_norm is not None and model.velocity is not None:
        normals, share = inner_faces(vehicle.system.dimension)
        faces: Matrix = (normals @ model.velocity[1:]).reshape(-1, span)
        idle: Matrix = np.zeros((last, len(normals)))
        if model.drift_velocity is not None:
            idle = model.drift_velocity[1:] @ normals.T
        left: Vector = share * vehicle.speed_norm - idle.ravel()
        binding = np.abs(faces) @ np.maximum(model.control_bounds, 0.0).ravel() > left
        rows.append(faces[binding])
        uppers.append(left[binding])
    return np.vstack(rows), np.concatenate(uppers)
