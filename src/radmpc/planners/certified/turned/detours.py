"""Shortest routes around standing obstacles, on a grid."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from scipy.sparse import coo_array, csr_array
from scipy.sparse.csgraph import dijkstra
from scipy.spatial import cKDTree

from radmpc.arrays import Indices, Matrix, Vector
from radmpc.planners.certified.turned.grid import FREE, Grid
from radmpc.program.hazards import Hazards
from radmpc.records import dataclass

__all__ = ["NARROW", "Toll", "detours", "routes_beside"]

_ROOMS = (1.0, 0.7, 0.4, 0.0)
"""Shares of the clearance that routes are sought with, one after the other [-]."""

NARROW = 4.0
"""Factor on the length of a route that touches an obstacle; 1 where the route is free [-]."""

_LIKELY = 1.3
"""Length of a route that is sought first, in multiples of the straight one [-]: most are shorter,
and what is farther off is not looked at for them."""

_BESIDE = 2.0
"""Factor on lengths near a route beside which another one is sought [-]."""


@dataclass(frozen=True, slots=True, eq=False)
class Toll:
    """What makes parts of a route count as longer.

    Attributes
    ----------
    narrow : float
        Factor where it touches an obstacle; 1 where it is free [-].
    beside : tuple of (p, d) array
        Corners of routes that are to be avoided where others are not much longer [m].
    """

    narrow: float = NARROW
    beside: tuple[Matrix, ...] = ()

    def factors(self, grid: Grid, radius: float, spread: float) -> Vector:
        """Return the factors at the points of a grid, inf where a vehicle does not fit, (p,) [-].

        Parameters
        ----------
        grid : Grid
            The points.
        radius : float
            Of the vehicle and what it keeps around it [m].
        spread : float
            Its standard deviation [m].
        """
        room = np.clip((grid.distances - radius) / max(FREE * spread, grid.spacing), 0.0, 1.0)
        found = self.narrow - (self.narrow - 1.0) * room
        if self.beside:
            points = np.vstack([_points_on(route, grid.spacing) for route in self.beside])
            away, _ = cKDTree(points).query(grid.points)
            found = found * np.where(away < radius, _BESIDE, 1.0)
        return np.where(grid.distances < radius, np.inf, found)


def _points_on(route: Matrix, spacing: float) -> Matrix:
    """Return points on a route, at most a spacing apart, (p, d) [m]."""
    lengths = np.append(0.0, np.cumsum(np.linalg.norm(np.diff(route, axis=0), axis=1)))
    along = np.arange(0.0, lengths[-1] + spacing, spacing)
    return np.stack([np.interp(along, lengths, axis) for axis in route.T], axis=1)


def detours(
    hazards: Hazards,
    vehicles: Sequence[int] | Indices,
    clearance: float = 0.0,
    grid: Grid | None = None,
    toll: Toll | None = None,
) -> dict[int, Matrix]:
    """Return the shortest routes of vehicles around standing obstacles.

    Parameters
    ----------
    hazards : Hazards
        The fleet; what moves is left out.
    vehicles : sequence of int
        Whose routes are asked for.
    clearance : float
        Standard deviations that routes keep from obstacles where there are such routes [-].
    grid : Grid or None
        The points that routes lead over; None for the usual ones.
    toll : Toll or None
        What makes parts of them count as longer; None is the usual one.

    Returns
    -------
    dict of int to (p, d) array
        Corners of the routes from start to goal [m], of those for which there is one.
    """
    grid = Grid.of(hazards) if grid is None else grid
    graphs: dict[tuple[float, float], tuple[csr_array, np.ndarray]] = {}
    found = {}
    for i in np.asarray(vehicles).tolist():
        model = hazards.models[i]
        spread = float(np.sqrt(hazards.variances[i].max() / hazards.dimension))
        goal = 0.5 * (model.vehicle.goal.lower + model.vehicle.goal.upper)
        stops = [model.drift_position[0], *(visit.center for visit in model.vehicle.via), goal]
        # Where the noise fits, too, if there is such a route; else wherever the hull does.
        for room in clearance * spread * np.array(_ROOMS):
            key = (round(float(hazards.radii[i] + room), 9), round(spread, 9))
            if key not in graphs:
                graph = _graph(grid, (toll or Toll()).factors(grid, *key))
                is_open = np.zeros(len(grid.points), dtype=bool)
                is_open[np.concatenate(graph.nonzero())] = True
                graphs[key] = graph, is_open
            numbers = [grid.nearest(place, graphs[key][1]) for place in stops]
            legs = [
                _way(grid, graphs[key][0], (stops[k], stops[k + 1]), (numbers[k], numbers[k + 1]))
                for k in range(len(stops) - 1)
            ]
            routes = [leg for leg in legs if leg is not None]
            if len(routes) == len(legs):
                found[i] = np.vstack(routes)
                break
    return found


def routes_beside(
    hazards: Hazards,
    grid: Grid,
    parts: Mapping[int, Sequence[Matrix]],
    clearance: float,
    far: float,
) -> dict[int, list[Matrix]]:
    """Return the shortest routes beside given ones, piece by piece.

    Parameters
    ----------
    hazards : Hazards
        The fleet.
    grid : Grid
        The points that routes lead over.
    parts : mapping of int to sequence of (p, d) array
        Points of the pieces of each vehicle's route [m].
    clearance : float
        Standard deviations that routes keep from obstacles where there are such routes [-].
    far : float
        How far they may lead from the given ones [m].

    Returns
    -------
    dict of int to list of (p, d) array
        Points of the new pieces [m]; those for which there is none stay as they are.
    """
    tree = cKDTree(grid.points)
    graphs: dict[tuple[float, float], csr_array] = {}
    found: dict[int, list[Matrix]] = {}
    for i, pieces in parts.items():
        spread = float(np.sqrt(hazards.variances[i].max() / hazards.dimension))
        rooms = float(hazards.radii[i]) + clearance * spread * np.array(_ROOMS)
        found[i] = []
        for piece in pieces:
            beside = np.unique(np.concatenate(tree.query_ball_point(piece, far))).astype(np.int64)
            ends = [
                int(np.linalg.norm(grid.points[beside] - p, axis=1).argmin())
                for p in piece[[0, -1]]
            ]
            for room in rooms:
                key = (round(float(room), 9), round(spread, 9))
                if key not in graphs:
                    graphs[key] = _graph(grid, Toll().factors(grid, *key))
                path = _path(graphs[key][beside][:, beside], *ends)
                if path:
                    found[i].append(np.vstack([piece[:1], grid.points[beside[path]], piece[-1:]]))
                    break
            else:
                found[i].append(piece)
    return found


def _path(graph: csr_array, first: int, last: int, likely: float = np.inf) -> list[int]:
    """Return the points on the shortest route through a graph; none where there is no route.

    Whether any is as short as is likely is asked first [m].
    """
    for limit in (likely, np.inf) if likely < np.inf else (np.inf,):
        lengths, before = dijkstra(
            graph,
            directed=False,
            indices=np.array([last]),
            return_predecessors=True,
            limit=limit,
        )
        if np.isfinite(lengths[0, first]):
            break
    if not np.isfinite(lengths[0, first]):
        return []
    path = [first]
    while path[-1] != last:
        path.append(int(before[0, path[-1]]))
    return path


def _graph(grid: Grid, weights: Vector) -> csr_array:
    """Return the lengths between neighboring points where a vehicle fits, times their factors."""
    numbers = np.arange(len(grid.points)).reshape(grid.shape)
    steps = [np.array(s) - 1 for s in np.ndindex(*(3,) * len(grid.shape))]
    rows, columns, lengths = [], [], []
    # Every edge once: the graph is not directed.
    for step in steps[len(steps) // 2 + 1 :]:
        pairs = list(zip(step.tolist(), grid.shape, strict=True))
        begin = tuple(slice(max(0, -s), n - max(0, s)) for s, n in pairs)
        end = tuple(slice(max(0, s), n - max(0, -s)) for s, n in pairs)
        one, two = numbers[begin].ravel(), numbers[end].ravel()
        mean = 0.5 * (weights[one] + weights[two])
        open_edges = np.isfinite(mean)
        one, two = one[open_edges], two[open_edges]
        rows.append(one)
        columns.append(two)
        lengths.append(mean[open_edges] * grid.edges(one, two, step))
    entries = (np.concatenate(lengths), (np.concatenate(rows), np.concatenate(columns)))
    count = len(grid.points)
    return csr_array(coo_array(entries, shape=(count, count)))


def _way(
    grid: Grid, graph: csr_array, places: tuple[Vector, Vector], numbers: tuple[int, int]
) -> Matrix | None:
    """Return the corners of the shortest route between two places; None where there is none.

    Parameters
    ----------
    grid : Grid
        The points.
    graph : csr_array
        The lengths between them.
    places : tuple of (d,) array
        The two [m].
    numbers : tuple of int
        The open points next to them; -1 where none is open.
    """
    if numbers[0] < 0:
        return None
    (start, goal), (first, last) = places, numbers
    straight = float(np.linalg.norm(grid.points[first] - grid.points[last]))
    path = _path(graph, first, last, _LIKELY * straight + grid.spacing)
    return np.vstack([start, grid.points[path], goal]) if path else None
