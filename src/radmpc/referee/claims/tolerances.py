"""By how much numbers may differ: a millionth, and never much of what matters in a scene's units.

Numbers of a scene in kilometers or hours are small: what is rounding in meters and seconds would be
many times their limits, radii or variances.
"""

from __future__ import annotations

import numpy as np

from radmpc.arrays import Matrix, Tensor, Vector
from radmpc.model.scenario import Scenario
from radmpc.model.vehicle import Vehicle

__all__ = [
    "beyond_limit",
    "of_cost",
    "of_covariances",
    "of_gain",
    "of_means",
    "of_place",
    "of_speed",
    "of_speeds",
]

_SHARE = 1e-6
"""Of a limit [-]; also the largest difference of numbers below one, in their own unit."""

_NOTICED = 1e-3
"""Share of a radius, of the speed that a step adds, or of a variance that is still let pass [-]."""

_ROUNDING = 1e-12
"""Share of the largest coordinate of a path that may be rounding of another one [-]."""


def beyond_limit(bounds: Tensor, limits: Tensor) -> Tensor:
    """Return what values may exceed bounds by, as broadcast.

    Parameters
    ----------
    bounds : array
        What is left of the limits, of their unit.
    limits : array
        The limits themselves, > 0.
    """
    return np.asarray(_SHARE * np.minimum(limits, np.maximum(1.0, np.abs(bounds))))


def of_place(vehicle: Vehicle) -> float:
    """Return what a mean may miss a box by [m].

    Parameters
    ----------
    vehicle : Vehicle
        Whose radius counts.
    """
    return min(_SHARE, _NOTICED * vehicle.radius)


def of_speed(vehicle: Vehicle) -> float:
    """Return what a mean may exceed a speed of a goal or a visit by, also one of zero [m/s].

    Parameters
    ----------
    vehicle : Vehicle
        What its controls add to its speed within a step counts.
    """
    return min(_SHARE, _NOTICED * _added_speed(vehicle))


def of_speeds(vehicle: Vehicle, limits: Vector) -> Vector:
    """Return what a mean may exceed given speeds of a goal by, (d,) [m/s].

    Parameters
    ----------
    vehicle : Vehicle
        Whose goal it is.
    limits : (d,) array
        The speeds, >= 0 [m/s].
    """
    return np.asarray(np.maximum(_SHARE * limits, of_speed(vehicle)))


def of_means(vehicle: Vehicle, means: Matrix) -> Matrix:
    """Return what stated means may differ from the true ones by, (T+1, n).

    Parameters
    ----------
    vehicle : Vehicle
        Its radius counts for positions, what a step adds for velocities.
    means : (T+1, n) array
        The true ones.
    """
    tolerances = _SHARE * np.maximum(1.0, np.abs(means))
    most = np.full(means.shape[1], np.inf)
    system = vehicle.system
    for axes, scale in (
        (system.position, vehicle.radius),
        (system.velocity, _added_speed(vehicle)),
    ):
        if axes is not None:
            rounding = _ROUNDING * np.abs(means[:, list(axes)]).max()
            most[list(axes)] = max(_NOTICED * scale, rounding)
    return np.asarray(np.minimum(tolerances, most))


def of_covariances(vehicle: Vehicle, covariances: Tensor) -> Tensor:
    """Return what stated covariances may differ from the true ones by, (T+1, n, n).

    Parameters
    ----------
    vehicle : Vehicle
        Positions are of one unit, and so are velocities.
    covariances : (T+1, n, n) array
        The true ones.
    """
    deviations = np.sqrt(np.diagonal(covariances, axis1=1, axis2=2).max(axis=0).clip(min=0.0))
    for axes in (vehicle.system.position, vehicle.system.velocity):
        if axes is not None:
            deviations[list(axes)] = deviations[list(axes)].max()
    most = _NOTICED * np.outer(deviations, deviations)
    return np.asarray(np.minimum(_SHARE * np.maximum(1.0, np.abs(covariances)), most))


def of_gain(gain: Matrix) -> Matrix:
    """Return what a stated gain may differ from the true one by, (m, n).

    Parameters
    ----------
    gain : (m, n) array
        The true one: a column is of one unit.
    """
    most = _NOTICED * np.abs(gain).max(axis=0)
    return np.asarray(np.minimum(_SHARE * np.maximum(1.0, np.abs(gain)), most))


def of_cost(scenario: Scenario, cost: float) -> float:
    """Return what a stated cost may differ from the true one by.

    Parameters
    ----------
    scenario : Scenario
        What one step costs at most under all controls counts.
    cost : float
        The true one, >= 0.
    """
    step = scenario.time_weight * scenario.dt
    step += sum(v.cost_weight * float(v.control_limit.sum()) for v in scenario.vehicles)
    return _SHARE * min(max(1.0, cost), max(step, cost))


def _added_speed(vehicle: Vehicle) -> float:
    """Return what a step of all controls adds to the speed at most [m/s]; inf without a speed."""
    if vehicle.system.velocity is None:
        return np.inf
    pushes = np.abs(vehicle.system.B[list(vehicle.system.velocity)]) @ vehicle.control_limit
    added = float(pushes.max())
    return added if added > 0.0 else np.inf
