"""Prioritized planning on a grid in space and time: each vehicle around those placed before it.

The order decides: a vehicle without a route is put first, and all begin again (Erdmann and
Lozano-Perez 1987). What is found is where vehicles would be at each step; no controls follow it
yet.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np
import numpy.typing as npt

from radmpc.arrays import Indices, Matrix, Vector
from radmpc.planners.certified.turned.grid import Grid
from radmpc.planners.certified.turned.narrow.tuning import TUNING
from radmpc.program.hazards import Hazards

__all__ = ["prioritized_ticks"]

Flags = npt.NDArray[np.bool_]
"""Whether something is so, at points of the grid."""

Places = dict[int, Matrix]
"""Where vehicles are at every tick, (K+1, d) each [m], by their numbers."""

_EVERY, _MOST_KEPT = 16, 4_000_000
"""Ticks after which costs are kept to trace a route by [-], those between are computed again; and
costs up to which all are kept [-]: 32 MB."""


def prioritized_ticks(
    hazards: Hazards, is_stopped: Callable[[], bool], above: int = 0
) -> tuple[Mapping[int, Matrix], int]:
    """Return where all vehicles would be at every tick, none within reach of another.

    Parameters
    ----------
    hazards : Hazards
        The fleet; obstacles that move are left out.
    is_stopped : callable
        Returns True once it is time to stop.
    above : int
        Ticks per step at which none were found, for routes at full speed; 0 for the usual pace.

    Returns
    -------
    mapping of int to (K+1, d) array
        Positions [m], in the order in which vehicles were placed; empty where no order of those
        tried leads to any.
    int
        Ticks per step, K/T.
    """
    grid = Grid.of(hazards)
    pace = 1.0 if above else TUNING.grid_pace
    ticks = max(1, int(pace * float(hazards.reaches.min()) / grid.spacing))
    work = hazards.count * ticks * hazards.horizon * len(grid.points)
    if ticks <= above or work > TUNING.grid_work:
        return {}, ticks
    starts = np.array([model.drift_position[0] for model in hazards.models])
    goals = np.array([0.5 * (m.vehicle.goal.lower + m.vehicle.goal.upper) for m in hazards.models])
    order = np.argsort(-np.linalg.norm(goals - starts, axis=1), kind="stable").tolist()
    tried: set[tuple[int, ...]] = set()
    known: dict[tuple[int, ...], Matrix | None] = {}
    # An order that comes again ends as it did before: two that shut each other out, for example.
    while len(tried) < TUNING.grid_orders and tuple(order) not in tried:
        tried.add(tuple(order))
        placed: Places = {}
        for i in order:
            if is_stopped():
                return {}, ticks
            after = *placed, i
            if after not in known:
                around = _blocked(hazards, grid, i, placed, ticks * hazards.horizon)
                known[after] = _place(hazards, grid, (starts[i], goals[i]), i, around, is_stopped)
            found = known[after]
            if found is None:
                order.remove(i)
                order.insert(0, i)
                break
            placed[i] = found
        else:
            return placed, ticks
    return {}, ticks


def _place(
    hazards: Hazards,
    grid: Grid,
    ends: tuple[Vector, Vector],
    i: int,
    blocked: Flags,
    is_stopped: Callable[[], bool],
) -> Matrix | None:
    """Return the shortest route of a vehicle around what is blocked, tick by tick."""
    spread = float(np.sqrt(hazards.variances[i].max() / hazards.dimension))
    is_open = grid.distances >= hazards.radii[i] + TUNING.order_sigmas[0] * spread
    start, goal = (grid.nearest(end, is_open) for end in ends)
    if start < 0:
        return None
    costs = _Costs(grid.shape, ~is_open.reshape(grid.shape), blocked)
    cost, kept = costs.at(start), []
    for tick in range(len(blocked)):
        if is_stopped():
            return None
        if tick % costs.every == 0:
            kept.append(cost)
        cost = costs.after(cost, tick)
    if not np.isfinite(cost[costs.number(goal)]):
        return None
    return np.asarray(grid.points[costs.traced(kept, goal)])


class _Costs:
    """What it takes to be at the points of a grid, tick by tick.

    Arrays are flat, with a border that nobody enters: each move is then a shift of all points.

    Parameters
    ----------
    shape : tuple of int
        Of the grid.
    closed : bool array of that shape
        Where the vehicle never is.
    blocked : (K, ...) bool array
        Where it is not after each tick.

    Attributes
    ----------
    every : int
        Ticks after which costs are to be kept for `traced` [-].
    """

    def __init__(self, shape: tuple[int, ...], closed: Flags, blocked: Flags) -> None:
        self._shape, self._padded = shape, tuple(n + 2 for n in shape)
        self._size = int(np.prod(self._padded))
        self.every = 1 if len(blocked) * self._size <= _MOST_KEPT else _EVERY
        strides = np.append(np.cumprod(self._padded[:0:-1])[::-1], 1)
        steps = _steps(len(shape))
        self._shifts = (steps @ strides).astype(np.int64)
        self._lengths = np.linalg.norm(steps, axis=1)
        self._lengths[0] = TUNING.wait_cost
        edge = int(strides.sum())
        self._inner = slice(edge, self._size - edge)
        self._moves: dict[float, list[slice]] = {}
        for shift, length in zip(self._shifts.tolist(), self._lengths.tolist(), strict=True):
            there = slice(edge + shift, self._size - edge + shift)
            self._moves.setdefault(length, []).append(there)
        self._shut = np.ones((len(blocked), *self._padded), dtype=bool)
        self._shut[(slice(None), *(slice(1, -1),) * len(shape))] = closed | blocked
        self._shut = self._shut.reshape(len(blocked), self._size)

    def at(self, start: int) -> Vector:
        """Return the costs at first, of being at a point of the grid and nowhere else."""
        costs = np.full(self._size, np.inf)
        costs[self.number(start)] = 0.0
        return costs

    def number(self, point: int) -> int:
        """Return where a point of the grid is in these arrays."""
        place = [index + 1 for index in np.unravel_index(point, self._shape)]
        return int(np.ravel_multi_index(place, self._padded))

    def after(self, costs: Vector, tick: int) -> Vector:
        """Return the costs one tick later."""
        found = np.full(self._size, np.inf)
        best = found[self._inner]
        among = np.empty_like(best)
        for length, there in self._moves.items():
            np.copyto(among, costs[there[0]])
            for each in there[1:]:
                np.minimum(among, costs[each], out=among)
            among += length
            np.minimum(best, among, out=best)
        np.putmask(found, self._shut[tick], np.inf)
        return found

    def traced(self, kept: list[Vector], goal: int) -> Indices:
        """Return the points on the way to a goal, given the costs at every so many ticks."""
        place = self.number(goal)
        path = [place]
        for number in range(len(kept) - 1, -1, -1):
            costs, first = [kept[number]], number * self.every
            for tick in range(first, min(first + self.every, len(self._shut)) - 1):
                costs.append(self.after(costs[-1], tick))
            for cost in reversed(costs):
                before = place - self._shifts
                place = int(before[np.argmin(cost[before] + self._lengths)])
                path.append(place)
        places = np.unravel_index(path[::-1], self._padded)
        return np.ravel_multi_index([along - 1 for along in places], self._shape)


def _steps(dimension: int) -> Matrix:
    """Return the moves to a neighboring point, rest first, (m, d)."""
    steps = np.array(list(np.ndindex(*(3,) * dimension))) - 1
    return np.asarray(steps[np.argsort(np.abs(steps).sum(axis=1), kind="stable")])


def _blocked(hazards: Hazards, grid: Grid, i: int, placed: Places, count: int) -> Flags:
    """Return where a vehicle would be too near to one placed before, after each tick, (K, ...)."""
    blocked = np.zeros((count, *grid.shape), dtype=bool)
    for j, path in placed.items():
        variance = hazards.variances[i].max() + hazards.variances[j].max()
        apart = hazards.radii[i] + hazards.radii[j]
        apart += TUNING.order_sigmas[1] * float(np.sqrt(variance / hazards.dimension))
        # Vehicles are on points of the grid: what is too near is the same around each.
        reach = apart / grid.spacing
        size = int(reach)
        square = np.ogrid[(slice(-size, size + 1),) * len(grid.shape)]
        ball = sum(np.square(along) for along in square) < reach**2
        cells = np.rint((path[1:] - grid.points[0]) / grid.spacing).astype(np.int64)
        lower = np.maximum(cells - size, 0)
        upper = np.minimum(cells + size + 1, grid.shape)
        skipped = lower - (cells - size)
        for place, low, high, skip in zip(blocked, lower, upper, skipped, strict=True):
            there = tuple(map(slice, low, high))
            place[there] |= ball[tuple(map(slice, skip, skip + high - low))]
    return blocked
