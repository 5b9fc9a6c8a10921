"""A plan of the whole mission in coarse steps, noise aside: what windows are led by."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import product

import numpy as np

from radmpc.arrays import Matrix
from radmpc.errors import NoPlanError
from radmpc.flying.remainder import changed
from radmpc.model.dynamics import LinearSystem, rollout
from radmpc.model.goal import Goal
from radmpc.model.obstacle import Obstacle
from radmpc.model.plan import Plan
from radmpc.model.relations.goals import places_of
from radmpc.model.relations.keep import Keep
from radmpc.model.scenario import Scenario
from radmpc.model.vehicle import Vehicle
from radmpc.model.visits import steps_of_visits
from radmpc.planners import Branch, Certified, Optimal, Planner
from radmpc.planning import plan
from radmpc.records import dataclass

__all__ = ["CoarsePlan", "coarse_plan"]

_COARSE = 12
"""Coarse steps that a mission is cut into at most [-]: programs of so many are planned in about a
second."""

_CLEARANCES = (2.0, 0.5)
"""Standard deviations by which vehicles are grown in the coarse plan [-], which has no noise: the
second where the first leaves no way."""

_SECONDS = 20.0
"""What one coarse plan may take [s]."""


@dataclass(frozen=True, slots=True, eq=False)
class CoarsePlan:
    """A plan in steps of several of the mission's.

    Attributes
    ----------
    plan : Plan
        In coarse steps; goals that vehicles share are assigned.
    stride : int
        Steps of the mission in a coarse one.
    states : tuple of (T+1, n) array
        Of each vehicle, at the steps of the mission.
    """

    plan: Plan
    stride: int
    states: tuple[Matrix, ...]

    def goals(self, shared: Sequence[Goal]) -> list[Goal]:
        """Return which of the mission's goals vehicles were assigned.

        Parameters
        ----------
        shared : sequence of Goal
            That vehicles share, each for one of them.
        """
        mine = [vehicle.goal for vehicle in self.plan.scenario.vehicles]
        places = places_of([_goal_in_steps(goal, self.stride) for goal in shared], mine)
        return [shared[place] for place in places if place is not None]


def coarse_plan(scenario: Scenario, window: int) -> CoarsePlan:
    """Return a plan of a mission in as coarse steps as there is one.

    Parameters
    ----------
    scenario : Scenario
        The whole mission.
    window : int
        Steps of a window: deviations are those at its end.

    Raises
    ------
    NoPlanError
        If there is none.
    """
    window, most = min(window, scenario.horizon), -(-scenario.horizon // _COARSE)
    strides = [s for s in range(1, 2 * most) if scenario.horizon % s == 0]
    strides = [s for s in reversed(strides) if _has_steps(scenario, s)]
    tries = [(False, *each) for each in product(_CLEARANCES, strides)]
    # Less clearance is a way sooner than more faces are: these come last, where there is most room.
    tries += [(True, _CLEARANCES[-1], stride) for stride in strides]
    for is_persistent, clearance, stride in tries:
        coarse = _coarsened(scenario, stride, (window, clearance))
        record = Planner(Optimal(), Branch(), Certified(is_persistent=is_persistent))
        found = plan(coarse, record, rng=0, time_limit=_SECONDS).plan
        if found is not None:
            states = (
                rollout(v.system, v.start, np.repeat(path.controls, stride, axis=0), v.drift)
                for v, path in zip(scenario.vehicles, found.trajectories, strict=True)
            )
            return CoarsePlan(found, stride, tuple(states))
    longest = max(strides, default=1) * scenario.dt
    raise NoPlanError(
        f"no guide for the mission of {scenario.horizon} steps was found, in steps of up to "
        f"{longest:g} s, {_CLEARANCES[-1]:g} deviations clear of all: there may be no way; if "
        "there is one, give a guide"
    )


def _has_steps(scenario: Scenario, stride: int) -> bool:
    """Whether windows of visits and arrival hold coarse steps, one after the other."""
    horizon = scenario.horizon
    for goal in (*scenario.goals, *(vehicle.goal for vehicle in scenario.vehicles)):
        first, last = _in_steps(goal.window(horizon), stride)
        if first > last:
            return False
    for vehicle in scenario.vehicles:
        coarse = [_in_steps(visit.window(horizon), stride) for visit in vehicle.via]
        visits = [changed(v, between=steps) for v, steps in zip(vehicle.via, coarse, strict=True)]
        if any(first > last for first, last in steps_of_visits(visits, horizon // stride)):
            return False
    return True


def _in_steps(window: tuple[int, int], stride: int) -> tuple[int, int]:
    """Return the coarse steps in a window; the last before the first where there is none."""
    return max(-(-window[0] // stride), 1), window[1] // stride


def _with_windows(vehicle: Vehicle, stride: int, horizon: int) -> Vehicle:
    """Return a vehicle whose visits and arrival are due in coarse steps."""
    via = tuple(replace(v, between=_in_steps(v.window(horizon), stride)) for v in vehicle.via)
    goal = vehicle.goal
    return replace(vehicle, via=via, goal=_goal_in_steps(goal, stride))


def _goal_in_steps(goal: Goal, stride: int) -> Goal:
    """Return a goal with its window in coarse steps."""
    return goal if goal.within is None else replace(goal, within=_in_steps(goal.within, stride))


def _coarsened(scenario: Scenario, stride: int, grown_by: tuple[int, float]) -> Scenario:
    """Return a mission in coarse steps without noise, vehicles grown, ranges narrowed instead."""
    (window, clearance), vehicles = grown_by, []
    for v in scenario.vehicles:
        place = list(v.system.position)
        spread = v.covariances(window)[-1][np.ix_(place, place)]
        grown = v.radius + clearance * float(np.sqrt(np.linalg.eigvalsh(spread)[-1]))
        vehicles.append(
            replace(
                _with_windows(v, stride, scenario.horizon),
                system=_composed(v.system, stride),
                radius=grown,
                gain=None,
                initial_covariance=0.0 * v.initial_covariance,
                disturbance_covariance=0.0 * v.disturbance_covariance,
                disturbance_correlation=0.0,
                measurement=None,
                belief=None,
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
        obstacles=tuple(_every(obstacle, stride, clearance) for obstacle in scenario.obstacles),
        avoidance="intervals" if stride > 1 else scenario.avoidance,
        covariance_samples=None,
        goals=tuple(_goal_in_steps(goal, stride) for goal in scenario.goals),
    )


def _every(obstacle: Obstacle, stride: int, clearance: float) -> Obstacle:
    """Return an obstacle at coarse steps, grown where it may stray instead."""
    if not obstacle.is_moving:
        return obstacle
    spread, outlines = obstacle.spread, []
    for step in range(0, len(obstacle.steps), stride):
        points = np.vstack([piece.vertices for piece in obstacle.at(step)])
        more = clearance * (0.0 if spread is None else spread.deviation(step))
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
