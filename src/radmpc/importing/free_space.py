"""Paths around obstacles, on a grid of points: how long they are, and what clearance they keep.

For choosing times and noise only: no plan comes from here.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt
import shapely
from scipy import ndimage
from scipy.sparse import coo_array, csr_array
from scipy.sparse.csgraph import connected_components, dijkstra

from radmpc.arrays import Indices, Matrix, Vector
from radmpc.geometry import planar
from radmpc.geometry.lattice import blocked_steps, neighbors
from radmpc.importing.problem import ForeignProblem, ForeignVehicle
from radmpc.model.relations.concerns import concerned
from radmpc.records import dataclass

__all__ = ["FreePath", "FreeSpace", "free_spaces_of"]

_SPACINGS = (0.2, 0.4, 0.8, 2.0, 4.0)
"""Spacings that are tried, finest first [radii]. Of 0.25 m they divide a meter, so that a point
lies in the middle of every cell of a grid."""

_MOST_POINTS = 60_000
"""Points of a grid: more would be finer and take longer in proportion."""

_MOST_POINTS_OF_ALL = 3_000_000
"""Points times vehicles: their paths are searched one after the other."""

_BORDER = 10.0
"""Width of the border around everything where there are no bounds [radii]."""

_HALVINGS = 7
"""Bisections of the clearance: it is known to 1/128 of the range searched."""

_TOUCHING = np.ones((3, 3))


@dataclass(frozen=True, slots=True)
class FreePath:
    """The shortest path of one vehicle that keeps the largest clearance up to what is asked for.

    Attributes
    ----------
    detour : float
        What it is longer than the straight line, in the norm of the longest axis [m].
    clearance : float
        Least distance of the hull from obstacles along it, at most what is asked for [m].
    waiting : float
        How long it waits for others where only one at a time can pass [s].
    """

    detour: float
    clearance: float
    waiting: float = 0.0


@dataclass(frozen=True, slots=True, eq=False)
class FreeSpace:
    """Points in rows and columns, and how far obstacles are from them.

    Attributes
    ----------
    origin : (2,) array
        The point of index (0, 0) [m].
    spacing : float
        Between neighbors along an axis [m].
    distances : (p, q) array
        From each point to the nearest obstacle or to bounds that hold hulls, 0 within [m].
    blocked : (4, p, q) bool array or None
        Whether an obstacle, which may be thin, stands between a point outside all of them and its
        neighbor of that number outside all of them; None where none does.
    """

    origin: Vector
    spacing: float
    distances: Matrix
    blocked: npt.NDArray[np.bool_] | None = None

    def shortest_path(self, vehicle: ForeignVehicle, target: float) -> FreePath | None:
        """Return the shortest path that keeps the target clearance, or the largest there is.

        Parameters
        ----------
        vehicle : ForeignVehicle
            In the plane.
        target : float
            Clearance between its hull and obstacles [m].

        Returns
        -------
        FreePath or None
            None if the hull does not fit through at this spacing.
        """
        clearance = self._largest_clearance(vehicle, target)
        if clearance is None:
            return None
        steps = self._num_steps(vehicle, clearance)
        straight = float(np.abs(vehicle.goal - vehicle.start).max())
        return FreePath(max(steps * self.spacing - straight, 0.0), clearance)

    def widest_radius(self, vehicle: ForeignVehicle) -> float:
        """Return the largest radius, up to the vehicle's own, with a path to its goal [m]."""
        clearance = self._largest_clearance(vehicle, 0.0, -vehicle.radius)
        return 0.0 if clearance is None else vehicle.radius + clearance

    def _largest_clearance(
        self, vehicle: ForeignVehicle, target: float, least: float = 0.0
    ) -> float | None:
        """Return the largest clearance up to the target with a path left, by bisection."""
        if self._is_connected(vehicle, target):
            return target
        if not self._is_connected(vehicle, least):
            return None
        low, high = least, target
        for _ in range(_HALVINGS):
            middle = 0.5 * (low + high)
            if self._is_connected(vehicle, middle):
                low = middle
            else:
                high = middle
        return low

    def _free(self, vehicle: ForeignVehicle, clearance: float) -> np.ndarray:
        """Return which points the vehicle may be at, (p, q) of bool."""
        return self.distances >= vehicle.radius + clearance - 1e-9

    def _is_connected(self, vehicle: ForeignVehicle, clearance: float) -> bool:
        """Whether points with this clearance join start and goal."""
        free = self._free(vehicle, clearance)
        if self.blocked is not None and vehicle.radius + clearance <= self.spacing:
            # Neighbors may lie on both sides of a wall: farther from it they are none.
            _, parts = connected_components(self._graph(free), directed=False)
            marks = np.where(free, parts.reshape(free.shape) + 1, 0)
        else:
            marks, _ = ndimage.label(free, structure=_TOUCHING)
        start = marks[self._nearest(vehicle.start)]
        return bool(start and np.any(marks[self._goal_box(vehicle)] == start))

    def path(self, vehicle: ForeignVehicle, clearance: float) -> Indices:
        """Return the points of a shortest path with this clearance, from start to goal.

        Parameters
        ----------
        vehicle : ForeignVehicle
            In the plane.
        clearance : float
            Between its hull and obstacles [m].

        Returns
        -------
        (k, 2) int array
            Indices of the points; empty where there is no such path.
        """
        moves, before = self._moves(vehicle, clearance)
        box = self._goal_box(vehicle)
        ends = np.arange(moves.size).reshape(moves.shape)[box].ravel()
        last = int(ends[moves[box].argmin()])
        if not np.isfinite(moves.ravel()[last]):
            return np.zeros((0, 2), dtype=np.int64)
        points = [last]
        while before[points[-1]] >= 0:
            points.append(int(before[points[-1]]))
        return np.column_stack(np.unravel_index(points[::-1], moves.shape)).astype(np.int64)

    def _num_steps(self, vehicle: ForeignVehicle, clearance: float) -> int:
        """Return the least number of moves to a neighbor from start to goal."""
        moves, _ = self._moves(vehicle, clearance)
        return int(moves[self._goal_box(vehicle)].min())

    def _moves(self, vehicle: ForeignVehicle, clearance: float) -> tuple[Matrix, Indices]:
        """Return how many moves from the start each point is away, and the point before it."""
        free = self._free(vehicle, clearance)
        start = np.asarray(np.ravel_multi_index(self._nearest(vehicle.start), free.shape))
        moves, before = dijkstra(
            self._graph(free), directed=False, indices=start, return_predecessors=True
        )
        return np.asarray(moves).reshape(free.shape), np.asarray(before, dtype=np.int64)

    def _graph(self, free: npt.NDArray[np.bool_]) -> csr_array[np.float64, tuple[int, int]]:
        """Return which points a move joins, of those that a vehicle may be at, (p q, p q)."""
        ends: list[tuple[np.ndarray, np.ndarray]] = []
        for number, (first, second) in enumerate(neighbors(free.shape)):
            both = free.ravel()[first] & free.ravel()[second]
            if self.blocked is not None:
                both &= ~self.blocked[number].ravel()[first]
            ends.append((first[both], second[both]))
        rows = np.concatenate([first for first, _ in ends])
        columns = np.concatenate([second for _, second in ends])
        shape = (free.size, free.size)
        return coo_array((np.ones(rows.size), (rows, columns)), shape=shape).tocsr()

    def _nearest(self, point: Vector) -> tuple[int, int]:
        """Return the index of the grid point nearest to a point."""
        index = np.rint((point - self.origin) / self.spacing).astype(int)
        last = np.array(self.distances.shape) - 1
        row, column = np.clip(index, 0, last).tolist()
        return row, column

    def _goal_box(self, vehicle: ForeignVehicle) -> tuple[slice, slice]:
        """Return the indices of the points of the goal, at least one."""
        half = np.zeros(2) if vehicle.goal_half_width is None else vehicle.goal_half_width
        low, high = self._nearest(vehicle.goal - half), self._nearest(vehicle.goal + half)
        return slice(low[0], high[0] + 1), slice(low[1], high[1] + 1)


def free_spaces_of(problem: ForeignProblem) -> list[FreeSpace] | None:
    """Return the free space of each vehicle of a problem in the plane with obstacles, else None.

    They have the same grid, and those whom the same obstacles concern have the same value. A grid
    point lies on the first vehicle's start; the grid grows coarser with the problem's size.
    """
    vehicles = problem.vehicles
    # What moves is somewhere else by the time one comes by.
    fixed = [obstacle for obstacle in problem.obstacles if not obstacle.is_moving]
    if vehicles[0].start.size != 2 or not fixed:
        return None
    pieces = [[planar(piece) for piece in obstacle.at(0)] for obstacle in fixed]
    low, high = _bounds(problem, [piece for each in pieces for piece in each])
    spacing = _spacing(problem, low, high)
    anchor = vehicles[0].start
    origin = anchor - spacing * np.floor((anchor - low) / spacing + 1e-9)
    counts = np.floor((high - origin) / spacing + 1e-9).astype(int) + 1
    axes = [origin[i] + spacing * np.arange(counts[i]) for i in range(2)]
    names = [vehicle.name for vehicle in vehicles]
    whom = concerned(fixed, names)
    met = np.ones((len(names), len(fixed)), dtype=bool) if whom is None else whom
    spaces: dict[bytes, FreeSpace] = {}
    for row in met:
        if row.tobytes() not in spaces:
            own = [
                piece for each, is_met in zip(pieces, row, strict=True) if is_met for piece in each
            ]
            distances = _distances(problem, axes, own)
            blocked = blocked_steps(distances, axes, own)
            spaces[row.tobytes()] = FreeSpace(origin, spacing, distances, blocked)
    return [spaces[row.tobytes()] for row in met]


def _spacing(problem: ForeignProblem, low: Vector, high: Vector) -> float:
    """Return the distance between neighbors of a grid from corner to corner [m]."""
    vehicles = problem.vehicles
    radius = min(vehicle.radius for vehicle in vehicles)
    most = min(_MOST_POINTS, _MOST_POINTS_OF_ALL // len(vehicles))
    for factor in _SPACINGS:
        if np.prod((high - low) / (factor * radius) + 2.0) <= most:
            return factor * radius
    spacing = float(np.sqrt(np.prod(high - low) / most))
    # Of something long and thin the short axis has too few points to make up for the long one.
    while np.prod((high - low) / spacing + 2.0) > 2.0 * most:
        spacing *= 2.0
    return spacing


def _distances(
    problem: ForeignProblem, axes: Sequence[Vector], pieces: Sequence[shapely.Geometry]
) -> Matrix:
    """Return how far each point of a grid is from the nearest piece or bound, (p, q) [m]."""
    points = shapely.points(*np.meshgrid(*axes, indexing="ij"))
    distances = np.full(points.shape, np.inf)
    if pieces:
        _, nearest = shapely.STRtree(pieces).query_nearest(
            points.ravel(), return_distance=True, all_matches=False
        )
        distances = nearest.reshape(points.shape)
    if problem.workspace is not None and problem.bounds_hulls:
        for axis, values in enumerate(np.meshgrid(*axes, indexing="ij")):
            distances = np.minimum(distances, values - problem.workspace.lower[axis])
            distances = np.minimum(distances, problem.workspace.upper[axis] - values)
    return distances


def _bounds(problem: ForeignProblem, pieces: Sequence[shapely.Geometry]) -> tuple[Vector, Vector]:
    """Return the corners of what a path may use, starts and goals included."""
    points = np.array([p for v in problem.vehicles for p in (v.start, v.goal)])
    low, high = points.min(axis=0), points.max(axis=0)
    if problem.workspace is not None:
        low = np.minimum(low, problem.workspace.lower)
        high = np.maximum(high, problem.workspace.upper)
        return low, high
    boxes = shapely.bounds(pieces)
    border = _BORDER * max(vehicle.radius for vehicle in problem.vehicles)
    low = np.minimum(low, boxes[:, :2].min(axis=0)) - border
    high = np.maximum(high, boxes[:, 2:].max(axis=0)) + border
    return low, high
