"""Where vehicles are to be at the ends of windows: a plan of the whole mission in coarse steps."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from itertools import product

import numpy as np

from radmpc.arrays import Matrix, Vector
from radmpc.errors import NoPlanError
from radmpc.flying.remainder import changed
from radmpc.model.dynamics import LinearSystem, rollout
from radmpc.model.goal import Goal
from radmpc.model.obstacle import MovingShape, Obstacle
from radmpc.model.relations.keep import Keep
from radmpc.model.scenario import Scenario
from radmpc.model.vehicle import Vehicle
from radmpc.planning import plan

__all__ = ["Guide", "coarse_guide", "until"]

Guide = Callable[[int], Sequence[Goal]]
"""From a step of the mission to where every vehicle is to be by then."""

_COARSE = 12
"""Coarse steps that a mission is cut into at most [-]: programs of so many are planned in about a
second."""

_CLEARANCE = 2.0
"""Standard deviations by which vehicles are grown in the coarse plan [-], which has no noise."""

_SECONDS = 20.0
"""What one coarse plan may take [s]."""

_EASE = 1.05
"""What a window may be faster than the guide at its end [-]: paths deviate from it."""


def coarse_guide(scenario: Scenario, window: int) -> Guide:
    """Return a guide along a plan in coarse steps, noise aside.

    Parameters
    ----------
    scenario : Scenario
        The whole mission.
    window : int
        Steps of a window: deviations are those at its end.

    Returns
    -------
    callable
        A step's goals: boxes of the vehicle's radius around the guide, its speed there.

    Raises
    ------
    NoPlanError
        If there is no coarse plan.
    """
    paths = _coarse_paths(scenario, min(window, scenario.horizon))

    def goals(step: int) -> list[Goal]:
        if step >= scenario.horizon:
            return [v.goal for v in scenario.vehicles]
        pairs = zip(scenario.vehicles, paths, strict=True)
        return [_goal_at(vehicle, path[step]) for vehicle, path in pairs]

    return goals


def _coarse_paths(scenario: Scenario, window: int) -> list[Matrix]:
    """Return the states at all steps of a plan in as coarse steps as there is one."""
    most = -(-scenario.horizon // _COARSE)
    strides = [s for s in range(1, 2 * most) if scenario.horizon % s == 0]
    for stride in reversed(strides):
        found = plan(_coarsened(scenario, stride, window), rng=0, time_limit=_SECONDS).plan
        if found is not None:
            return [
                rollout(v.system, v.start, np.repeat(path.controls, stride, axis=0), v.drift)
                for v, path in zip(scenario.vehicles, found.trajectories, strict=True)
            ]
    raise NoPlanError(
        f"no guide for the mission of {scenario.horizon} steps was found in steps of "
        f"{most * scenario.dt:g} s or less; give one"
    )


def until(scenario: Scenario, end: int, guide: Guide) -> Scenario:
    """Return a mission up to a step, toward where the guide leads there.

    Parameters
    ----------
    scenario : Scenario
        The whole mission.
    end : int
        The last step, at most its horizon.
    guide : callable
        Where vehicles are to be by then.
    """
    pairs = zip(scenario.vehicles, guide(end), strict=True)
    vehicles = tuple(changed(vehicle, goal=goal) for vehicle, goal in pairs)
    obstacles = tuple(_until(obstacle, end) for obstacle in scenario.obstacles)
    return changed(scenario, horizon=end, vehicles=vehicles, obstacles=obstacles)


def _until(obstacle: Obstacle, end: int) -> Obstacle:
    """Return an obstacle as far as a step."""
    if not obstacle.is_moving:
        return obstacle
    shape, spread = obstacle.shape, obstacle.spread
    if isinstance(shape, MovingShape):
        shape = MovingShape(shape.outlines[: end + 1])
    if spread is not None:
        spread = spread.since(0, end)
    return changed(obstacle, shape=shape, spread=spread, steps=obstacle.steps[: end + 1])


def _coarsened(scenario: Scenario, stride: int, window: int) -> Scenario:
    """Return a mission in coarse steps without noise, vehicles grown, ranges narrowed instead."""
    vehicles = []
    for v in scenario.vehicles:
        place = list(v.system.position)
        spread = v.covariances(window)[-1][np.ix_(place, place)]
        grown = v.radius + _CLEARANCE * float(np.sqrt(np.linalg.eigvalsh(spread)[-1]))
        vehicles.append(
            replace(
                v,
                system=_composed(v.system, stride),
                radius=grown,
                gain=None,
                initial_covariance=0.0 * v.initial_covariance,
                disturbance_covariance=0.0 * v.disturbance_covariance,
                disturbance_correlation=0.0,
                measurement=None,
                shared=(),
                drift=None if v.drift is None else _summed(v.system.A, stride) @ v.drift,
            )
        )
    more = {v.name: w.radius - v.radius for v, w in zip(scenario.vehicles, vehicles, strict=True)}
    return replace(
        scenario,
        keep=tuple(_narrowed(kept, more) for kept in scenario.keep),
        dt=scenario.dt * stride,
        horizon=scenario.horizon // stride,
        vehicles=tuple(vehicles),
        obstacles=tuple(_every(obstacle, stride) for obstacle in scenario.obstacles),
        avoidance="intervals" if stride > 1 else scenario.avoidance,
        covariance_samples=None,
    )


def _every(obstacle: Obstacle, stride: int) -> Obstacle:
    """Return an obstacle at coarse steps, grown where it may stray instead."""
    if not obstacle.is_moving:
        return obstacle
    spread, outlines = obstacle.spread, []
    for step in range(0, len(obstacle.steps), stride):
        points = np.vstack([piece.vertices for piece in obstacle.at(step)])
        more = _CLEARANCE * (0.0 if spread is None else spread.deviation(step))
        corners = more * np.array(list(product((-1.0, 1.0), repeat=obstacle.dimension)))
        outlines.append((points[:, None] + corners).reshape(-1, obstacle.dimension))
    return replace(Obstacle.moving(obstacle.name, outlines), concerns=obstacle.concerns)


def _narrowed(kept: Keep, more: dict[str, float]) -> Keep:
    """Return a range less what both vehicles were grown by, at least half of it."""
    lost = sum(more[name] for name in kept.vehicles)
    return replace(kept, within=max(kept.within - lost, 0.5 * kept.within))


def _composed(system: LinearSystem, stride: int) -> LinearSystem:
    """Return what a control held over several steps does in all of them."""
    A = np.linalg.matrix_power(system.A, stride)
    return LinearSystem(A, _summed(system.A, stride) @ system.B, system.position, system.velocity)


def _summed(A: Matrix, stride: int) -> Matrix:
    """Return ``I + A + … + A^(stride − 1)``."""
    powers = [np.linalg.matrix_power(A, k) for k in range(stride)]
    return np.asarray(np.sum(powers, axis=0))


def _goal_at(vehicle: Vehicle, state: Vector) -> Goal:
    """Return a goal around a state on the way."""
    system = vehicle.system
    speed = None
    if system.velocity is not None:
        speed = _EASE * np.abs(state[list(system.velocity)]) + 1e-3
        if vehicle.speed_limit is not None:
            speed = np.minimum(speed, vehicle.speed_limit)
    return Goal.at(state[list(system.position)], 0.5 * vehicle.radius, speed)
