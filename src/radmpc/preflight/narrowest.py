"""The narrowest place that a vehicle must pass: what clearance the roomiest path in time leaves.

The clearance in standard deviations is the smaller of two over every path, and the path is chosen:
``W⁺(x) = min(c(x), max W(y))`` over the cells y that the vehicle may come from, from tick to tick.
What W is at the goal in the end, no path exceeds but for the grid's sake.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from radmpc.arrays import Matrix, Vector
from radmpc.preflight.distances import Side, Surroundings
from radmpc.preflight.grid import Field, Grid, Walls, grid_of
from radmpc.preflight.places import Narrowest, Passage, Traveler

__all__ = ["narrowest_place"]

_ACROSS = 33
"""Places across a gap at which it is measured [-]."""

_AWAY = (0.25, 0.5, 0.75, 1.0)
"""Shares of half a cell by which its best place is looked for [-]."""

_ALONG = 9
"""Places along each side of a goal at which its clearance is measured [-]."""

_World = tuple[Field, Walls]
"""Clearances of all cells, and which of them are beside each other."""


def narrowest_place(traveler: Traveler, work: float) -> Narrowest | Passage:
    """Return the narrowest place that a vehicle must pass.

    Parameters
    ----------
    traveler : Traveler
        The vehicle.
    work : float
        Cells times ticks at most [-].

    Returns
    -------
    Narrowest or Passage
        Wide where a path leaves more than anybody needs; too large where that is what the vehicle
        can reach; unknown where no path is found.
    """
    horizon = traveler.scenario.horizon
    is_moving = any(o.is_moving for o in traveler.scenario.obstacles)
    around = traveler.surroundings(0)
    if around.is_empty or (not is_moving and _is_open(traveler, around)):
        return Passage.WIDE
    low, high = traveler.reach
    if traveler.scenario.workspace is not None:
        workspace = traveler.scenario.workspace
        low, high = np.maximum(low, workspace.lower), np.minimum(high, workspace.upper)
    moves = np.maximum(np.diff(high, axis=0).max(axis=0), -np.diff(low, axis=0).min(axis=0))
    lower, upper = low.min(axis=0), high.max(axis=0)
    if not (np.all(np.isfinite([*lower, *upper, *moves])) and np.all(lower <= upper)):
        return Passage.UNKNOWN
    grid = grid_of(lower, upper, np.maximum(moves, 0.0), traveler.radius, horizon, work)
    return Passage.TOO_LARGE if grid is None else _search(traveler, grid)


def _is_open(traveler: Traveler, around: Surroundings) -> bool:
    """Whether the straight line to the goal leaves more than anybody needs."""
    end = np.clip(traveler.start, *traveler.goal)
    points = traveler.start + np.linspace(0.0, 1.0, 65)[:, None] * (end - traveler.start)
    gap = 0.5 * float(np.linalg.norm(points[1] - points[0]))
    far = traveler.far
    return bool(around.nearest(points, far + gap).distances.min() - gap >= far)


def _search(traveler: Traveler, grid: Grid) -> Narrowest | Passage:
    """Go through all ticks, and back to the narrowest place."""
    centers = grid.centers
    is_moving = any(o.is_moving for o in traveler.scenario.obstacles)
    box = grid.box(*traveler.goal)
    if not is_moving:
        # Centers alone, and the largest deviation of all, are quick and often enough.
        careful = _careful_field(traveler, grid, centers), _careful_walls(traveler, grid, centers)
        ends = _swept(traveler, grid, lambda step: careful)[0][-1]
        if ends[box].max(initial=-np.inf) >= traveler.enough:
            return Passage.WIDE
    sides: list[Side] = []
    walls: Walls | None = None

    def world_at(step: int) -> _World:
        nonlocal sides, walls
        if is_moving or walls is None:
            sides, places = _sides(traveler, grid, centers, step)
            walls = _walls(traveler, grid, places, step)
        return _field(traveler, grid, sides, step), walls

    fields, worlds = _swept(traveler, grid, world_at)
    best = fields[-1][box].max(initial=-np.inf)
    if not np.isfinite(best):
        return _without_way(traveler, grid, box)
    if best >= traveler.enough:
        return Passage.WIDE
    ends = np.full(grid.shape, -np.inf, dtype=np.float32)
    ends[box] = fields[-1][box]
    last = np.unravel_index(int(ends.argmax()), grid.shape)
    tick, cell = _traced(fields, worlds, tuple(int(i) for i in last))
    return _measured(traveler, grid, centers[np.ravel_multi_index(cell, grid.shape)], tick)


def _without_way(traveler: Traveler, grid: Grid, box: tuple[slice, ...]) -> Passage:
    """Return why no path was found: what stands there, or limits alone."""
    nothing = (
        np.full(grid.shape, traveler.enough, dtype=np.float32),
        Walls.of(grid, grid.centers, ()),
    )
    ends = _swept(traveler, grid, lambda step: nothing)[0][-1]
    return Passage.CLOSED if np.isfinite(ends[box].max(initial=-np.inf)) else Passage.UNKNOWN


def _swept(
    traveler: Traveler, grid: Grid, world_at: Callable[[int], _World]
) -> tuple[list[Field], list[_World]]:
    """Return at every tick the least clearance on the roomiest path to each cell, and the world."""
    at_steps = traveler.scenario.avoidance == "steps"
    fields: list[Field] = [np.full(grid.shape, -np.inf, dtype=np.float32)]
    fields[0][grid.box(traveler.start, traveler.start)] = traveler.enough
    known, worlds = -1, [world_at(int(grid.steps[0]))]
    for tick in range(1, len(grid.steps)):
        step = int(grid.steps[tick])
        if step != known:
            known, world = step, world_at(step)
        here, walls = world
        worlds.append(world)
        after = walls.widened(fields[-1], here)
        if not at_steps or grid.is_step[tick]:
            np.minimum(after, here, out=after)
        fields.append(_within(traveler, grid, after, tick))
    return fields, worlds


def _walls(traveler: Traveler, grid: Grid, places: Matrix, step: int) -> Walls:
    """Return what a vehicle that is at places of cells cannot pass; at steps alone it can."""
    at_steps = traveler.scenario.avoidance == "steps"
    return Walls.of(grid, places, () if at_steps else traveler.surroundings(step).pieces)


def _careful_walls(traveler: Traveler, grid: Grid, centers: Matrix) -> Walls:
    """Return the walls that a hull can pass from center to center with more than it needs."""
    # Both are further than that from any wall, and neighbors no further apart than a diagonal.
    is_sure = 2.0 * (traveler.radius + traveler.far) > float(np.linalg.norm(grid.size))
    return Walls.of(grid, centers, ()) if is_sure else _walls(traveler, grid, centers, 0)


def _careful_field(traveler: Traveler, grid: Grid, centers: Matrix) -> Field:
    """Return clearances of the centers of all cells at the largest deviation of all steps."""
    slacks = traveler.surroundings(0).nearest(centers, traveler.far, grid.within).distances
    found = np.minimum(slacks * (traveler.enough / traveler.far), traveler.enough)
    field: Field = found.astype(np.float32).reshape(grid.shape)
    return field


def _field(traveler: Traveler, grid: Grid, sides: Sequence[Side], step: int) -> Field:
    """Return the clearances of all cells at a step, each for the best place in the cell.

    Within an obstacle there is no place for a hull of any size.
    """
    field: Field = np.full(np.prod(grid.shape), traveler.enough, dtype=np.float32)
    for side in sides:
        found = side.clearances(traveler.covariance(side.name, step), traveler.least)
        if side.name is not None:
            found[side.distances <= -traveler.radius] = -np.inf
        field[side.places] = np.minimum(field[side.places], found)
    return field.reshape(grid.shape)


def _sides(traveler: Traveler, grid: Grid, centers: Matrix, step: int) -> tuple[list[Side], Matrix]:
    """Return all that is near, as seen from the best place in each cell, and these places.

    That is somewhere between its center and its border, away from what the center is nearest to.
    """
    around = traveler.surroundings(step)
    far = traveler.far + float(np.linalg.norm(grid.size))
    # Cells stand for all places in them: whatever is near a place is near its cell.
    nearest = around.nearest(centers, far, grid.within)
    away = nearest.normals * (0.5 * np.abs(nearest.normals) @ grid.size)[:, None]
    best, places = nearest.distances, centers
    for share in _AWAY:
        moved = centers + share * away
        found = around.nearest(moved, far, grid.within).distances
        is_better = found > best
        best = np.where(is_better, found, best)
        places = np.where(is_better[:, None], moved, places)
    return list(around.sides(places, far, grid.within)), places


def _within(traveler: Traveler, grid: Grid, field: Field, tick: int) -> Field:
    """Return a field without the cells that limits keep the vehicle from at a tick."""
    step = int(grid.steps[tick])
    ahead = min(step + 1, traveler.scenario.horizon)
    # Between two steps the vehicle is in the box around both of theirs.
    lower = np.minimum(traveler.reach[0][step], traveler.reach[0][ahead])
    upper = np.maximum(traveler.reach[1][step], traveler.reach[1][ahead])
    kept: Field = np.full_like(field, -np.inf)
    box = grid.box(lower, upper)
    kept[box] = field[box]
    return kept


def _traced(
    fields: list[Field], worlds: list[_World], cell: tuple[int, ...]
) -> tuple[int, tuple[int, ...]]:
    """Return the tick and the cell at which the path to a cell is narrowest."""
    value = fields[-1][cell]
    for tick in range(len(fields) - 1, 0, -1):
        here, walls = worlds[tick]
        first, via = walls.before(cell, fields[tick - 1], here)
        if fields[tick - 1][first] > value:
            return tick, via if here[via] <= value else cell
        cell = first
    return 0, cell


def _measured(traveler: Traveler, grid: Grid, center: Vector, tick: int) -> Narrowest:
    """Measure a place where the cell is widest: across it, at the end within the goal."""
    step = int(grid.steps[tick])
    around = traveler.surroundings(step)
    normal = around.nearest(center[None]).normals[0]
    half = 0.5 * float(np.abs(normal) @ grid.size)
    points = center + np.linspace(-half, half, _ACROSS)[:, None] * normal
    if tick == len(grid.steps) - 1:
        edges = [np.linspace(a, b, _ALONG) for a, b in zip(*traveler.goal, strict=True)]
        points = np.stack(np.meshgrid(*edges, indexing="ij"), axis=-1).reshape(-1, len(edges))
    sides = list(around.sides(points))
    covariances = [traveler.covariance(side.name, step) for side in sides]
    pairs = list(zip(sides, covariances, strict=True))
    found = np.array([side.clearances(matrix, traveler.least) for side, matrix in pairs])
    best = int(found.min(axis=0).argmax())
    side, covariance = pairs[int(found[:, best].argmin())]
    clearance, deviation = side.best(best, covariance, traveler.least)
    return Narrowest(
        clearance=clearance,
        deviation=deviation,
        position=tuple(float(x) for x in points[best]),
        step=step,
        beside=_beside(sides, best, traveler.radius),
    )


def _beside(sides: Sequence[Side], place: int, radius: float) -> tuple[str | None, ...]:
    """Return what is nearest to a place, and what is on its other side if that is near, too."""
    first, *others = sorted(sides, key=lambda side: float(side.distances[place]))
    for other in others:
        is_across = float(other.normals[place] @ first.normals[place]) < -0.2
        if is_across and other.distances[place] - first.distances[place] <= radius:
            return (first.name, other.name)
    return (first.name,)
