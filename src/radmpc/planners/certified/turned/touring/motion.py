"""How double integrators move from step to step, and what bounds them: sparse rows, and boxes.

Columns are ``u+``, ``u-``, the mean positions and what controls add to the mean velocities, step by
step. Rows over controls alone, which say the same, have sixty times as many entries over sixty
steps.
"""

from __future__ import annotations

import numpy as np
from scipy.sparse import csr_array, vstack

from radmpc.arrays import Vector
from radmpc.model.goal import Goal
from radmpc.model.visits import Visit
from radmpc.program.condensed import CondensedModel
from radmpc.program.limits.norms import control_normals, on_diagonal, speed_faces
from radmpc.program.visits.columns import windows_of

__all__ = ["boxes_of", "motion_rows", "norm_rows"]

_INF = float("inf")


def motion_rows(model: CondensedModel) -> tuple[csr_array, Vector]:
    """Return what each step adds to positions and velocities, as rows and their right sides.

    Parameters
    ----------
    model : CondensedModel
        The vehicle.
    """
    system, last, span = model.vehicle.system, model.horizon, model.control_bounds.size
    order, d = [*system.position, *_velocity(model)], len(system.position)
    A, B = system.A[np.ix_(order, order)], system.B[order]
    right = np.zeros((last, 2 * d))
    right[:, :d] = np.diff(model.drift_position, axis=0)
    right[0, :d] = model.drift_position[1]
    step, state = np.arange(last)[:, None], np.arange(2 * d)
    # Of each state after each step, the column: positions first, then velocities.
    column = 2 * span + np.where(state < d, 0, (last - 1) * d) + step * d + state
    row = 2 * d * step + state
    (before, after), (driven, control) = np.nonzero(A)[::-1], np.nonzero(B)
    plus = step * B.shape[1] + control
    rows = [row, row[1:, after], row[:, driven], row[:, driven]]
    columns = [column, column[:-1, before], plus, plus + span]
    values = [np.ones(2 * d), -A[after, before], -B[driven, control], B[driven, control]]
    entries = [
        np.broadcast_to(each, at.shape).ravel() for each, at in zip(values, rows, strict=True)
    ]
    places = (
        np.concatenate([each.ravel() for each in rows]),
        np.concatenate([each.ravel() for each in columns]),
    )
    shape = right.size, 2 * span + right.size
    return csr_array((np.concatenate(entries), places), shape=shape), right.ravel()


def norm_rows(model: CondensedModel) -> tuple[csr_array, Vector]:
    """Return the rows of polytopes within the limits of norms, and what they are at most.

    Parameters
    ----------
    model : CondensedModel
        The vehicle.
    """
    vehicle, last, span = model.vehicle, model.horizon, model.control_bounds.size
    d = vehicle.system.dimension
    rows = [csr_array((0, 2 * span + 2 * last * d))]
    uppers: list[Vector] = [np.zeros(0)]
    if model.face_bounds is not None:
        faces = on_diagonal(control_normals(model))
        rows.append(csr_array(np.hstack([faces, -faces, np.zeros((len(faces), 2 * last * d))])))
        uppers.append(model.face_bounds.ravel())
    if vehicle.speed_norm is not None:
        normals, shares = speed_faces(model)
        faces = on_diagonal(normals)
        rows.append(csr_array(np.hstack([np.zeros((len(faces), 2 * span + last * d)), faces])))
        limits = np.tile(shares * vehicle.speed_norm, (last, 1))
        if model.drift_velocity is not None:
            limits -= np.einsum("kfd,kd->kf", normals, model.drift_velocity[1:])
        uppers.append(limits.ravel())
    return csr_array(vstack(rows)), np.concatenate(uppers)


def boxes_of(model: CondensedModel) -> tuple[Vector, Vector]:
    """Return the bounds of positions and velocities: goal, visits at given steps, speed limits.

    Parameters
    ----------
    model : CondensedModel
        The vehicle.
    """
    vehicle, last, d = model.vehicle, model.horizon, model.vehicle.system.dimension
    lower, upper = np.full((2, last + 1, d), -_INF), np.full((2, last + 1, d), _INF)
    if vehicle.speed_limit is not None:
        lower[1], upper[1] = -vehicle.speed_limit, vehicle.speed_limit
    due: list[tuple[slice, Goal | Visit]] = [
        (slice(vehicle.goal.window(last)[1], None), vehicle.goal)
    ]
    windows = zip(vehicle.via, windows_of(model), strict=True)
    due += [(slice(first, first + 1), visit) for visit, (first, end) in windows if first == end]
    for steps, box in due:
        lower[0, steps] = np.maximum(lower[0, steps], box.lower)
        upper[0, steps] = np.minimum(upper[0, steps], box.upper)
        if box.speed is not None:
            lower[1, steps] = np.maximum(lower[1, steps], -box.speed)
            upper[1, steps] = np.minimum(upper[1, steps], box.speed)
    if model.drift_velocity is not None:
        lower[1] -= model.drift_velocity
        upper[1] -= model.drift_velocity
    return lower[:, 1:].ravel(), upper[:, 1:].ravel()


def _velocity(model: CondensedModel) -> tuple[int, ...]:
    """Return the state indices of the velocities of a double integrator."""
    system = model.vehicle.system
    if system.velocity is not None or system.rates is None:
        return system.velocity or ()
    return system.rates[0]
