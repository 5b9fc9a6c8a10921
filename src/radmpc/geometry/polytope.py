"""Convex polytopes as half-spaces and vertices, in any dimension. No time, no probability."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from radmpc.arrays import Frozen, Matrix, Vector, as_matrix, as_vector, frozen
from radmpc.errors import ScenarioError
from radmpc.facets import facets, frame
from radmpc.records import dataclass

__all__ = ["Polytope", "box", "halfspaces", "hull", "sphere_directions"]

_UNBOUNDED = "normals and offsets must describe a bounded set"
_THIN = 1e-9
"""Radius of the largest ball up to which a set of half-spaces has no inner points [m]; below what
coordinates are given to, above what the linear program's solver gets wrong."""

_TURNED = 1e-9
"""Sine of the angle from which two normals differ [-]."""


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

    Parameters
    ----------
    lower, upper : (d,) array_like
        The corners [m].

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
    found = facets(cloud)
    return Polytope(frozen(found.normals), frozen(found.offsets), frozen(cloud[found.corners]))


def halfspaces(normals: npt.ArrayLike, offsets: npt.ArrayLike) -> Polytope:
    """Return the set ``normals @ x <= offsets``, normals scaled to unit length.

    A set without inner points is the hull of its corners.

    Parameters
    ----------
    normals : (f, d) array_like
        Outward normals, of any length but 0.
    offsets : (f,) array_like
        Right sides, in the normals' length times meters.

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
