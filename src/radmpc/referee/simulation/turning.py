r"""A convex solid that turns or changes its shape: which straight paths come near it, exactly.

At time s from 0 to 1 the solid is the Minkowski interpolation :math:`M(s) = (1-s) P + s P'`. Its
support is linear in s, and so is :math:`n^\top x(s) - h_{M(s)}(n)` for a point x(s) at constant
velocity and any unit n. The distance from M(s) is the largest of them over n: convex in s. One
evaluation gives a line below it and so rules out one side of s; halving what is left ends soon.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from radmpc.arrays import Indices, Matrix, Tensor, Vector
from radmpc.facets import facets
from radmpc.records import dataclass
from radmpc.referee.contact import clipped

__all__ = ["TurningSolid", "comes_within", "turning"]

Flags = npt.NDArray[np.bool_]

_ROUNDS = 40
"""Halvings of the time in which a point may be near: 1e-12 of an interval is left."""

_BLOCK = 1_000_000
"""Numbers in the largest temporary array: memory against the overhead per block."""


@dataclass(frozen=True, slots=True, eq=False)
class TurningSolid:
    """A convex solid whose corners move linearly while its faces keep their normals.

    Attributes
    ----------
    normals : (f, d) array
        Outward unit normals of the interpolation, the same at all times between the ends [-].
    offsets : (2, f) array
        Supports along them at both ends [m].
    corners : (2, v, d) array
        Corners at both ends; those that fall together there part in between [m].
    edges : (e, 2) int array
        Which corners edges join.
    """

    normals: Matrix
    offsets: Matrix
    corners: Tensor
    edges: Indices

    def during(self, begin: float, end: float) -> TurningSolid:
        """Return the solid during a share of its time.

        Parameters
        ----------
        begin : float
            Share of its time, from 0.
        end : float
            Share of its time, to 1.
        """
        shares = np.array([begin, end])
        offsets = self.offsets[0] + shares[:, None] * (self.offsets[1] - self.offsets[0])
        moves = self.corners[1] - self.corners[0]
        corners = self.corners[0] + shares[:, None, None] * moves
        return TurningSolid(self.normals, offsets, corners, self.edges)


def turning(before: Matrix, after: Matrix) -> TurningSolid:
    """Return the Minkowski interpolation of the hulls of two sets of points.

    Parameters
    ----------
    before, after : (v, d) and (w, d) array
        Corners at both ends [m].
    """
    # Which pairs of corners are corners, edges and faces is the same at all inner times.
    middle = 0.5 * (before[:, None] + after[None])
    found = facets(middle.reshape(-1, before.shape[1]))
    used = np.unique(np.append(found.edges.ravel(), found.corners))
    first, second = np.divmod(used, len(after))
    supports = [(found.normals @ points.T).max(axis=1) for points in (before, after)]
    return TurningSolid(
        normals=found.normals,
        offsets=np.array(supports),
        corners=np.stack([before[first], after[second]]),
        edges=np.searchsorted(used, found.edges),
    )


def comes_within(begin: Matrix, end: Matrix, limits: Vector, solid: TurningSolid) -> Flags:
    """Return which points at constant velocity come closer to a solid than a limit, (M,) bool.

    Parameters
    ----------
    begin, end : (M, d) array
        Where they are when the solid is at its first and at its second end [m].
    limits : (M,) array
        Distances [m].
    solid : TurningSolid
        What to keep away from.
    """
    hits = np.zeros(len(begin), dtype=bool)
    size = max(1, _BLOCK // (len(solid.normals) + 2 * len(solid.edges) * begin.shape[1]))
    for start in range(0, len(begin), size):
        part = slice(start, start + size)
        hits[part] = _block_within(begin[part], end[part], limits[part], solid)
    return hits


def _block_within(begin: Matrix, end: Matrix, limits: Vector, solid: TurningSolid) -> Flags:
    """Return which points of a block come closer."""
    before = begin @ solid.normals.T - solid.offsets[0]
    after = end @ solid.normals.T - solid.offsets[1]
    enters, leaves = clipped(before, after)
    hits: Flags = (enters <= leaves) & (limits > 0.0)
    # Nearer than the limit to the planes of all faces: nothing else can be near.
    low, high = clipped(before - limits[:, None], after - limits[:, None])
    left = np.flatnonzero(~hits & (low <= high) & (limits > 0.0))
    for _ in range(_ROUNDS):
        if not left.size:
            break
        middle = 0.5 * (low[left] + high[left])
        place = begin[left] + middle[:, None] * (end[left] - begin[left])
        distance, away = _nearest(place, middle, solid)
        hits[left] = distance < limits[left]
        starts = _beyond(begin[left], away, solid.corners[0])
        slope = _beyond(end[left], away, solid.corners[1]) - starts
        # Where the line below the distance falls to the limit; a level one never does.
        over = starts + middle * slope - limits[left]
        level = slope == 0.0
        meets = middle - over / np.where(level, 1.0, slope)
        high[left] = np.where(slope > 0.0, np.minimum(high[left], meets), high[left])
        low[left] = np.where(slope < 0.0, np.maximum(low[left], meets), low[left])
        left = left[~hits[left] & ~level & (low[left] <= high[left])]
    return hits


def _beyond(points: Matrix, normals: Matrix, corners: Matrix) -> Vector:
    """Return how far each point is beyond corners along a normal of its own [m]."""
    ahead = np.einsum("md,md->m", points, normals)
    return np.asarray(ahead - (normals @ corners.T).max(axis=1))


def _nearest(points: Matrix, times: Vector, solid: TurningSolid) -> tuple[Vector, Matrix]:
    """Return the distance of points outside from the solid at times of their own, and its normal.

    If the nearest point lies within a face, no other face is farther below the point.
    """
    moves = solid.corners[1] - solid.corners[0]
    corners = solid.corners[0] + times[:, None, None] * moves
    foot = corners[:, solid.edges[:, 0]]
    along = corners[:, solid.edges[:, 1]] - foot
    length2 = np.einsum("med,med->me", along, along)
    share = np.einsum("med,med->me", points[:, None] - foot, along)
    share = np.clip(share / np.where(length2 > 0.0, length2, 1.0), 0.0, 1.0)
    gaps = points[:, None] - foot - share[..., None] * along
    squares = np.einsum("med,med->me", gaps, gaps)
    rows = np.arange(len(points))
    edge = squares.argmin(axis=1)
    distance = np.sqrt(squares[rows, edge])
    away = gaps[rows, edge] / np.where(distance > 0.0, distance, 1.0)[:, None]
    if points.shape[1] == 2:
        return distance, away
    offsets = solid.offsets[0] + times[:, None] * (solid.offsets[1] - solid.offsets[0])
    heights = points @ solid.normals.T - offsets
    face = heights.argmax(axis=1)
    height, normal = heights[rows, face], solid.normals[face]
    excess = heights - height[:, None] * (normal @ solid.normals.T)
    lands = excess.max(axis=1) <= 1e-9 * (1.0 + np.abs(height))
    distance = np.where(lands, np.maximum(height, 0.0), distance)
    return distance, np.where(lands[:, None], normal, away)
