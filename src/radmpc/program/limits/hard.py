"""Hard rows: what the mean must keep in any case (paper, Eq. 3, and the goals)."""

from __future__ import annotations

import numpy as np

from radmpc.arrays import Matrix, Vector
from radmpc.program.condensed import CondensedModel
from radmpc.program.limits.norms import control_norm_rows, speed_norm_rows
from radmpc.records import dataclass
from radmpc.sparse_rows import SparseBlock, negated, side_by_side, sparse_block

__all__ = ["HardRows", "hard_rows", "keeps_hard_rows", "split_hard_rows"]

_TOL = 1e-7
"""What controls, speeds and goals may be missed by and count as kept [m, m/s, control], and a share
of what controls change at most where that is below one: linear solvers leave a hundredth of it, the
referee allows ten times as much."""


@dataclass(frozen=True, slots=True, eq=False)
class HardRows:
    """One vehicle's hard rows over its columns ``u+``, then ``u-``.

    Attributes
    ----------
    rows : SparseBlock
        Coefficients.
    lower, upper : (h,) array
        Bounds.
    """

    rows: SparseBlock
    lower: Vector
    upper: Vector


def split_hard_rows(model: CondensedModel) -> HardRows:
    """Return one vehicle's hard rows over its columns; every program of it has them.

    Parameters
    ----------
    model : CondensedModel
        The vehicle.
    """
    return model.kept.once(_split, model)


def _split(model: CondensedModel) -> HardRows:
    """Compute them."""
    rows, lower, upper = hard_rows(model)
    block = sparse_block(rows)
    return HardRows(side_by_side([block, negated(block)]), lower, upper)


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
        normed, upper = _binding_norm_rows(model)
        rows.append(normed)
        lowers.append(np.full(upper.size, -np.inf))
        uppers.append(upper)
    return np.vstack(rows), np.concatenate(lowers), np.concatenate(uppers)


def keeps_hard_rows(model: CondensedModel, controls: Matrix) -> bool:
    """Tell whether controls keep one vehicle's limits and lead to its goal, in its programs.

    Parameters
    ----------
    model : CondensedModel
        The vehicle.
    controls : (T, m) array
        Its nominal controls.
    """
    limit = model.vehicle.control_limit
    if np.any(np.abs(controls) > model.control_bounds + _TOL * np.minimum(limit, 1.0)):
        return False
    rows, lower, upper = hard_rows(model)
    at = rows @ controls.ravel()
    most = np.abs(rows) @ np.tile(limit, model.horizon)
    slack = _TOL * np.minimum(most, 1.0)
    return bool(np.all((at >= lower - slack) & (at <= upper + slack)))


def _binding_norm_rows(model: CondensedModel) -> tuple[Matrix, Vector]:
    """Return them without those of speeds that cannot bind, and what they are at most."""
    rows: list[Matrix] = [np.zeros((0, model.position.shape[2]))]
    uppers: list[Vector] = [np.zeros(0)]
    for faces, most in control_norm_rows(model):
        rows.append(faces)
        uppers.append(most.ravel())
    for faces, most in speed_norm_rows(model):
        left = most.ravel()
        binding = np.abs(faces) @ np.maximum(model.control_bounds, 0.0).ravel() > left
        rows.append(faces[binding])
        uppers.append(left[binding])
    return np.vstack(rows), np.concatenate(uppers)
