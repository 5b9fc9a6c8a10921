"""Shortest ways around standing obstacles, on a grid."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.sparse import coo_array, csr_array
from scipy.sparse.csgraph import dijkstra

from radmpc.arrays import Indices, Matrix, Vector
from radmpc.program.hazards import Hazards

__all__ = ["detours"]

_POINTS = {2: 80, 3: 26}
"""Points of the grid along its longest axis, by dimension [-]: 100 boxes take 10 ms to lay out."""

_BORDER = 3.0
"""Width of the border around starts, goals and obstacles [radii]."""

_WIDE = 3.0
"""Standard deviations from an obstacle from which on a way counts as free [-]."""

_NARROW = 4.0
"""Factor on the length of a way that touches an obstacle; 1 where the way is free [-]."""


def detours(hazards: Hazards, vehicles: Sequence[int] | Indices) -> dict[int, Matrix]:
    """Return the shortest ways of vehicles around standing obstacles.

    Parameters
    ----------
    hazards : Hazards
        The fleet; what moves is left out.
    vehicles : sequence of int
        Whose ways are asked for.

    Returns
    -------
    dict of int to (p, d) array
        Corners of the ways from start to goal [m], of those for which there is one.
    """
    grid = _Grid.of(hazards)
    graphs: dict[tuple[float, float], csr_array] = {}
    found = {}
    for i in np.asarray(vehicles).tolist():
        model = hazards.models[i]
        spread = float(np.sqrt(hazards.variances[i].max() / hazards.dimension))
        key = (float(hazards.radii[i]), round(spread, 9))
        if key not in graphs:
            graphs[key] = grid.graph(*key)
        goal = 0.5 * (model.vehicle.goal.lower + model.vehicle.goal.upper)
        way = grid.way(graphs[key], model.drift_position[0], goal)
        if way is not None:
            found[i] = way
    return found


@dataclass(frozen=True, slots=True, eq=False)
class _Grid:
    """Points spread evenly, and how far each is from the nearest obstacle.

    Attributes
    ----------
    points : (p, d) array
        The points [m].
    shape : tuple of int
        Number of points along each axis.
    spacing : float
        Their distance along an axis [m].
    distances : (p,) array
        Largest distance of a face of the nearest obstacle, negative inside; inf far away [m].
    """

    points: Matrix
    shape: tuple[int, ...]
    spacing: float
    distances: Vector

    @classmethod
    def of(cls, hazards: Hazards) -> _Grid:
        """Lay out a grid over everything that stands, from starts to goals."""
        shapes, d = hazards.shapes, hazards.dimension
        standing = np.flatnonzero((shapes.vertices == shapes.vertices[:, :1]).all(axis=(1, 2, 3)))
        corners = [shapes.vertices[standing, 0].reshape(-1, d)]
        for model in hazards.models:
            goal = model.vehicle.goal
            corners.append(np.array([model.drift_position[0], goal.lower, goal.upper]))
        every = np.concatenate(corners)
        border = _BORDER * float(hazards.radii.max())
        lower, upper = every.min(axis=0) - border, every.max(axis=0) + border
        if hazards.workspace is not None:
            lower = np.maximum(lower, hazards.workspace[0])
            upper = np.minimum(upper, hazards.workspace[1])
        spacing = float((upper - lower).max()) / _POINTS[d]
        axes = [np.arange(lower[a], upper[a] + 1e-9, spacing) for a in range(d)]
        mesh = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)
        distances = np.full(mesh.shape[:-1], np.inf)
        spread = float(np.sqrt(hazards.variances.max(initial=0.0)))
        far = float(hazards.radii.max()) + _WIDE * spread + spacing
        for piece in standing:
            near = shapes.lower[piece, 0] - far, shapes.upper[piece, 0] + far
            part = tuple(
                slice(*np.searchsorted(axis, (near[0][a], near[1][a])))
                for a, axis in enumerate(axes)
            )
            faces = shapes.faces[piece, 0]
            faces = faces[faces.any(axis=1)]
            offsets = (faces @ shapes.vertices[piece, 0].T).max(axis=1)
            outside = (mesh[part] @ faces.T - offsets).max(axis=-1)
            distances[part] = np.minimum(distances[part], outside)
        shape = distances.shape
        return cls(mesh.reshape(-1, d), shape, spacing, distances.ravel())

    def graph(self, radius: float, spread: float) -> csr_array:
        """Return the lengths between neighboring points where a vehicle fits, longer where narrow.

        Parameters
        ----------
        radius : float
            Of the vehicle [m].
        spread : float
            Its standard deviation [m].
        """
        room = np.clip((self.distances - radius) / max(_WIDE * spread, self.spacing), 0.0, 1.0)
        weights = np.where(self.distances < radius, np.inf, _NARROW - (_NARROW - 1.0) * room)
        numbers = np.arange(len(self.points)).reshape(self.shape)
        steps = [np.array(s) - 1 for s in np.ndindex(*(3,) * len(self.shape))]
        rows, columns, lengths = [], [], []
        # Every edge once: the graph is not directed.
        for step in steps[len(steps) // 2 + 1 :]:
            pairs = list(zip(step.tolist(), self.shape, strict=True))
            begin = tuple(slice(max(0, -s), n - max(0, s)) for s, n in pairs)
            end = tuple(slice(max(0, s), n - max(0, -s)) for s, n in pairs)
            one, two = numbers[begin].ravel(), numbers[end].ravel()
            mean = 0.5 * (weights[one] + weights[two])
            open_edges = np.isfinite(mean)
            rows.append(one[open_edges])
            columns.append(two[open_edges])
            lengths.append(mean[open_edges] * self.spacing * float(np.linalg.norm(step)))
        entries = (np.concatenate(lengths), (np.concatenate(rows), np.concatenate(columns)))
        count = len(self.points)
        return csr_array(coo_array(entries, shape=(count, count)))

    def way(self, graph: csr_array, start: Vector, goal: Vector) -> Matrix | None:
        """Return the corners of the shortest way between two places; None where there is none."""
        ends = np.zeros(len(self.points), dtype=bool)
        ends[graph.nonzero()[0]] = ends[graph.nonzero()[1]] = True
        open_points = np.flatnonzero(ends)
        if open_points.size == 0:
            return None
        first, last = (
            int(open_points[np.linalg.norm(self.points[open_points] - end, axis=1).argmin()])
            for end in (start, goal)
        )
        lengths, before = dijkstra(
            graph, directed=False, indices=np.array([last]), return_predecessors=True
        )
        if not np.isfinite(lengths[0, first]):
            return None
        path = [first]
        while path[-1] != last:
            path.append(int(before[0, path[-1]]))
        return np.vstack([start, self.points[path], goal])
