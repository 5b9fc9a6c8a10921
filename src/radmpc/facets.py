"""Faces, corners and edges of convex hulls: of bodies, and of plates, segments and points."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from radmpc.arrays import Indices, Matrix, Tensor, Vector
from radmpc.errors import ScenarioError
from radmpc.outline import outline
from radmpc.records import dataclass

if TYPE_CHECKING:
    from scipy.spatial import ConvexHull

__all__ = ["Facets", "facets", "frame", "surface"]

_FLAT = 1e-12
"""Width, relative to the largest coordinate, below which it is rounding [-]. Qhull gives up from
1e-14 on."""

_TOO_FAR = 1e150
"""Coordinates whose squares overflow, so that no area can be told [m]."""


@dataclass(frozen=True, slots=True, eq=False)
class Facets:
    """The faces that bound the hull of points.

    Attributes
    ----------
    normals : (f, d) array
        Outward unit normals [-]. A set without inner points has those of its ends and, both ways,
        those at right angles to it: moved out by a radius they bound all that comes near it.
    offsets : (f,) array
        Distances of the faces from the origin [m].
    corners : (v,) int array
        Which points are corners; in the plane counter-clockwise.
    edges : (e, 2) int array
        Which points edges join; the sides of a polygon. A point alone is an edge without length.
    dimension : int
        3 of a body, 2 of a polygon or plate, 1 of a segment, 0 of a point.
    """

    normals: Matrix
    offsets: Vector
    corners: Indices
    edges: Indices
    dimension: int


def facets(points: Matrix) -> Facets:
    """Return the faces, corners and edges of the hull of points.

    Parameters
    ----------
    points : (p, d) array
        At least one [m].

    Returns
    -------
    Facets
        Equal faces merged, the edges between them and points inside dropped.

    Raises
    ------
    ScenarioError
        If the points are spread too far to tell.
    """
    scale = float(np.abs(points).max(initial=0.0)) or 1.0
    moves = points / scale - points[0] / scale
    along, across = frame(moves, _FLAT)
    if not len(across) and len(along) > 1:
        if scale > _TOO_FAR:
            raise _too_far()
        return _of_polygon(points) if len(along) == 2 else _of_body(points)
    return _of_flat(points, moves @ along.T, along, across)


def surface(points: Matrix) -> Tensor:
    """Return the surface of the hull of points in space as triangles, (t, 3, 3) [m].

    Those of a body are seen counter-clockwise from outside. A plate has one side of them, a segment
    or a point none.

    Parameters
    ----------
    points : (p, 3) array
        At least one [m].
    """
    found = facets(points)
    if len(found.corners) < 3:
        return np.zeros((0, 3, 3))
    if found.dimension == 2:
        first, *rest = points[found.corners]
        return np.array([[first, second, third] for second, third in pairwise(rest)])
    hull = _qhull(points)
    first, second, third = points[hull.simplices.T]
    # Qhull gives no order; the plane's normal points outward.
    normals = np.cross(second - first, third - first)
    is_inward = np.einsum("ij,ij->i", normals, hull.equations[:, :3]) < 0.0
    second[is_inward], third[is_inward] = third[is_inward], second[is_inward]
    return np.asarray(np.stack([first, second, third], axis=1))


def frame(vectors: Matrix, least: float) -> tuple[Matrix, Matrix]:
    """Return an orthonormal basis of what vectors span, and one of what is at right angles to it.

    Vectors along the axes give axes, exactly.

    Parameters
    ----------
    vectors : (p, d) array
        Any number of them.
    least : float
        Length of a vector's remainder from which it counts.

    Returns
    -------
    along, across : (k, d) and (d - k, d) array
        Rows of unit length.
    """
    dimension = vectors.shape[1]
    along = _orthonormal(vectors, np.zeros((0, dimension)), least)
    # At least one axis has a remainder of this length as long as a direction is missing.
    both = _orthonormal(np.eye(dimension), along, 0.5 / np.sqrt(dimension))
    return along, both[len(along) :]


def _orthonormal(vectors: Matrix, basis: Matrix, least: float) -> Matrix:
    """Extend a basis by what vectors add to it, the longest remainder first."""
    rest = vectors - vectors @ basis.T @ basis
    while len(basis) < vectors.shape[1] and len(rest):
        lengths = np.linalg.norm(rest, axis=1)
        longest = int(lengths.argmax())
        if not lengths[longest] > least:
            break
        unit = rest[longest] / lengths[longest]
        # Once more: what is left of a short remainder leans toward the basis.
        unit = unit - unit @ basis.T @ basis
        basis = np.vstack([basis, unit / np.linalg.norm(unit)])
        rest = rest - np.outer(rest @ basis[-1], basis[-1])
    return basis


def _of_polygon(points: Matrix) -> Facets:
    """Return the facets of points that span the plane."""
    corners = outline(points)
    edges = np.column_stack([corners, np.roll(corners, -1)])
    x, y = (points[edges[:, 1]] - points[edges[:, 0]]).T
    # Plus zero: no minus zeros in files.
    normals = np.column_stack([y, -x]) / np.hypot(x, y)[:, None] + 0.0
    offsets = (normals @ points.T).max(axis=1)
    first, _ = _faces(np.column_stack([normals, offsets]))
    return Facets(normals[first], offsets[first], corners, edges, 2)


def _of_body(points: Matrix) -> Facets:
    """Return the facets of points that span space."""
    hull = _qhull(points)
    first, face = _faces(hull.equations)
    equations = hull.equations[first]
    return Facets(
        normals=np.ascontiguousarray(equations[:, :-1]),
        offsets=np.ascontiguousarray(-equations[:, -1]),
        corners=hull.vertices.astype(np.int64),
        edges=_edges(hull, face),
        dimension=points.shape[1],
    )


def _qhull(points: Matrix) -> ConvexHull:
    """Return Qhull's faces of points that span space."""
    from scipy.spatial import ConvexHull, QhullError  # noqa: PLC0415 - the plane does without

    try:
        return ConvexHull(points)
    except (QhullError, ValueError) as error:
        raise _too_far() from error


def _too_far() -> ScenarioError:
    """Return the error of points spread too far."""
    return ScenarioError("has points too far apart to tell what they enclose")


def _faces(equations: Matrix) -> tuple[Indices, Indices]:
    """Return the first of equal planes, in their order, and which face each plane is of.

    Up to rounding: Qhull cuts facets into simplices, and a side may have a corner in it.
    """
    _, first, face = np.unique(
        np.round(equations, 9), axis=0, return_index=True, return_inverse=True
    )
    return np.sort(first), face.ravel()


def _edges(hull: ConvexHull, face: Indices) -> Indices:
    """Return the edges of a hull in space, (e, 2), given the face that each simplex is part of."""
    dimension = hull.simplices.shape[1]
    simplex, opposite = np.nonzero(face[:, None] != face[hull.neighbors])
    others = [[j for j in range(dimension) if j != i] for i in range(dimension)]
    sides = np.sort(hull.simplices[simplex[:, None], np.array(others)[opposite]], axis=1)
    return np.unique(sides, axis=0).astype(np.int64)


def _of_flat(points: Matrix, places: Matrix, along: Matrix, across: Matrix) -> Facets:
    """Return the facets of points that lie in a plane, on a line or at one place.

    Parameters
    ----------
    points : (p, d) array
        The points [m].
    places : (p, k) array
        Their coordinates in the set's own space, in any unit.
    along, across : (k, d) and (d - k, d) array
        Orthonormal bases of that space and of the rest.
    """
    sides = np.concatenate([across, -across])
    if len(along) == 0:
        normals, corners, edges = sides, np.array([0]), np.array([[0, 0]])
    elif len(along) == 1:
        corners = np.array([places[:, 0].argmin(), places[:, 0].argmax()])
        normals, edges = np.concatenate([along, -along, sides]), corners[None]
    else:
        own = _of_polygon(places)
        normals = np.concatenate([own.normals @ along, sides])
        corners, edges = own.corners, own.edges
    return Facets(normals, (normals @ points.T).max(axis=1), corners, edges, len(along))
