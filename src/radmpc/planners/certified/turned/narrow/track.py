"""A route laid out for one vehicle: places on it, speeds along it, and the best pace.

Path-velocity decomposition (Kant and Zucker 1986): the route is given, and dynamic programming over
(place on the route, speed, step) finds the pace. From step to step a vehicle goes straight on
average, so corners fall on steps, or are cut where there is room for it. Speeds are over ground: in
a current they change as those through the water do, which have the limits.
"""

from __future__ import annotations

import math
from collections.abc import Iterable

import numpy as np
import numpy.typing as npt

from radmpc.arrays import Indices, Matrix, Tensor, Vector
from radmpc.planners.certified.turned.narrow.clear import Kept
from radmpc.planners.certified.turned.narrow.displacements import (
    at_ends,
    beyond,
    by_lengths,
    displacement_costs,
)
from radmpc.program.condensed import CondensedModel
from radmpc.program.hazards import Hazards
from radmpc.records import dataclass

__all__ = ["Closeness", "Track", "track"]

_PER_RADIUS = 2.0
"""Places on the route per radius of the vehicle [-]."""

_LEVELS = (4, 16)
"""Fewest and most levels of speed along an axis [-]."""

_MISSED = 500.0
"""Cost of a meter of room that is missed, or by which no speed leads from place to place, in
multiples of what reaching full speed costs [1/m]."""

_MOST = 2e7
"""Places times levels of speed, squared, times steps of a route beyond which there are fewer of
both [-]: 2e7 take 0.2 s. Eight robots in a maze of 128 x 128 cells, whose ways are up to 300 m,
have no plan within 40 s where no pace is sought beyond it, and one after 7 s with fewer places."""

_PARTS = 4
"""Parts into which moves are split by their length [-]: short ones are sampled at few places."""

_TINY = 1e-9
"""Stands for a length or speed of 0 where one divides by it [m, m/s]."""

Closeness = tuple[Indices, Indices, Tensor]
"""Steps and places, (c,) each, where another vehicle is near, and what moves from there cost,
(c, m), by their length in places; inf where the two would touch."""


@dataclass(frozen=True, slots=True, eq=False)
class Track:
    """Places on a route, the speeds along it, and what each move from step to step costs.

    Attributes
    ----------
    vehicle : int
        Whose route it is.
    places : (n, d) array
        Places at even distances [m].
    ends : (v, v, n) int array
        Where a move from a place ends, by the levels of speed at its begin and its end.
    costs : (v, v, n) array
        What it costs; inf where it leads past the end, or where nothing can do it.
    first : int
        The level of speed at the start.
    last : (v,) array
        What it costs to arrive at each level of speed; inf where none is but rest.
    price : float
        Cost of a meter of room that is missed.
    """

    vehicle: int
    places: Matrix
    ends: Indices
    costs: Tensor
    first: int
    last: Vector
    price: float

    @property
    def num_displacements(self) -> int:
        """Lengths that moves may have, in places, rest among them."""
        return 2 * len(self.costs) - 1

    def paced(
        self,
        horizon: int,
        others: Iterable[Closeness],
        crowded: npt.NDArray[np.float32] | None = None,
        *,
        hurry: float = 0.0,
    ) -> tuple[Matrix, float] | None:
        """Return where the vehicle is at each step at the best pace, (T+1, 2) [m], and its cost.

        Parameters
        ----------
        horizon : int
            Steps T.
        others : iterable of Closeness
            What being near each of those costs that are out of the way already.
        crowded : (T, m, n) array or None
            What moves from places cost beside that, by their length.
        hurry : float
            What a step before the goal costs, in multiples of what reaching full speed costs [-].

        Returns
        -------
        tuple of array and float, or None
            None where there is no pace that keeps off them.
        """
        num_levels, _, count = self.costs.shape
        near = np.zeros((horizon, self.num_displacements, count), dtype=np.float32)
        if hurry > 0.0:
            near[:, :, : count - 1] += hurry * self.price / _MISSED
        if crowded is not None:
            near += crowded
        for step, place, lack in others:
            near[step, :, place] += lack
        # Where moves end is a diagonal of these; past the end they cost inf in any case.
        values = np.full(
            (horizon + 1, num_levels, count + self.num_displacements), np.inf, np.float32
        )
        values[-1, :, count - 1] = self.last
        for k in range(horizon - 1, -1, -1):
            worth = self.costs + at_ends(values[k + 1], self.costs.shape)
            if near[k].any():
                worth += by_lengths(near[k], self.costs.shape)
            worth.min(axis=1, out=values[k, :, :count])
        cost = float(values[0, self.first, 0])
        if not np.isfinite(cost):
            return None
        at, speed, path, level = 0, self.first, [0], np.arange(num_levels)
        for k in range(horizon):
            choices = self.costs[speed, :, at] + values[k + 1, level, at + speed + level]
            choices += near[k, speed + level, at]
            speed, before = int(choices.argmin()), speed
            at = int(self.ends[before, speed, at])
            path.append(at)
        return np.asarray(self.places[path]), cost


def track(
    hazards: Hazards, i: int, route: Matrix, kept: Kept, fineness: float = 1.0
) -> Track | None:
    """Lay out a route.

    Parameters
    ----------
    hazards : Hazards
        The fleet.
    i : int
        Whose route it is: that of a double integrator.
    route : (p, d) array
        Its corners, no two in a row at the same place [m].
    kept : Kept
        What it keeps from obstacles.
    fineness : float
        Places on the route, in multiples of the usual number [-].

    Returns
    -------
    Track or None
        None where the route is too long even with few places on it.
    """
    dt, fastest, push = _limits(hazards.models[i])
    current, gust = _drift(hazards.models[i], dt)
    lengths = np.append(0.0, np.cumsum(np.linalg.norm(np.diff(route, axis=0), axis=1)))
    reach = 0.5 * dt * fastest
    usual = float(np.clip(reach * _PER_RADIUS / hazards.radii[i], *_LEVELS)) * fineness
    over_ground = np.sqrt(route.shape[1]) * (fastest + float(np.abs(current).max()))
    for finest in range(math.ceil(usual), _LEVELS[0] - 1, -1):
        along, unit, level = _spread(float(lengths[-1]), finest / reach, (dt, over_ground))
        if along.size * level.size**2 * hazards.horizon <= _MOST:
            break
        if fineness != 1.0:
            return None
    else:
        return None
    count = along.size
    places = np.stack([np.interp(along, lengths, axis) for axis in route.T], axis=1)
    pieces = np.clip(np.searchsorted(lengths, along + _TINY, side="right") - 1, 0, len(route) - 2)
    ahead = np.diff(route, axis=0) / np.diff(lengths)[:, None]
    speeds = unit * level[:, None, None] * ahead[pieces]
    ends = level[:, None, None] + level[None, :, None] + np.arange(count)
    is_never = ends >= count
    ends = np.minimum(ends, count - 1)
    lack = _lack(hazards, i, places, 2 * level.size - 1, kept)
    price = _MISSED * fastest
    costs, changes = displacement_costs(places, speeds, gust, (0.5 * dt, price))
    costs += by_lengths(np.ascontiguousarray(price * lack.T), costs.shape)
    for change, most in zip(changes, push, strict=True):
        is_never |= change > most + 0.5 * unit
    # Speeds are on levels: half of one more or less is left to what follows.
    is_fast = np.abs(speeds - current).max(axis=2) > fastest + 0.1 * unit
    is_never |= is_fast[:, None] | at_ends(beyond(is_fast, 2 * level.size), costs.shape)
    costs[is_never] = np.inf
    start = hazards.models[i].drift_velocity
    first = 0.0 if start is None else float(ahead[0] @ (start[0] + current)) / unit
    first = int(np.clip(round(first), 0, level[-1]))
    last = _arrivals(hazards.models[i], speeds[:, -1], current)
    return Track(i, places, ends, costs.astype(np.float32), first, last, price)


def _spread(
    length: float, density: float, speeds: tuple[float, float]
) -> tuple[Vector, float, Indices]:
    """Return places along a route, and the levels of speed between them.

    Parameters
    ----------
    length : float
        Of the route [m].
    density : float
        Places on it [1/m].
    speeds : tuple of float
        The step [s], and the largest speed over ground [m/s].

    Returns
    -------
    along : (n,) array
        How far along the route the places are [m].
    unit : float
        Speed from one level to the next [m/s].
    level : (v,) int array
        The levels.
    """
    dt, fastest = speeds
    # Speeds at the steps sum to half the route: from rest to rest, only even numbers of places do.
    count = 2 * max(1, round(length * density / 2.0)) + 1
    along = np.linspace(0.0, length, count)
    unit = max(2.0 * float(along[1]) / dt, _TINY)
    num_faster = int(fastest / unit + _TINY)
    # Whoever is faster than that leaves the route, be it as short as of one that stays.
    return along, unit, np.arange(min(num_faster, count - 1) + 1)


def _arrivals(model: CondensedModel, speeds: Matrix, current: Vector) -> Vector:
    """Return what it costs to arrive at speeds over ground, (v, 2), level by level, (v,).

    In still water at rest alone. In a current who rests over ground may be too fast through the
    water for the goal: there the levels are allowed that are nearest to what the goal allows.
    """
    costs = np.full(len(speeds), np.inf)
    costs[0] = 0.0
    allowed = model.vehicle.goal.speed
    if current.any() and allowed is not None:
        excess = np.maximum(np.abs(speeds - current) - allowed, 0.0).sum(axis=1)
        costs = np.where(excess <= excess.min() + _TINY, excess, np.inf)
    return costs


def _drift(model: CondensedModel, dt: float) -> tuple[Vector, Vector]:
    """Return what a drift adds to the speed over ground, and to it from step to step [m/s].

    Half of what a step adds to the speed is in the position already: so half the sum of the speeds
    over ground at both ends is the way of a step, in any drift.
    """
    vehicle, d = model.vehicle, model.vehicle.system.dimension
    if vehicle.drift is None or vehicle.system.rates is None:
        return np.zeros(d), np.zeros(d)
    place, speed = list(vehicle.system.position), list(vehicle.system.rates[0])
    gust = vehicle.drift[speed]
    return vehicle.drift[place] / dt - 0.5 * gust, gust


def _limits(model: CondensedModel) -> tuple[float, float, Vector]:
    """Return the step [s], the largest speed along an axis, and its largest change [m/s]."""
    vehicle = model.vehicle
    rates, system = vehicle.system.rates, vehicle.system
    dt = 1.0 if rates is None else float(rates[1])
    fastest = float(np.abs(np.diff(model.reach_upper, axis=0)).max(initial=0.0)) / dt
    if vehicle.speed_limit is not None:
        fastest = min(fastest, float(np.min(vehicle.speed_limit)))
    most = np.maximum(model.control_bounds.min(axis=0), 0.0)
    return dt, max(fastest, _TINY), np.abs(system.B[list(system.velocity or ())]) @ most


def _lack(hazards: Hazards, i: int, places: Matrix, most: int, kept: Kept) -> Matrix:
    """Return the room that moves from place to place miss, (n, m) [m], by their length."""
    clear, clearance = kept[0].within_borders(float(hazards.radii[i])), kept[1]
    spread = float(np.sqrt(hazards.variances[i].max() / hazards.dimension))
    needed = float(hazards.radii[i]) + clearance * spread
    ends = np.minimum(np.arange(len(places))[:, None] + np.arange(most), len(places) - 1)
    begin = np.broadcast_to(places[:, None], (*ends.shape, places.shape[1]))
    end = places[ends]
    half = 0.5 * np.linalg.norm(end - begin, axis=2)
    # No place of a move is farther from its middle than half of it.
    row, move = np.nonzero(clear.least_at(0.5 * (begin + end)) < needed + half)
    lack = np.zeros(ends.shape)
    for part in np.array_split(np.argsort(move, kind="stable"), _PARTS):
        which = row[part], move[part]
        lack[which] = np.maximum(needed - clear.along(begin[which], end[which]), 0.0)
    return lack
