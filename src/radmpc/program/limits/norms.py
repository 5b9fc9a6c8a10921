"""Limits of norms in programs: polytopes within discs and balls, and how these are turned."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from radmpc.arrays import Matrix, Tensor, Vector
from radmpc.geometry import directions_ahead, inner_corners, inner_faces, inner_faces_ahead
from radmpc.program.condensed import CondensedModel
from radmpc.records import replace

__all__ = [
    "control_norm_rows",
    "control_normals",
    "norm_rows",
    "on_diagonal",
    "speed_faces",
    "speed_norm_rows",
    "turned_inside",
    "turned_outside",
    "turned_to_goal",
]

_FacesOf = Callable[[int], tuple[Matrix, Vector]]
"""Unit normals of the faces of a polytope in so many dimensions, and how much they leave."""

_STILL = 1e-9
"""Share of a limit below which a control or a speed has no direction worth turning to [-]."""


def norm_rows(model: CondensedModel) -> tuple[tuple[Matrix, Matrix], ...]:
    """Return the rows of polytopes within the limits of norms, and what they are at most.

    Parameters
    ----------
    model : CondensedModel
        The vehicle.

    Returns
    -------
    tuple of ((T*f, T*m) and (T, f) array)
        Of controls, then of speeds at steps 1..T, as far as their norms are limited: rows over the
        controls, step by step, and upper bounds.
    """
    return (*control_norm_rows(model), *speed_norm_rows(model))


def control_norm_rows(model: CondensedModel) -> tuple[tuple[Matrix, Matrix], ...]:
    """Return those of controls, if any.

    Parameters
    ----------
    model : CondensedModel
        The vehicle.
    """
    if model.face_bounds is None:
        return ()
    return ((on_diagonal(control_normals(model)), model.face_bounds),)


def speed_norm_rows(model: CondensedModel) -> tuple[tuple[Matrix, Matrix], ...]:
    """Return those of speeds, if any.

    Parameters
    ----------
    model : CondensedModel
        The vehicle.
    """
    limit = model.vehicle.speed_norm
    if limit is None or model.velocity is None:
        return ()
    normals, shares = speed_faces(model)
    rows: Matrix = (normals @ model.velocity[1:]).reshape(-1, model.position.shape[2])
    most: Matrix = np.tile(shares * limit, (model.horizon, 1))
    if model.drift_velocity is not None:
        most = most - np.einsum("kfd,kd->kf", normals, model.drift_velocity[1:])
    return ((rows, most),)


def control_normals(model: CondensedModel) -> Tensor:
    """Return the outward normals that controls keep to at every step, (T, f, m).

    Parameters
    ----------
    model : CondensedModel
        The vehicle.
    """
    if model.face_normals is not None:
        return model.face_normals
    return _at_all_steps(inner_faces(model.control_bounds.shape[1])[0], model.horizon)


def speed_faces(model: CondensedModel) -> tuple[Tensor, Vector]:
    """Return those that velocities keep to at steps 1..T, and what they leave of the norm.

    Parameters
    ----------
    model : CondensedModel
        The vehicle.

    Returns
    -------
    (T, f, d) and (f,) array
        Outward normals, and the distances of the faces as shares of the norm [-].
    """
    if model.speed_faces is not None:
        return model.speed_faces
    normals, share = inner_faces(model.vehicle.system.dimension)
    return _at_all_steps(normals, model.horizon), np.full(len(normals), share)


def turned_inside(model: CondensedModel, controls: Matrix) -> CondensedModel:
    """Return a vehicle whose polytopes have their corners close together where a plan is.

    There they leave all of the norm, elsewhere less than before. A plan that keeps the norms keeps
    to them, so that turning to the plan that this leads to only gains.

    Parameters
    ----------
    model : CondensedModel
        A vehicle from the first step of its noise; the same where its norms are free.
    controls : (T, m) array
        Its plan.
    """
    return _faced(model, controls, _speeds(model, controls), inner_faces_ahead)


def turned_outside(model: CondensedModel, controls: Matrix) -> CondensedModel:
    """Return a vehicle with polytopes around its norms that touch these close to a plan, too.

    Parameters
    ----------
    model : CondensedModel
        Of a vehicle `radmpc.model.limits.outside_norms`. The referee asks for the feedback's
        reserve in all directions.
    controls : (T, m) array
        The plan.
    """
    faced = _faced(model, controls, _speeds(model, controls), _outer_faces_ahead)
    if faced.speed_faces is not None:
        (turned, shares), (given, others) = faced.speed_faces, speed_faces(model)
        faces = np.concatenate([turned, given], axis=1), np.concatenate([shares, others])
        faced = replace(faced, speed_faces=faces)
    if faced.face_bounds is None or model.face_bounds is None:
        return faced
    return replace(
        faced,
        face_normals=np.concatenate([control_normals(faced), control_normals(model)], axis=1),
        face_bounds=np.hstack([faced.face_bounds, model.face_bounds]),
    )


def turned_to_goal(model: CondensedModel) -> CondensedModel:
    """Return a vehicle whose polytopes have corners in the direction from its start to its goal.

    Parameters
    ----------
    model : CondensedModel
        As in `turned_inside`.
    """
    goal = model.vehicle.goal
    ahead = 0.5 * (goal.lower + goal.upper) - model.drift_position[0]
    every = np.tile(ahead, (model.horizon, 1))
    return _faced(model, every, every, _inner_faces_cornered)


def _inner_faces_cornered(dimension: int) -> tuple[Matrix, Vector]:
    """Return `inner_faces` turned so that a corner is on the first axis."""
    normals, share = inner_faces(dimension)
    axis = np.eye(dimension)[:1]
    corners = inner_corners(dimension)
    nearest = corners[[int(corners[:, 0].argmax())]]
    return normals @ _rotations(nearest, axis)[0].T, np.full(len(normals), share)


def _outer_faces_ahead(dimension: int) -> tuple[Matrix, Vector]:
    """Return faces that touch the given norm, of vehicles with a norm that much larger."""
    normals, share = directions_ahead(dimension), inner_faces(dimension)[1]
    return normals, np.full(len(normals), share)


def _speeds(model: CondensedModel, controls: Matrix) -> Matrix:
    """Return the velocities of a plan at steps 1..T, (T, d); nothing of systems without any."""
    if model.velocity is None or model.drift_velocity is None:
        return np.zeros((0, model.vehicle.system.dimension))
    return model.velocity[1:] @ controls.ravel() + model.drift_velocity[1:]


def _faced(
    model: CondensedModel, controls: Matrix, speeds: Matrix, faces_of: _FacesOf
) -> CondensedModel:
    """Return a vehicle whose polytopes are turned with their first axis in given directions."""
    vehicle, d = model.vehicle, model.vehicle.system.dimension
    if vehicle.control_norm is not None and controls.shape[1] == model.control_bounds.shape[1]:
        from radmpc.model.limits import control_face_bounds  # noqa: PLC0415 - few have any

        faces = _turned(controls, vehicle.control_norm, faces_of)
        bounds = control_face_bounds(vehicle, 0, model.horizon, faces)
        model = replace(model, face_normals=faces[0], face_bounds=bounds)
    if vehicle.speed_norm is not None and speeds.shape == (model.horizon, d):
        model = replace(model, speed_faces=_turned(speeds, vehicle.speed_norm, faces_of))
    return model


def _turned(directions: Matrix, limit: float, faces_of: _FacesOf) -> tuple[Tensor, Vector]:
    """Return faces at every step, their first axis turned to a direction, and what they leave."""
    d = directions.shape[1]
    normals, shares = faces_of(d)
    lengths = np.sqrt(np.square(directions).sum(axis=1))
    along = np.tile(np.eye(d)[0], (len(directions), 1))
    moving = lengths > _STILL * limit
    along[moving] = directions[moving] / lengths[moving, None]
    # Half a turn first where that is the shorter way: opposite vectors have no plane of rotation.
    halves = np.where(along[:, :1] < 0.0, -1.0, 1.0)
    flips = np.ones((len(along), d))
    flips[:, :2] = halves
    rotations = _rotations(halves * np.eye(d)[0], along)
    return (flips[:, None, :] * normals) @ rotations.swapaxes(1, 2), shares


def _at_all_steps(normals: Matrix, horizon: int) -> Tensor:
    """Return the same normals at every step, (T, f, d)."""
    return np.broadcast_to(normals, (horizon, *normals.shape))


def _rotations(begin: Matrix, end: Matrix) -> Tensor:
    """Return the rotations in the planes of two unit vectors that turn one to the other, (k, d, d).

    They are less than a right angle apart.
    """
    both = begin + end
    cosines = np.einsum("kd,kd->k", begin, end)
    halves = np.einsum("ki,kj->kij", both, both) / (1.0 + cosines)[:, None, None]
    found: Tensor = np.eye(begin.shape[1]) - halves + 2.0 * np.einsum("ki,kj->kij", end, begin)
    return found


def on_diagonal(normals: Tensor) -> Matrix:
    """Return rows of every step's normals over the vectors of all steps, (T*f, T*m).

    Parameters
    ----------
    normals : (T, f, m) array
        Step by step.
    """
    horizon, faces, m = normals.shape
    rows = np.zeros((horizon, faces, horizon, m))
    steps = np.arange(horizon)
    rows[steps, :, steps] = normals
    return rows.reshape(horizon * faces, horizon * m)
