"""The narrowest place that a vehicle must pass: what clearance the roomiest path in time leaves.

The clearance in standard deviations is the smaller of two over every path, and the path is chosen:
``W⁺(x) = min(c(x), max W(y))`` over the cells y that the vehicle may come from, from tick to tick.
What W is at the goal in the end, no path exceeds but for the grid's sake.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import log, sqrt

import numpy as np

from radmpc.arrays import Matrix, Tensor, Vector
from radmpc.model.scenario import Scenario
from radmpc.preflight.distances import Side, Surroundings
from radmpc.preflight.grid import Field, Grid, grid_of, widened
from radmpc.preflight.places import Narrowest, Passage
from radmpc.records import dataclass

__all__ = ["Traveler", "narrowest_place"]

_FEWEST, _MOST = 5.0, 8.5
"""Clearances that are looked for at least and at most, whatever Δ [standard deviations]."""

_LEAST_DEVIATION = 1e-3
"""Standard deviation that stands for less, where places are compared [hull radii]."""

_ACROSS = 33
"""Places across a gap at which it is measured [-]."""

_AWAY = (0.25, 0.5, 0.75, 1.0)
"""Shares of half a cell by which its best place is looked for [-]."""

_ALONG = 9
"""Places along each side of a goal at which its clearance is measured [-]."""


@dataclass(frozen=True, slots=True, eq=False)
class Traveler:
    """A vehicle on its way through a scenario.

    Attributes
    ----------
    scenario : Scenario
        The scenario.
    radius : float
        Hull radius [m].
    start : (d,) array
        Mean position at the start [m].
    goal : pair of (d,) array
        Corners of the goal [m].
    covariances : (T+1, d, d) array
        Position covariances [m²].
    reach : pair of (T+1, d) array
        Corners of boxes that hold its mean [m].
    """

    scenario: Scenario
    radius: float
    start: Vector
    goal: tuple[Vector, Vector]
    covariances: Tensor
    reach: tuple[Matrix, Matrix]

    @property
    def enough(self) -> float:
        """Clearance beyond which no place is narrow [standard deviations]."""
        # Its tail is at most exp(−q²/2)/2: this one runs a ten-thousandth of Δ.
        return min(max(sqrt(-2.0 * log(2e-4 * self.scenario.risk_bound)), _FEWEST), _MOST)

    def surroundings(self, step: int) -> Surroundings:
        """Return what it has to keep clear of, see `Surroundings.of`."""
        return Surroundings.of(self.scenario, self.radius, step)

    @property
    def least(self) -> float:
        """Standard deviation that stands for less, where places are compared [m]."""
        return _LEAST_DEVIATION * self.radius

    @property
    def far(self) -> float:
        """Distance of the hull from anything, beyond which no clearance is too little [m]."""
        widest = np.linalg.eigvalsh(self.covariances)[:, -1].max()
        spreads = [o.spread for o in self.scenario.obstacles if o.spread is not None]
        steps = range(self.scenario.horizon + 1)
        # Deviations of two add up to less than their sum.
        more = max((spread.deviation(k) for spread in spreads for k in steps), default=0.0)
        return self.enough * max(float(np.sqrt(max(widest, 0.0))) + more, self.least)

    def covariance(self, name: str | None, step: int) -> Matrix:
        """Return the covariance of its position relative to an obstacle, (d, d) [m²].

        Parameters
        ----------
        name : str or None
            The obstacle; None for the workspace's border.
        step : int
            The step, 0 to T.
        """
        for obstacle in self.scenario.obstacles:
            if obstacle.name == name and obstacle.spread is not None:
                return np.asarray(self.covariances[step] + obstacle.spread.positions[step])
        return np.asarray(self.covariances[step])


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
        careful = _careful_field(traveler, grid, centers)
        ends = _swept(traveler, grid, lambda step: careful)[-1]
        if ends[box].max(initial=-np.inf) >= traveler.enough:
            return Passage.WIDE
    sides: list[Side] = []

    def field_at(step: int) -> Field:
        nonlocal sides
        if is_moving or not sides:
            sides = _sides(traveler, grid, centers, step)
        return _field(traveler, grid, sides, step)

    fields = _swept(traveler, grid, field_at)
    best = fields[-1][box].max(initial=-np.inf)
    if not np.isfinite(best):
        return Passage.UNKNOWN
    if best >= traveler.enough:
        return Passage.WIDE
    ends = np.full(grid.shape, -np.inf, dtype=np.float32)
    ends[box] = fields[-1][box]
    last = np.unravel_index(int(ends.argmax()), grid.shape)
    tick, cell = _traced(fields, tuple(int(i) for i in last))
    return _measured(traveler, grid, centers[np.ravel_multi_index(cell, grid.shape)], tick)


def _swept(traveler: Traveler, grid: Grid, field_at: Callable[[int], Field]) -> list[Field]:
    """Return at every tick the least clearance on the roomiest path to each cell."""
    at_steps = traveler.scenario.avoidance == "steps"
    fields: list[Field] = [np.full(grid.shape, -np.inf, dtype=np.float32)]
    fields[0][grid.box(traveler.start, traveler.start)] = traveler.enough
    known, here = -1, fields[0]
    for tick in range(1, len(grid.steps)):
        step = int(grid.steps[tick])
        if step != known:
            known, here = step, field_at(step)
        after = widened(fields[-1])
        if not at_steps or grid.is_step[tick]:
            np.minimum(after, here, out=after)
        fields.append(_within(traveler, grid, after, tick))
    return fields


def _careful_field(traveler: Traveler, grid: Grid, centers: Matrix) -> Field:
    """Return clearances of the centers of all cells at the largest deviation of all steps."""
    slacks = traveler.surroundings(0).nearest(centers, traveler.far, grid.within).distances
    found = np.minimum(slacks * (traveler.enough / traveler.far), traveler.enough)
    field: Field = found.astype(np.float32).reshape(grid.shape)
    return field


def _field(traveler: Traveler, grid: Grid, sides: Sequence[Side], step: int) -> Field:
    """Return the clearances of all cells at a step, each for the best place in the cell."""
    field: Field = np.full(np.prod(grid.shape), traveler.enough, dtype=np.float32)
    for side in sides:
        found = side.clearances(traveler.covariance(side.name, step), traveler.least)
        field[side.places] = np.minimum(field[side.places], found)
    return field.reshape(grid.shape)


def _sides(traveler: Traveler, grid: Grid, centers: Matrix, step: int) -> list[Side]:
    """Return all that is near, as seen from the best place in each cell.

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
    return list(around.sides(places, far, grid.within))


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


def _traced(fields: list[Field], cell: tuple[int, ...]) -> tuple[int, tuple[int, ...]]:
    """Return the tick and the cell at which the path to a cell is narrowest."""
    value = fields[-1][cell]
    for tick in range(len(fields) - 1, 0, -1):
        first = [max(i - 1, 0) for i in cell]
        around = fields[tick - 1][tuple(slice(a, i + 2) for a, i in zip(first, cell, strict=True))]
        if around.max() > value:
            return tick, cell
        best = np.unravel_index(int(around.argmax()), around.shape)
        cell = tuple(a + int(i) for a, i in zip(first, best, strict=True))
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
