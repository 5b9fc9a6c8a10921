"""Limits of Euclidean norms: whether means keep them, and how likely feedback exceeds them."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from radmpc.arrays import Matrix, Tensor, Vector
from radmpc.model.vehicle import Vehicle
from radmpc.referee.claims.tolerances import beyond_limit
from radmpc.referee.polytopes import polytopes_within
from radmpc.referee.tails import exceeding

__all__ = ["allowed_beyond", "norm_excess", "norm_problems", "saturation_of_norm"]

_HALVINGS = 60
"""Of the interval that holds a multiplier [-]: what is left is rounding."""

_NOTHING = 1e-140
"""Stands for 0 where one divides by it, and squares what comes of it."""


def norm_problems(vehicle: Vehicle, states: Matrix, controls: Matrix, seen: Tensor) -> list[str]:
    """Name the first control and the first speed whose norm exceeds its limit.

    A control keeps ``n @ u + control_sigmas * deviation along n <= norm`` in all directions n.

    Parameters
    ----------
    vehicle : Vehicle
        With its limits.
    states : (T+1, n) array
        Its mean.
    controls : (T, m) array
        Nominal controls.
    seen : (T, n, n) array
        Covariances of what its feedback sees of the deviation.
    """
    problems = []
    if vehicle.control_norm is not None:
        what, norms = "control", np.sqrt(np.square(controls).sum(axis=1))
        if vehicle.gain is not None:
            what = "control, the feedback's reserve included,"
            pulls = np.asarray(vehicle.gain)
            norms = _with_reserve(controls, vehicle.control_sigmas**2 * (pulls @ seen @ pulls.T))
        problems += _first(vehicle.name, what, norms, vehicle.control_norm, 0)
    if vehicle.speed_norm is not None and vehicle.system.velocity is not None:
        speeds = states[1:, list(vehicle.system.velocity)]
        norms = np.sqrt(np.square(speeds).sum(axis=1))
        problems += _first(vehicle.name, "speed", norms, vehicle.speed_norm, 1)
    return problems


def _with_reserve(controls: Matrix, spreads: Tensor) -> Vector:
    r"""Return the largest ``n @ u + sqrt(n @ S @ n)`` over all unit vectors n, step by step.

    That is the largest norm of ``u + root(S) @ w`` over the unit ball of w, of which the square is
    the least of $|u|^2 + \mu + \sum_i b_i^2 / (\mu - \lambda_i)$ over $\mu \ge \max \lambda$,
    with the eigenvalues of S and ``b = root(S) @ u`` along its eigenvectors: maximizing a quadratic
    form over a ball has no gap to its dual. Any μ gives an upper bound.

    Parameters
    ----------
    controls : (T, m) array
        Nominal controls u.
    spreads : (T, m, m) array
        S, with the square of the deviations in reserve in it.
    """
    values, axes = np.linalg.eigh(spreads)
    values = values.clip(min=0.0)
    along = np.sqrt(values) * np.einsum("kij,ki->kj", axes, controls)
    least, most = values[:, -1], values[:, -1] + np.sqrt(np.square(along).sum(axis=1))
    for _ in range(_HALVINGS):
        middle = 0.5 * (least + most)
        over = np.maximum(middle[:, None] - values, _NOTHING)
        is_steep = np.square(along / over).sum(axis=1) > 1.0
        least, most = np.where(is_steep, middle, least), np.where(is_steep, most, middle)
    parts = np.square(along) / np.maximum(most[:, None] - values, _NOTHING)
    squares = np.square(controls).sum(axis=1) + most + parts.sum(axis=1)
    return np.asarray(np.sqrt(squares))


def _first(name: str, what: str, norms: Vector, limit: float, first: int) -> list[str]:
    """Name the first norm above a limit."""
    over = np.flatnonzero(norms > limit + beyond_limit(np.array(limit), np.array(limit)))
    if not over.size:
        return []
    k = int(over[0])
    return [
        f"vehicle {name!r}: norm of its {what} at step {first + k} is {norms[k]:.9g}, allowed is "
        f"up to {limit:.9g}"
    ]


def _deviations(vehicle: Vehicle, along: Matrix, seen: Tensor) -> Matrix:
    """Return the deviations of the feedback along directions, (T, f)."""
    pulls = along @ np.asarray(vehicle.gain)
    variances = ((pulls @ seen) * pulls).sum(axis=2)
    return np.asarray(np.sqrt(variances.clip(min=0.0)))


def saturation_of_norm(
    vehicle: Vehicle, controls: Matrix, seen: Tensor, slack: float, samples: int | None
) -> float:
    """Return an upper bound on the probability that the norm of any control exceeds its limit.

    By Boole's inequality over steps and the faces of a polytope within the limit; of several, the
    best at every step.

    Parameters
    ----------
    vehicle : Vehicle
        With a limit of the control's norm.
    controls : (T, m) array
        Nominal controls.
    seen : (T, n, n) array
        Covariances of what its feedback sees of the deviation.
    slack : float
        What the limit may be exceeded by.
    samples : int or None
        Independent steps that covariances were estimated from; None is that they are known.
    """
    limit = vehicle.control_norm or 0.0
    sure = np.sqrt(np.square(controls).sum(axis=1)) > limit + slack
    if vehicle.gain is None:
        return float(sure.any())
    best = np.full(len(controls), np.inf)
    still: npt.NDArray[np.bool_] = np.zeros(len(controls), dtype=bool)
    for normals, share in polytopes_within(controls.shape[1]):
        spread = _deviations(vehicle, normals, seen)
        room = share * (limit + allowed_beyond(spread, slack)) - controls @ normals.T
        tails = exceeding(room / np.where(spread > 0.0, spread, 1.0), samples)
        risks = np.where(spread > 0.0, tails, (room < 0.0).astype(np.float64))
        best = np.minimum(best, risks.sum(axis=1))
        still = np.logical_not((spread > 0.0).any(axis=1))
    return float(np.where(still, sure.astype(np.float64), np.minimum(best, 1.0)).sum())


def allowed_beyond(spread: Matrix, slack: float | Vector) -> Matrix:
    """Return what controls may exceed a limit by before they count as cut off.

    Parameters
    ----------
    spread : array
        Standard deviations of what feedback asks for.
    slack : float or array
        What solvers' tolerances let nominal controls exceed it by. Where noise shakes a control by
        a hundredth of that or more, it would make a saturation look less likely than it is.
    """
    return np.where(spread > 0.01 * np.asarray(slack), 0.0, slack)


def norm_excess(controls: Matrix, limit: float) -> Matrix:
    """Return what controls have beyond a norm, (m, S): an autopilot keeps their direction.

    Parameters
    ----------
    controls : (m, S) array
        Of many samples.
    limit : float
        The norm.
    """
    norms = np.sqrt(np.square(controls).sum(axis=0))
    return np.asarray(controls * np.maximum(1.0 - limit / np.maximum(norms, limit), 0.0))
