"""Where vehicles are to be at the ends of windows: a plan of the whole mission in coarse steps."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from radmpc.arrays import Matrix, Vector
from radmpc.errors import NoPlanError
from radmpc.flying.remainder import changed, later
from radmpc.model.dynamics import LinearSystem, rollout
from radmpc.model.goal import Goal
from radmpc.model.obstacle import MovingShape
from radmpc.model.relations.keep import Keep
from radmpc.model.scenario import Scenario
from radmpc.model.vehicle import Vehicle
from radmpc.planning import plan

__all__ = ["Guide", "coarse_guide", "window_of"]

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


def window_of(
    scenario: Scenario, step: int, window: int, states: Sequence[Vector] | None, guide: Guide
) -> Scenario:
    """Return the steps of a mission from one on, as many as a window has.

    Parameters
    ----------
    scenario : Scenario
        The whole mission.
    step : int
        Where the window begins.
    window : int
        Its steps; fewer at the end of the mission.
    states : sequence of (n,) array or None
        Measured there; None at step 0, before anything is measured.
    guide : callable
        Where it ends.
    """
    end = min(step + window, scenario.horizon)
    vehicles = tuple(
        changed(
            v,
            goal=goal,
            start=v.start if states is None else states[i],
            initial_covariance=(0.0 if states is not None else 1.0) * v.initial_covariance,
        )
        for i, (v, goal) in enumerate(zip(scenario.vehicles, guide(end), strict=True))
    )
    obstacles = []
    for obstacle in scenario.obstacles:
        moved = later(obstacle, step)
        if isinstance(moved.shape, MovingShape):
            shape = MovingShape(moved.shape.outlines[: end - step + 1])
            moved = replace(moved, shape=shape, steps=moved.steps[: end - step + 1])
        obstacles.append(moved)
    return changed(scenario, horizon=end - step, vehicles=vehicles, obstacles=tuple(obstacles))


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
                drift=None if v.drift is None else _summed(v.system.A, stride) @ v.drift,
            )
        )
    obstacles = []
    for obstacle in scenario.obstacles:
        if isinstance(obstacle.shape, MovingShape):
            shape = MovingShape(obstacle.shape.outlines[::stride])
            obstacle = replace(obstacle, shape=shape, steps=obstacle.steps[::stride])  # noqa: PLW2901 - the coarse one
        obstacles.append(obstacle)
    more = {v.name: w.radius - v.radius for v, w in zip(scenario.vehicles, vehicles, strict=True)}
    return replace(
        scenario,
        keep=tuple(_narrowed(kept, more) for kept in scenario.keep),
        dt=scenario.dt * stride,
        horizon=scenario.horizon // stride,
        vehicles=tuple(vehicles),
        obstacles=tuple(obstacles),
        avoidance="intervals" if stride > 1 else scenario.avoidance,
    )


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
