"""Drifts that are faster than a vehicle: they carry it past its goal, whatever it does."""

from __future__ import annotations

import numpy as np

from radmpc.model.vehicle import Vehicle

__all__ = ["strong_drift_text"]


def strong_drift_text(vehicle: Vehicle, dt: float, horizon: int) -> str | None:
    """Return which drift carries a vehicle past its goal against all of its speed.

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
    if vehicle.drift is None or vehicle.speed_limit is None or vehicle.system.velocity is None:
        return None
    rates = vehicle.drift[list(vehicle.system.position)] / dt
    limit, start, goal = vehicle.speed_limit, vehicle.start_position, vehicle.goal
    due = goal.window(horizon)[1] * dt
    for axis, rate in enumerate(rates.tolist()):
        carried = start[axis] + np.sign(rate) * (abs(rate) - limit[axis]) * due
        is_past = carried > goal.upper[axis] if rate > 0.0 else carried < goal.lower[axis]
        if abs(rate) > limit[axis] and is_past:
            along = f"along {'xyz'[axis]}" if len(rates) <= len("xyz") else f"on axis {axis}"
            return f"the drift of {rate:.3g} m/s {along} is faster than speed_limit {limit[axis]:g}"
    return None
