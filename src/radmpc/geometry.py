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

from radmpc.arrays import Frozen, Matrix, Vector, as_matrix, as_vector, frozen
from radmpc.errors import ScenarioError
from radmpc.facets import facets, frame

__all__ = [
    "Polytope",
    "box",
    "convex_pieces",
    "halfspaces",
    "hull",
    "planar",
    "sphere_directions",
]

_UNBOUNDED = "normals and offsets must describe a bounded set"
# Radius of the largest ball up to which a set of half-spaces has no inner points [m]; below what
# coordinates are given to, above what the linear program's solver gets wrong.
_THIN = 1e-9
# Sine of the angle from which two normals differ.
_TURNED = 1e-9


@dataclass(frozen=True, slots=True, eq=False)
class Polytope(Frozen):
    """A bounded convex set, ``normals @ x <= offsets``: a body, a plate, a segment or a point.

    Sets without inner points have faces both ways, so that each face moved out bounds what is near.

    Attributes
    ----------
    normals : (f, d) array
        Outward unit normals [-].
    offsets : (f,) array
        Distances of the faces from the origin [m].
    vertices : (v, d) array
        Corners [m]; counter-clockwise in the plane. A segment has two, a point one.
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
    """Return the axis-parallel box between two corners; it may be flat along any axis.

    Raises
    ------
    ScenarioError
        If the box is inverted along some axis.
    """
    low = as_vector(lower)
    high = as_vector(upper, low.size)
    if not np.all(low <= high):
        raise ScenarioError(
            f"min must not be above max on any axis, got {low.tolist()} and {high.tolist()}"
        )
    identity = np.eye(low.size)
    if low.size == 2 and np.all(low < high):
        corners = np.array([low, [high[0], low[1]], high, [low[0], high[1]]])
    else:
        ends = [np.unique(pair) for pair in np.stack([low, high], axis=1)]
        grid = np.meshgrid(*ends, indexing="ij")
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
        At least one; all in one plane, on one line or at one place make a plate, a segment or a
        point [m].

    Returns
    -------
    Polytope
        Parallel faces merged, points inside dropped.

    Raises
    ------
    ScenarioError
        If there is no point, or points lie too far apart to tell what they enclose.
    """
    cloud = as_matrix(points)
    if not cloud.size:
        raise ScenarioError("needs at least one point, got none")
    from scipy.spatial import QhullError  # noqa: PLC0415 - boxes do without scipy

    try:
        found = facets(cloud)
    except (QhullError, ValueError) as error:
        raise ScenarioError("has points too far apart to tell what they enclose") from error
    return Polytope(frozen(found.normals), frozen(found.offsets), frozen(cloud[found.corners]))


def halfspaces(normals: npt.ArrayLike, offsets: npt.ArrayLike) -> Polytope:
    """Return the set ``normals @ x <= offsets``, normals scaled to unit length.

    A set without inner points is the hull of its corners.

    Raises
    ------
    ScenarioError
        If a normal is zero, or the set is empty or unbounded.
    """
    raw = as_matrix(normals)
    rhs = as_vector(offsets, raw.shape[0])
    lengths = np.linalg.norm(raw, axis=1)
    if not np.all(lengths >= 1e-9):
        raise ScenarioError("every normal must be different from zero")
    unit, rhs = raw / lengths[:, None], rhs / lengths
    center, radius = _chebyshev_ball(unit, rhs)
    if radius <= _THIN:
        return hull(np.round(_flat_corners(unit, rhs, center), 12))
    outline = hull(np.unique(np.round(_corners(unit, rhs, center), 12), axis=0))
    return Polytope(frozen(unit), frozen(rhs), outline.vertices)


def _corners(normals: Matrix, offsets: Vector, inner: Vector) -> Matrix:
    """Return the corners of a set around an inner point, or refuse one that is unbounded."""
    if normals.shape[1] == 1:
        ends = offsets / normals[:, 0]
        above, below = ends[normals[:, 0] > 0.0], ends[normals[:, 0] < 0.0]
        if not (above.size and below.size):
            raise ScenarioError(_UNBOUNDED)
        return np.array([[below.max()], [above.min()]])
    from scipy.spatial import HalfspaceIntersection, QhullError  # noqa: PLC0415 - loads slowly

    try:
        # Corners at infinity are refused below.
        with np.errstate(all="ignore"):
            found = HalfspaceIntersection(np.column_stack([normals, -offsets]), inner).intersections
    except QhullError as error:
        raise ScenarioError(_UNBOUNDED) from error
    if not np.all(np.isfinite(found)):
        raise ScenarioError(_UNBOUNDED)
    return np.asarray(found)


def _flat_corners(normals: Matrix, offsets: Vector, point: Vector) -> Matrix:
    """Return the corners of a set without inner points, found in the plane or line it lies in."""
    lowest = [_lowest(row, normals, offsets) for row in normals]
    tight = np.array(lowest) >= offsets - _THIN * (1.0 + np.abs(offsets))
    across, along = frame(normals[tight], _TURNED)
    # A solver's point misses the faces by its tolerance.
    fitted, *_ = np.linalg.lstsq(
        normals[tight], offsets[tight] - normals[tight] @ point, rcond=None
    )
    point = point + across.T @ (across @ fitted)
    slopes, left = normals[~tight] @ along.T, offsets[~tight] - normals[~tight] @ point
    lengths = np.linalg.norm(slopes, axis=1)
    bounds = lengths > _TURNED
    if not len(along):
        return point[None]
    if not bounds.any():
        raise ScenarioError(_UNBOUNDED)
    slopes, left = slopes[bounds] / lengths[bounds, None], left[bounds] / lengths[bounds]
    center, _ = _chebyshev_ball(slopes, left)
    return np.asarray(point + _corners(slopes, left, center) @ along)


def _lowest(direction: Vector, normals: Matrix, offsets: Vector) -> float:
    """Return the least ``direction @ x`` over a set, -inf where there is none."""
    from scipy.optimize import linprog  # noqa: PLC0415 - loads slowly; only half-spaces ask

    free = [(None, None)] * normals.shape[1]
    answer = linprog(direction, A_ub=normals, b_ub=offsets, bounds=free)
    return -np.inf if answer.fun is None else float(answer.fun)


def _chebyshev_ball(normals: Matrix, offsets: Vector) -> tuple[Vector, float]:
    """Return the largest ball inside, or refuse sets that hold no point or bound no ball."""
    from scipy.optimize import linprog  # noqa: PLC0415 - loads slowly; only half-spaces ask

    dimension = normals.shape[1]
    answer = linprog(
        np.append(np.zeros(dimension), -1.0),
        A_ub=np.column_stack([normals, np.ones(len(offsets))]),
        b_ub=offsets,
        bounds=[(None, None)] * dimension + [(0.0, None)],
    )
    if answer.status == 3:
        raise ScenarioError(_UNBOUNDED)
    if answer.x is None:
        raise ScenarioError("normals and offsets describe an empty set")
    return np.asarray(answer.x[:-1]), float(answer.x[-1])


def planar(piece: Polytope) -> shapely.Geometry:
    """Return a set in the plane as shapely has it: a polygon, a line or a point."""
    corners = piece.vertices
    if len(corners) == 1:
        return shapely.Point(corners[0])
    return shapely.LineString(corners) if len(corners) == 2 else shapely.Polygon(corners)


def convex_pieces(vertices: npt.ArrayLike) -> tuple[Polytope, ...]:
    """Split a simple polygon into convex pieces that cover it exactly.

    Parameters
    ----------
    vertices : (v, 2) array_like
        Corners in order, either way round; all on one line make a segment [m].

    Returns
    -------
    tuple of Polytope
        One piece where the polygon is convex.

    Raises
    ------
    ScenarioError
        If there is no corner, or the outline crosses itself.
    """
    outline = as_matrix(vertices, (None, 2))
    around = hull(outline)
    if len(around.vertices) < 3:
        return (around,)
    polygon = shapely.Polygon(outline)
    if not polygon.is_valid or polygon.area <= 0.0:
        why = shapely.is_valid_reason(polygon)
        raise ScenarioError(f"must be a simple polygon with an area, got one with: {why}")
    if _is_convex(polygon):
        return (around,)
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
