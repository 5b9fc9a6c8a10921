"""Where a vehicle can be at each step: boxes from its start, its goal, and full throttle."""

from __future__ import annotations

import numpy as np

from radmpc.arrays import Matrix, Tensor, Vector
from radmpc.model.vehicle import Vehicle

__all__ = ["reach_by_boxes", "reach_by_speeds"]

_STEPS = 128
"""Steps whose positions are bounded at once [-]: they stay in the processor's cache."""


def reach_by_boxes(
    vehicle: Vehicle, position: Tensor, drift: Matrix, bounds: Vector
) -> tuple[Matrix, Matrix]:
    """Bound positions from the start forward and from the goal backward, any dynamics.

    Parameters
    ----------
    vehicle : Vehicle
        With its goal.
    position : (T+1, d, T m) array
        What positions owe to controls.
    drift : (T+1, d) array
        Positions without control [m].
    bounds : (T m,) array
        Largest nominal |ū|.

    Returns
    -------
    lower, upper : (T+1, d) array
        Corners of a box at each step [m].
    """
    spread, to_goal = np.empty_like(drift), np.empty_like(drift)
    # All steps at once would need twice the memory of the positions, of which every page is new.
    for first in range(0, len(position), _STEPS):
        here = slice(first, first + _STEPS)
        spread[here] = np.abs(position[here]) @ bounds
        to_goal[here] = np.abs(position[-1] - position[here]) @ bounds
    still = drift[-1] - drift
    lower = np.maximum(drift - spread, vehicle.goal.lower - still - to_goal)
    upper = np.minimum(drift + spread, vehicle.goal.upper - still + to_goal)
    return lower, upper


def reach_by_speeds(
    vehicle: Vehicle, rates: tuple[tuple[int, ...], float], start: Vector, bounds: Matrix
) -> tuple[Matrix, Matrix]:
    """Bound a double integrator's positions by full throttle from both ends, speed limits held.

    Parameters
    ----------
    vehicle : Vehicle
        With its goal and limits.
    rates : (tuple of int, float)
        States that are velocities, axis by axis, and the step [s].
    start : (n,) array
        Mean state at the first step.
    bounds : (T, m) array
        Largest nominal |ū|.

    Returns
    -------
    lower, upper : (T+1, d) array
        Corners of a box at each step [m].
    """
    system = vehicle.system
    d, horizon = system.dimension, len(bounds)
    velocity, dt = list(rates[0]), rates[1]
    place, speed = start[list(system.position)], start[velocity]
    # The speed limits hold the velocities that the vehicle names, in whatever order.
    is_named = system.velocity == rates[0]
    limit = np.full(d, np.inf)
    if vehicle.speed_limit is not None and is_named:
        limit = vehicle.speed_limit
    goal_speed = limit
    if vehicle.goal.speed is not None and is_named:
        goal_speed = np.minimum(vehicle.goal.speed, limit)
    pushes = bounds @ np.abs(system.B[velocity]).T / dt
    if vehicle.drift is None:
        # Seen backwards in time the vehicle leaves its goal at most at the goal speed.
        far = _full_throttle(
            np.concatenate([speed, -speed, goal_speed]),
            np.hstack([pushes, pushes, pushes[::-1]]),
            np.tile(limit, 3),
            dt,
        )
        forward_up, forward_down, back = np.hsplit(far, 3)
        backward_up = backward_down = back[::-1]
    else:
        # Positions gain the mean of both velocities times dt, and what drift adds beyond its share
        # in that mean.
        gust = vehicle.drift[velocity] / dt
        shift = vehicle.drift[list(system.position)] - 0.5 * dt**2 * gust
        carried = np.arange(horizon + 1)[:, None] * shift
        forward_up = _full_throttle(speed, pushes + gust, limit, dt) + carried
        forward_down = _full_throttle(-speed, pushes - gust, limit, dt) - carried
        back = pushes[::-1]
        backward_up = (_full_throttle(goal_speed, back + gust, limit, dt) - carried)[::-1]
        backward_down = (_full_throttle(goal_speed, back - gust, limit, dt) + carried)[::-1]
    lower = np.maximum(place - forward_down, vehicle.goal.lower - backward_down)
    upper = np.minimum(place + forward_up, vehicle.goal.upper + backward_up)
    return lower.reshape(horizon + 1, d), upper.reshape(horizon + 1, d)


def _full_throttle(speed: Vector, bounds: Matrix, limit: Vector, dt: float) -> Matrix:
    """Return how far each axis gets at most by each step, (T+1, d) [m]."""
    speeds = [speed]
    for bound in bounds:
        speeds.append(np.minimum(speeds[-1] + dt * bound, limit))
    pace = np.array(speeds)
    distance = np.zeros_like(pace)
    np.cumsum(0.5 * dt * (pace[:-1] + pace[1:]), axis=0, out=distance[1:])
    return distance
