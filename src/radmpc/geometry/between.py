"""Nearest points of convex pieces in the plane, for many pairs at a time."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from radmpc.arrays import Indices, Matrix, Tensor, Vector
from radmpc.geometry.polytope import Polytope

__all__ = ["nearest_points", "outlines_of_equal_length"]

_ENTRIES = 2_000_000
"""Pairs of corners that are looked at together at most [-]: some 100 MB."""


def outlines_of_equal_length(pieces: Sequence[Polytope]) -> Tensor:
    """Return the corners of pieces, (p, v, 2) [m]; the last is repeated where there are fewer.

    Parameters
    ----------
    pieces : sequence of Polytope
        At least one, in the plane.
    """
    most = max(len(piece.vertices) for piece in pieces)
    padded = [
        piece.vertices[np.minimum(np.arange(most), len(piece.vertices) - 1)] for piece in pieces
    ]
    return np.stack(padded)


def nearest_points(outlines: Tensor, pairs: Indices) -> tuple[Vector, Matrix, Matrix]:
    """Return how near pieces are to each other, and where.

    Parameters
    ----------
    outlines : (p, v, 2) array
        Corners of convex pieces, see `outlines_of_equal_length` [m].
    pairs : (k, 2) int array
        Which two.

    Returns
    -------
    distances : (k,) array
        0 where they touch or overlap [m].
    first, second : (k, 2) array
        A point of either at that distance, the same where they touch or overlap [m].
    """
    distances = np.empty(len(pairs))
    first, second = np.empty((len(pairs), 2)), np.empty((len(pairs), 2))
    count = max(1, _ENTRIES // outlines.shape[1] ** 2)
    for begin in range(0, len(pairs), count):
        part = slice(begin, begin + count)
        one, other = outlines[pairs[part, 0]], outlines[pairs[part, 1]]
        found = _to_corners(one, other)
        back = _to_corners(other, one)
        is_back = back[0] < found[0]
        distances[part] = np.where(is_back, back[0], found[0])
        first[part] = np.where(is_back[:, None], back[2], found[1])
        second[part] = np.where(is_back[:, None], back[1], found[2])
        shared, is_shared = _shared(one, other)
        distances[part] = np.where(is_shared, 0.0, distances[part])
        first[part] = np.where(is_shared[:, None], shared, first[part])
        second[part] = np.where(is_shared[:, None], shared, second[part])
    return distances, first, second


def _to_corners(one: Tensor, other: Tensor) -> tuple[Vector, Matrix, Matrix]:
    """Return how near corners of the others are to outlines, with the points on both."""
    begins = one[:, None]
    along = np.roll(one, -1, axis=1)[:, None] - begins
    corners = other[:, :, None]
    squares = np.square(along).sum(axis=-1)
    shares = ((corners - begins) * along).sum(axis=-1) / np.where(squares > 0.0, squares, 1.0)
    feet = begins + np.clip(shares, 0.0, 1.0)[..., None] * along
    gaps = np.square(corners - feet).sum(axis=-1)
    best = gaps.reshape(len(one), -1).argmin(axis=1)
    rows = np.arange(len(one))
    corner = best // one.shape[1]
    return (
        np.sqrt(gaps.reshape(len(one), -1)[rows, best]),
        feet.reshape(len(one), -1, 2)[rows, best],
        other[rows, corner],
    )


def _shared(one: Tensor, other: Tensor) -> tuple[Matrix, Vector]:
    """Return a point within both pieces, and whether there is one that this finds.

    Either outlines cross, or a corner of one is within the other.
    """
    points, is_found = _crossings(one, other)
    for inner, outer in ((one, other), (other, one)):
        begins = outer[:, None]
        along = np.roll(outer, -1, axis=1)[:, None] - begins
        toward = inner[:, :, None] - begins
        is_left = along[..., 0] * toward[..., 1] >= along[..., 1] * toward[..., 0]
        # Segments have no inside: on a line everything is to the left of both of its sides.
        area = np.abs(_cross(outer[:, 1:-1] - outer[:, :1], outer[:, 2:] - outer[:, :1])).sum(
            axis=1
        )
        is_within = is_left.all(axis=2) & (area > 0.0)[:, None]
        which = is_within.argmax(axis=1)
        is_new = is_within.any(axis=1) & np.logical_not(is_found)
        points = np.where(is_new[:, None], inner[np.arange(len(one)), which], points)
        is_found = is_found | is_new
    return points, is_found


def _crossings(one: Tensor, other: Tensor) -> tuple[Matrix, Vector]:
    """Return a point where outlines cross, and whether they do."""
    begins, others = one[:, :, None], other[:, None]
    along = np.roll(one, -1, axis=1)[:, :, None] - begins
    across = np.roll(other, -1, axis=1)[:, None] - others
    turn = _cross(along, across)
    between = others - begins
    is_across = turn != 0.0
    safe = np.where(is_across, turn, 1.0)
    share, of_other = _cross(between, across) / safe, _cross(between, along) / safe
    is_met = is_across & (share >= 0.0) & (share <= 1.0) & (of_other >= 0.0) & (of_other <= 1.0)
    count = len(one)
    which = is_met.reshape(count, -1).argmax(axis=1)
    rows = np.arange(count)
    points = (begins + share[..., None] * along).reshape(count, -1, 2)[rows, which]
    return points, is_met.reshape(count, -1).any(axis=1)


def _cross(one: Tensor, other: Tensor) -> Tensor:
    """Return the third component of cross products."""
    return np.asarray(one[..., 0] * other[..., 1] - one[..., 1] * other[..., 0])
