"""Exact distances along straight segments: to the origin, and to convex solids."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from radmpc.arrays import Matrix, Tensor, Vector
from radmpc.facets import facets
from radmpc.geometry import Polytope
from radmpc.records import dataclass

__all__ = ["Solid", "clipped", "origin_distances", "solid_distances", "solid_of"]

Flags = npt.NDArray[np.bool_]

_ROUNDING = 1e-14
"""What a crossing may miss by, per meter of the largest height [-]: a wall without thickness is
left where it is entered, and both are rounded."""


@dataclass(frozen=True, slots=True, eq=False)
class Solid:
    """A convex polytope, flat or not, with everything a nearest point can lie on.

    Attributes
    ----------
    normals : (f, d) array
        Outward unit normals [-].
    offsets : (f,) array
        ``normals @ x <= offsets`` inside [m].
    vertices : (v, d) array
        Corners [m].
    edges : (e, 2, d) array
        Ends of the edges; the sides of a polygon; of a point it and itself [m].
    """

    normals: Matrix
    offsets: Vector
    vertices: Matrix
    edges: Tensor


def solid_of(piece: Polytope) -> Solid:
    """Return a polytope with its edges."""
    found = facets(piece.vertices)
    return Solid(piece.normals, piece.offsets, piece.vertices, piece.vertices[found.edges])


def origin_distances(begin: Tensor, end: Tensor) -> Vector:
    """Return the distance of the origin from each segment.

    Parameters
    ----------
    begin, end : (..., d) array
        Ends of the segments; they may coincide [m].

    Returns
    -------
    (...) array
        Distances [m].
    """
    return _point_to_segment(np.zeros(begin.shape[-1]), begin, end)


def _point_to_segment(point: Tensor, begin: Tensor, end: Tensor) -> Vector:
    """Return distances of points from segments, broadcast against each other."""
    along = end - begin
    length2 = np.square(along).sum(axis=-1)
    t = ((point - begin) * along).sum(axis=-1) / np.where(length2 > 0.0, length2, 1.0)
    foot = begin + np.clip(t, 0.0, 1.0)[..., None] * along
    return np.asarray(np.linalg.norm(point - foot, axis=-1))


def solid_distances(begin: Matrix, end: Matrix, solid: Solid) -> Vector:
    """Return the distance of each segment from a solid, 0 where they meet.

    Unless they meet, the nearest points are a corner and the segment, an edge and an end, in space
    also two inner points of an edge and the segment, or a face and an end.

    Parameters
    ----------
    begin, end : (M, d) array
        Ends of the segments; they may coincide [m].
    solid : Solid
        What to keep away from.

    Returns
    -------
    (M,) array
        Distances [m].
    """
    corners = _point_to_segment(solid.vertices, begin[:, None], end[:, None])
    edge_begin, edge_end = solid.edges[:, 0], solid.edges[:, 1]
    from_begin = _point_to_segment(begin[:, None], edge_begin, edge_end)
    from_end = _point_to_segment(end[:, None], edge_begin, edge_end)
    nearest = np.minimum(corners.min(axis=1), np.minimum(from_begin, from_end).min(axis=1))
    if begin.shape[1] == 3:
        nearest = np.minimum(nearest, _between_lines(begin, end, solid).min(axis=1))
        for point in (begin, end):
            nearest = np.minimum(nearest, _above_faces(point, solid).min(axis=1))
    return np.where(_meets(begin, end, solid), 0.0, nearest)


def _meets(begin: Matrix, end: Matrix, solid: Solid) -> Flags:
    """Whether segments reach into a solid: clip them by all faces."""
    enters, leaves = clipped(
        begin @ solid.normals.T - solid.offsets, end @ solid.normals.T - solid.offsets
    )
    inside: Flags = enters <= leaves
    return inside


def clipped(before: Matrix, after: Matrix) -> tuple[Vector, Vector]:
    """Return from when to when points are below all faces, as shares of their way.

    Parameters
    ----------
    before, after : (M, f) array
        Heights above each face at both ends; linear in between [m].

    Returns
    -------
    enters, leaves : (M,) array
        Shares from 0 to 1; one that is never below all enters after it leaves.
    """
    slack = _ROUNDING * np.maximum(np.abs(before), np.abs(after)).max(axis=1, keepdims=True)
    before, after = before - slack, after - slack
    drop = before - after
    crossing = before / np.where(drop == 0.0, 1.0, drop)
    # Outside a face all along: enter after the end.
    enters = np.where(before > 0.0, np.where(after > 0.0, 2.0, crossing), 0.0)
    leaves = np.where((before <= 0.0) & (after > 0.0), crossing, 1.0)
    return np.asarray(enters.max(axis=1)), np.asarray(leaves.min(axis=1))


def _between_lines(begin: Matrix, end: Matrix, solid: Solid) -> Tensor:
    """Return distances between inner points of segments and edges, inf where they have none."""
    u = (end - begin)[:, None]
    v = solid.edges[:, 1] - solid.edges[:, 0]
    w = begin[:, None] - solid.edges[:, 0]
    uu, vv, uv = (u * u).sum(-1), (v * v).sum(-1), (u * v).sum(-1)
    uw, vw = (u * w).sum(-1), (v * w).sum(-1)
    determinant = uu * vv - uv**2
    parallel = determinant <= 1e-12 * uu * vv
    scale = np.where(parallel, 1.0, determinant)
    s, t = (uv * vw - vv * uw) / scale, (uu * vw - uv * uw) / scale
    inner = ~parallel & (s >= 0.0) & (s <= 1.0) & (t >= 0.0) & (t <= 1.0)
    gap = np.linalg.norm(w + s[..., None] * u - t[..., None] * v, axis=-1)
    return np.where(inner, gap, np.inf)


def _above_faces(points: Matrix, solid: Solid) -> Tensor:
    """Return heights of points above the faces they project onto, inf elsewhere."""
    heights = points @ solid.normals.T - solid.offsets
    feet = points[:, None] - heights[..., None] * solid.normals
    excess = np.einsum("mfd,gd->mfg", feet, solid.normals) - solid.offsets
    lands = (heights >= 0.0) & (excess.max(axis=2) <= 1e-9 * (1.0 + np.abs(heights)))
    return np.where(lands, heights, np.inf)
