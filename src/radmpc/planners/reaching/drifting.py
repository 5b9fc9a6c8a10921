"""Drifts that are faster or stronger than a vehicle: they carry it off, whatever it does."""

from __future__ import annotations

import numpy as np

from radmpc.model.vehicle import Vehicle

__all__ = ["strong_drift_text"]


def strong_drift_text(vehicle: Vehicle, dt: float, horizon: int) -> str | None:
    """Return which drift carries a vehicle off its goal against all of its speed or control.

    Parameters
    ----------
    vehicle : Vehicle
        The vehicle.
    dt : float
        Step [s].
    horizon : int
        Number of steps T.

    Returns
    -------
    str or None
        A clause without a full stop; None where no drift does.
    """
    if vehicle.drift is None:
        return None
    return _strong_push_text(vehicle, horizon) or _fast_drift_text(vehicle, dt, horizon)


def _fast_drift_text(vehicle: Vehicle, dt: float, horizon: int) -> str | None:
    """Return which current carries a vehicle past its goal against all of its speed."""
    if vehicle.drift is None or vehicle.speed_limit is None or vehicle.system.velocity is None:
        return None
    rates = vehicle.drift[list(vehicle.system.position)] / dt
    limit, start, goal = vehicle.speed_limit, vehicle.start_position, vehicle.goal
    due = goal.window(horizon)[1] * dt
    for axis, rate in enumerate(rates.tolist()):
        carried = start[axis] + np.sign(rate) * (abs(rate) - limit[axis]) * due
        is_past = carried > goal.upper[axis] if rate > 0.0 else carried < goal.lower[axis]
        if abs(rate) > limit[axis] and is_past:
            along = _along(axis, len(rates))
            return f"the drift of {rate:.3g} m/s {along} is faster than speed_limit {limit[axis]:g}"
    return None


def _strong_push_text(vehicle: Vehicle, horizon: int) -> str | None:
    """Return which push is stronger than all control, and too fast for a goal or past it."""
    rates, drift, goal = vehicle.system.rates, vehicle.drift, vehicle.goal
    if rates is None or drift is None:
        return None
    velocity, dt = list(rates[0]), rates[1]
    pushes = drift[velocity] / dt
    signs = np.sign(pushes)
    net = np.abs(pushes) - np.abs(vehicle.system.B[velocity]) @ vehicle.control_limit / dt
    due = goal.window(horizon)[1] * dt
    speeds = signs * vehicle.start[velocity] + net * due
    most = np.full(len(velocity), np.inf)
    for allowed in (vehicle.speed_limit, goal.speed):
        if allowed is not None and vehicle.system.velocity is not None:
            most = np.minimum(most, allowed)
    # A push moves the position from the next step on, a control within its own.
    currents = signs * drift[list(vehicle.system.position)] / dt
    carried = (signs * vehicle.start[velocity] + currents) * due + 0.5 * net * due**2
    carried -= 0.5 * np.abs(pushes) * dt * due
    ahead = np.where(signs > 0.0, goal.upper, -goal.lower) - signs * vehicle.start_position
    is_off = (net > 0.0) & ((speeds > most) | (carried > ahead))
    for axis in np.flatnonzero(is_off).tolist():
        along = _along(axis, len(velocity))
        push = f"the push of {pushes[axis]:.3g} m/s² by drift {along}"
        return f"{push} is stronger than its control"
    return None


def _along(axis: int, count: int) -> str:
    """Name an axis."""
    return f"along {'xyz'[axis]}" if count <= len("xyz") else f"on axis {axis}"
