"""Convex polytopes as half-spaces and vertices, in any dimension; non-convex polygons split.

No time, no probability.
"""

from __future__ import annotations

import heapq
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import numpy.typing as npt
import shapely
from scipy.optimize import linprog
from scipy.spatial import ConvexHull, HalfspaceIntersection, QhullError

from radmpc.arrays import Frozen, Matrix, Vector, as_matrix, as_vector, frozen
from radmpc.errors import ScenarioError

__all__ = ["Polytope", "box", "convex_pieces", "halfspaces", "hull", "sphere_directions"]


@dataclass(frozen=True, slots=True, eq=False)
class Polytope(Frozen):
    """A bounded convex set with inner points, ``normals @ x <= offsets``.

    Attributes
    ----------
    normals : (f, d) array
        Outward unit normals [-].
    offsets : (f,) array
        Distances of the faces from the origin [m].
    vertices : (v, d) array
        Corners [m]; counter-clockwise in the plane.
    """

    normals: Matrix
    offsets: Vector
    vertices: Matrix

    @property
    def dimension(self) -> int:
        """Number of coordinates."""
        return int(self.normals.shape[1])

    def support(self, directions: Matrix) -> Vector:
        """Return the largest ``direction @ x`` over the set, one per row of directions [m]."""
        return np.asarray((directions @ self.vertices.T).max(axis=1))


def box(lower: npt.ArrayLike, upper: npt.ArrayLike) -> Polytope:
    """Return the axis-parallel box between two corners.

    Raises
    ------
    ScenarioError
        If the box is flat or inverted along some axis.
    """
    low = as_vector(lower)
    high = as_vector(upper, low.size)
    if not np.all(low < high):
        raise ScenarioError(
            f"min must be below max on every axis, got {low.tolist()} and {high.tolist()}"
        )
    identity = np.eye(low.size)
    if low.size == 2:
        corners = np.array([low, [high[0], low[1]], high, [low[0], high[1]]])
    else:
        grid = np.meshgrid(*zip(low, high, strict=True), indexing="ij")
        corners = np.stack([axis.ravel() for axis in grid], axis=1)
    return Polytope(
        frozen(np.vstack([identity, -identity])),
        frozen(np.concatenate([high, -low])),
        frozen(corners),
    )


def hull(points: npt.ArrayLike) -> Polytope:
    """Return the convex hull of points.

    Parameters
    ----------
    points : (p, d) array_like
        At least d + 1 points that do not lie in one plane [m].

    Returns
    -------
    Polytope
        Parallel faces merged, points inside dropped.

    Raises
    ------
    ScenarioError
        If the points span no volume.
    """
    cloud = as_matrix(points)
    try:
        qhull = ConvexHull(cloud)
    except (QhullError, ValueError) as error:
        raise ScenarioError(
            f"needs at least {cloud.shape[1] + 1} points that enclose a volume"
        ) from error
    # Qhull cuts facets into simplices: equal planes up to rounding are one face.
    equations = qhull.equations
    _, keep = np.unique(np.round(equations, 9), axis=0, return_index=True)
    equations = equations[np.sort(keep)]
    return Polytope(
        frozen(np.ascontiguousarray(equations[:, :-1])),
        frozen(np.ascontiguousarray(-equations[:, -1])),
        frozen(cloud[qhull.vertices]),
    )


def halfspaces(normals: npt.ArrayLike, offsets: npt.ArrayLike) -> Polytope:
    """Return the set ``normals @ x <= offsets``, normals scaled to unit length.

    Raises
    ------
    ScenarioError
        If a normal is zero, or the set is empty, flat or unbounded.
    """
    raw = as_matrix(normals)
    rhs = as_vector(offsets, raw.shape[0])
    lengths = np.linalg.norm(raw, axis=1)
    if not np.all(lengths >= 1e-9):
        raise ScenarioError("every normal must be different from zero")
    unit, rhs = raw / lengths[:, None], rhs / lengths
    inner = _chebyshev_center(unit, rhs)
    try:
        # Corners at infinity are refused below.
        with np.errstate(all="ignore"):
            corners = HalfspaceIntersection(np.column_stack([unit, -rhs]), inner).intersections
    except QhullError as error:
        raise ScenarioError("normals and offsets must describe a bounded set") from error
    if not np.all(np.isfinite(corners)):
        raise ScenarioError("normals and offsets must describe a bounded set")
    outline = hull(np.unique(np.round(corners, 12), axis=0))
    return Polytope(frozen(unit), frozen(rhs), outline.vertices)


def _chebyshev_center(normals: Matrix, offsets: Vector) -> Vector:
    """Return the center of the largest ball inside, or refuse sets that hold or bound none."""
    dimension = normals.shape[1]
    answer = linprog(
        np.append(np.zeros(dimension), -1.0),
        A_ub=np.column_stack([normals, np.ones(len(offsets))]),
        b_ub=offsets,
        bounds=[(None, None)] * dimension + [(0.0, None)],
    )
    if answer.status == 3:
        raise ScenarioError("normals and offsets must describe a bounded set")
    if answer.x is None or answer.x[-1] <= 1e-9:
        raise ScenarioError("normals and offsets describe a set without inner points")
    return np.asarray(answer.x[:-1])


def convex_pieces(vertices: npt.ArrayLike) -> tuple[Polytope, ...]:
    """Split a simple polygon into convex pieces that cover it exactly.

    Parameters
    ----------
    vertices : (v, 2) array_like
        Corners in order, either way round [m].

    Returns
    -------
    tuple of Polytope
        One piece where the polygon is convex.

    Raises
    ------
    ScenarioError
        If the outline crosses itself or has no area.
    """
    outline = as_matrix(vertices, (None, 2))
    if len(outline) < 3:
        raise ScenarioError(f"needs at least 3 vertices, got {len(outline)}")
    polygon = shapely.Polygon(outline)
    if not polygon.is_valid or polygon.area <= 0.0:
        why = shapely.is_valid_reason(polygon)
        raise ScenarioError(f"must be a simple polygon with an area, got one with: {why}")
    if _is_convex(polygon):
        return (hull(outline),)
    pieces = list(shapely.constrained_delaunay_triangles(polygon).geoms)
    return tuple(hull(np.array(piece.exterior.coords)[:-1]) for piece in _merge_convex(pieces))


def _merge_convex(pieces: list[shapely.Geometry]) -> list[shapely.Geometry]:
    """Join triangles as long as the union stays convex: fewer pieces, fewer avoidances."""
    left, neighbors = dict(enumerate(pieces)), _neighbors(pieces)
    # The first pair that can be joined is, until none can; a pair that changed is asked again.
    pairs = [(i, j) for i, others in neighbors.items() for j in others if i < j]
    heapq.heapify(pairs)
    while pairs:
        i, j = heapq.heappop(pairs)
        union = shapely.union(left[i], left[j]) if i in left and j in left else None
        if union is None or union.geom_type != "Polygon" or not _is_convex(union):
            continue
        left[i], taken = union, left.pop(j)
        neighbors[i] = (neighbors[i] | neighbors.pop(j)) - {i, j}
        for k in neighbors[i]:
            neighbors[k] = (neighbors[k] - {j}) | {i}
            if shapely.intersects(taken, left[k]):  # elsewhere all corners are as they were
                heapq.heappush(pairs, (min(i, k), max(i, k)))
    return list(left.values())


def _neighbors(triangles: list[shapely.Geometry]) -> dict[int, set[int]]:
    """Return which triangles share an edge with each."""
    owners: dict[frozenset[tuple[float, ...]], int] = {}
    neighbors: dict[int, set[int]] = {i: set() for i in range(len(triangles))}
    for i, triangle in enumerate(triangles):
        for edge in pairwise(triangle.exterior.coords):
            j = owners.setdefault(frozenset(edge), i)
            if j != i:
                neighbors[i].add(j)
                neighbors[j].add(i)
    return neighbors


def _is_convex(polygon: shapely.Geometry) -> bool:
    """Whether a polygon fills its hull, up to rounding."""
    return bool(polygon.convex_hull.area - polygon.area <= 1e-12 * polygon.convex_hull.area)


def sphere_directions(count: int, dimension: int) -> Matrix:
    """Return unit directions spread evenly, starting with the first axis.

    Parameters
    ----------
    count : int
        At least 3 in the plane; in space at least 6 and even.
    dimension : int
        2 or 3.

    Returns
    -------
    (count, dimension) array
        Four in the plane, six in space are the axes, exactly.
    """
    if count == 2 * dimension:
        return np.concatenate([np.eye(dimension), -np.eye(dimension)])
    if dimension == 2:
        angles = 2.0 * np.pi * np.arange(count) / count
        return np.column_stack([np.cos(angles), np.sin(angles)])
    # Fibonacci points on the upper half sphere and their opposites.
    half = count // 2
    height = (np.arange(half) + 0.5) / half
    turn = np.pi * (3.0 - np.sqrt(5.0)) * np.arange(half)
    radius = np.sqrt(1.0 - height**2)
    upper = np.column_stack([radius * np.cos(turn), radius * np.sin(turn), height])
    return np.concatenate([upper, -upper])
