"""Neighbors among points in rows and columns, and what stands between them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
import numpy.typing as npt
import shapely

from radmpc.arrays import Indices, Matrix, Vector

__all__ = ["blocked_steps", "neighbors"]

_DIRECTIONS = ((0, 1), (1, 0), (1, 1), (1, -1))
"""From a point to its neighbors, in rows and columns; the opposite ones are theirs."""

_ROUNDING = 1e-9
"""Share by which distances may be larger than they are [-]."""


def neighbors(shape: tuple[int, ...]) -> Iterator[tuple[Indices, Indices]]:
    """Yield the numbers of points and of their neighbors, one direction after the other.

    Parameters
    ----------
    shape : (int, int)
        How many rows and columns there are.

    Yields
    ------
    first, second : int arrays of one shape
        Points are numbered row by row from 0.
    """
    index = np.arange(shape[0] * shape[1]).reshape(shape)
    for down, right in _DIRECTIONS:
        first = index[: shape[0] - down, max(-right, 0) : shape[1] - max(right, 0)]
        yield first, index[down:, max(right, 0) : shape[1] - max(-right, 0)]


def blocked_steps(
    distances: Matrix, axes: Sequence[Vector], pieces: Sequence[shapely.Geometry]
) -> npt.NDArray[np.bool_] | None:
    """Return between which neighbors a piece stands, however thin it is.

    Parameters
    ----------
    distances : (p, q) array
        From each point to the nearest piece at most, 0 within [m].
    axes : sequence of two arrays, (p,) and (q,)
        Coordinates of the rows and of the columns [m].
    pieces : sequence of shapely.Geometry
        Polygons, lines and points.

    Returns
    -------
    (4, p, q) bool array or None
        By the direction, in the order of `neighbors`, and the first of both points. Only points
        outside all pieces count. None where no piece stands between any.
    """
    blocked = np.zeros((len(_DIRECTIONS), *distances.shape), dtype=bool)
    points = np.column_stack([one.ravel() for one in np.meshgrid(*axes, indexing="ij")])
    away, tree = distances.ravel(), shapely.STRtree(pieces)
    for number, (first, second) in enumerate(neighbors(distances.shape)):
        apart = np.linalg.norm(points[second] - points[first], axis=-1)
        nearest = np.minimum(away[first], away[second])
        # What stands between two points is no farther than half their distance from one of them.
        is_near = (nearest > 0.0) & (nearest <= 0.5 * apart * (1.0 + _ROUNDING))
        begins = first[is_near]
        moves = shapely.linestrings(np.stack([points[begins], points[second[is_near]]], axis=1))
        met = tree.query(moves, predicate="intersects")[0]
        blocked[number].ravel()[begins[met]] = True
    return blocked if blocked.any() else None
