"""Vehicles that are late for a visit or their goal because of what they have to get around.

No plan is as early as the shortest way around obstacles at full speed: as fast along every axis as
full throttle from the start and the speed limit allow, without slowing down for bends.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from radmpc.arrays import Matrix, Vector
from radmpc.geometry.around import Corners, corners_around
from radmpc.model.relations.concerns import met_by
from radmpc.model.scenario import Scenario
from radmpc.model.vehicle import Vehicle
from radmpc.model.visits import steps_of_visits
from radmpc.planners.reaching.enclosed import at_all_steps
from radmpc.records import dataclass

__all__ = ["Late", "WaysAround", "late_text"]

_ROUNDING = 1e-6
"""Share of a way by which it has to be too long, which no rounding is [-]."""

_MOST_TIMES = 8
"""Multiple of the horizon up to which it is told when a vehicle is there at best [-]."""


@dataclass(frozen=True, slots=True)
class Late:
    """What a vehicle is late for.

    Attributes
    ----------
    visit : int or None
        The visit; None is the goal.
    due : int
        Last step at which it has to be there.
    least : int or None
        Steps that it takes at least; None beyond eight horizons.
    is_horizon : bool
        Whether it is due at the horizon, rather than at the end of a window.
    """

    visit: int | None
    due: int
    least: int | None
    is_horizon: bool


class WaysAround:
    """Ways around what stands still in a scenario; vehicles alike share them.

    Parameters
    ----------
    scenario : Scenario
        The scenario.
    """

    def __init__(self, scenario: Scenario) -> None:
        self._scenario = scenario
        self._known: dict[tuple[float, tuple[str, ...]], Corners | None] = {}

    def late(self, vehicle: Vehicle, bounds: Matrix) -> Late | None:
        """Return the first that a vehicle is late for, whatever it does.

        Parameters
        ----------
        vehicle : Vehicle
            Of the scenario.
        bounds : (T, m) array
            Largest control at each step.

        Returns
        -------
        Late or None
            None where it may be in time, or nothing is known: of dynamics other than a double
            integrator, in space, and at steps, between which vehicles pass through walls.
        """
        scenario = self._scenario
        speeds = _speeds(vehicle, bounds, scenario.dt)
        if scenario.dimension != 2 or scenario.avoidance != "intervals" or speeds is None:
            return None
        fastest = speeds.max(axis=0)
        if not fastest.min() > 0.0:
            return None
        corners = self._corners(vehicle)
        times = None if corners is None else self._times(vehicle, corners, fastest)
        if times is None:
            return None
        paces = (speeds / fastest).max(axis=1)
        gone = np.concatenate([[0.0], np.cumsum(0.5 * scenario.dt * (paces[:-1] + paces[1:]))])
        begun, left = 0, 0.0
        for (visit, first, last), time in zip(self._due(vehicle), times, strict=True):
            left = gone[begun] + time * (1.0 - _ROUNDING)
            there = int(np.searchsorted(gone, left))
            begun = max(there, first)
            if begun > last:
                least = begun if begun < len(gone) else None
                return Late(visit, last, least, visit is None and last == scenario.horizon)
        return None

    def _due(self, vehicle: Vehicle) -> Iterator[tuple[int | None, int, int]]:
        """Yield each visit, and the goal, with the first and the last step for it."""
        horizon = self._scenario.horizon
        for j, (first, last) in enumerate(steps_of_visits(vehicle.via, horizon)):
            yield j, first, last
        yield None, 1, vehicle.goal.window(horizon)[1]

    def _times(self, vehicle: Vehicle, corners: Corners, fastest: Vector) -> Vector | None:
        """Return the least time of each leg [s]; None where boxes are beside obstacles."""
        boxes = [(vehicle.start_position, vehicle.start_position)]
        boxes += [(visit.lower, visit.upper) for visit in vehicle.via]
        boxes.append((vehicle.goal.lower, vehicle.goal.upper))
        border = self._scenario.workspace
        if border is not None:
            boxes = [(np.maximum(a, border.lower), np.minimum(b, border.upper)) for a, b in boxes]
        low, high = np.array([a for a, _ in boxes]), np.array([b for _, b in boxes])
        if np.any(low > high) or any(_meets(corners, a, b) for a, b in boxes):
            return None
        # From wherever in a box to its middle there is a straight way.
        aside = (0.5 * (high - low) / fastest).max(axis=1)
        times = corners.times(0.5 * (low + high), fastest)
        return np.maximum(times - aside[:-1] - aside[1:], 0.0) if np.isfinite(times).all() else None

    def _corners(self, vehicle: Vehicle) -> Corners | None:
        """Return the corners of what a vehicle meets; None without any, or with too many."""
        met = met_by(self._scenario.obstacles, vehicle.name)
        key = (vehicle.radius, tuple(obstacle.name for obstacle in met))
        if key not in self._known:
            pieces = [piece for obstacle in met for piece in at_all_steps(obstacle)]
            border = self._scenario.workspace
            box = None if border is None else (border.lower, border.upper)
            self._known[key] = corners_around(pieces, vehicle.radius, box) if pieces else None
        return self._known[key]


def late_text(scenario: Scenario, late: Late) -> str:
    """Say what a vehicle is late for.

    Parameters
    ----------
    scenario : Scenario
        Whose step counts.
    late : Late
        What it is late for.

    Returns
    -------
    str
        What follows the vehicle's name, without a full stop.
    """
    where = "at its goal" if late.visit is None else f"in the box of its visit via[{late.visit}]"
    due = f"by step {late.due} ({late.due * scenario.dt:g} s)"
    if not late.is_horizon:
        due += ", the end of its window"
    if late.least is None:
        best = f"more than {_MOST_TIMES * scenario.horizon} steps"
    else:
        best = f"{late.least} steps ({late.least * scenario.dt:g} s) at least"
    return f"cannot be {where} {due}: around obstacles that takes {best}, at full speed all the way"


def _speeds(vehicle: Vehicle, bounds: Matrix, dt: float) -> Matrix | None:
    """Return the largest speed along each axis at steps of many horizons, (n+1, d) [m/s]."""
    rates = vehicle.system.rates
    if rates is None or vehicle.drift is not None or vehicle.pushes(1) is not None:
        return None
    velocity = list(rates[0])
    limit = np.full(len(velocity), np.inf)
    if vehicle.speed_limit is not None and vehicle.system.velocity == rates[0]:
        limit = vehicle.speed_limit
    pushes = np.maximum(bounds, 0.0) @ np.abs(vehicle.system.B[velocity]).T
    # Beyond the horizon, where nothing is proven of, as much control as ever is left.
    later = np.tile(pushes.max(axis=0), ((_MOST_TIMES - 1) * len(bounds), 1))
    speeds = np.abs(vehicle.start[velocity]) + np.cumsum(np.vstack([pushes, later]), axis=0)
    first = np.abs(vehicle.start[velocity])[None]
    return np.vstack([first, np.minimum(speeds, limit)])


def _meets(corners: Corners, low: Vector, high: Vector) -> bool:
    """Whether a box comes near any grown piece."""
    places = np.array([low, high, [low[0], high[1]], [high[0], low[1]]])
    for piece in corners.grown:
        is_beyond = (places @ piece.normals.T - piece.offsets > 0.0).all(axis=0).any()
        near, far = piece.vertices.min(axis=0), piece.vertices.max(axis=0)
        if not is_beyond and np.all((low <= far) & (high >= near)):
            return True
    return False
