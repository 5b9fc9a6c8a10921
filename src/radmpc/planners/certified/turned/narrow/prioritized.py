"""Prioritized planning on a grid in space and time: each vehicle around those placed before it.

The order decides: a vehicle without a route is put first, and all begin again (Erdmann and
Lozano-Perez 1987). What is found is where vehicles would be at each step; no controls follow it
yet.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np
import numpy.typing as npt

from radmpc.arrays import Matrix, Tensor, Vector
from radmpc.planners.certified.turned.grid import Grid
from radmpc.planners.certified.turned.narrow.tuning import TUNING
from radmpc.program.hazards import Hazards

__all__ = ["prioritized_ticks"]

Places = dict[int, Matrix]
"""Where vehicles are at every tick, (K+1, d) each [m], by their numbers."""


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
    # An order that comes again ends as it did before: two that shut each other out, for example.
    while len(tried) < TUNING.grid_orders and tuple(order) not in tried:
        tried.add(tuple(order))
        placed: Places = {}
        for i in order:
            if is_stopped():
                return {}, ticks
            around = _blocked(hazards, grid, i, placed, ticks * hazards.horizon)
            found = _place(hazards, grid, (starts[i], goals[i]), i, around, is_stopped)
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
    blocked: Tensor,
    is_stopped: Callable[[], bool],
) -> Matrix | None:
    """Return the shortest route of a vehicle around what is blocked, tick by tick."""
    spread = float(np.sqrt(hazards.variances[i].max() / hazards.dimension))
    is_open = grid.distances >= hazards.radii[i] + TUNING.order_sigmas[0] * spread
    start, goal = (grid.nearest(end, is_open) for end in ends)
    if start < 0:
        return None
    moves = _moves(grid.shape)
    cost = np.full(grid.shape, np.inf)
    cost.flat[start] = 0.0
    before = np.zeros((len(blocked), *grid.shape), dtype=np.uint8)
    closed = ~is_open.reshape(grid.shape)
    for tick in range(len(blocked)):
        if is_stopped():
            return None
        best = np.full(grid.shape, np.inf)
        for number, (length, begin, end) in enumerate(moves):
            reached = cost[begin] + length
            is_better = reached < best[end]
            np.copyto(best[end], reached, where=is_better)
            np.copyto(before[tick][end], number, where=is_better)
        best[closed | blocked[tick]] = np.inf
        cost = best
    if not np.isfinite(cost.flat[goal]):
        return None
    return _traced(grid, before, goal)


def _traced(grid: Grid, before: npt.NDArray[np.uint8], goal: int) -> Matrix:
    """Return the points on the way to a goal, from the move that led to each."""
    d = len(grid.shape)
    steps = _steps(d)
    place = np.array(np.unravel_index(goal, grid.shape))
    path = [place]
    for tick in range(len(before) - 1, -1, -1):
        place = place - steps[int(before[tick][tuple(place)])]
        path.append(place)
    numbers = np.ravel_multi_index(tuple(np.array(path[::-1]).T), grid.shape)
    return np.asarray(grid.points[numbers])


def _steps(dimension: int) -> Matrix:
    """Return the moves to a neighboring point, rest first, (m, d)."""
    steps = np.array(list(np.ndindex(*(3,) * dimension))) - 1
    return np.asarray(steps[np.argsort(np.abs(steps).sum(axis=1), kind="stable")])


def _moves(
    shape: tuple[int, ...],
) -> list[tuple[float, tuple[slice, ...], tuple[slice, ...]]]:
    """Return each move's cost in spacings, and from where to where it leads."""
    found = []
    for step in _steps(len(shape)).tolist():
        pairs = list(zip(step, shape, strict=True))
        begin = tuple(slice(max(0, -s), n - max(0, s)) for s, n in pairs)
        end = tuple(slice(max(0, s), n - max(0, -s)) for s, n in pairs)
        found.append((float(np.linalg.norm(step)) or TUNING.wait_cost, begin, end))
    return found


def _blocked(hazards: Hazards, grid: Grid, i: int, placed: Places, count: int) -> Tensor:
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
