"""Shortest ways around convex pieces in the plane, as times at full speed along each axis.

Pieces are grown by polygons within the disc of the hull, so that ways are no longer than any way of
the hull. A way that bends only at corners of these is shortest in every norm: whatever is cut off
makes no norm longer.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from radmpc.arrays import Matrix, Vector
from radmpc.geometry.polytope import Polytope, hull
from radmpc.records import dataclass

__all__ = ["Corners", "corners_around"]

_SIDES = 8
"""Corners of the polygon that stands for a hull's disc [-]."""

_MOST = 6_000_000
"""Pairs of corners times faces up to which ways are looked at [-]: some tenths of a second."""

_GRAZED = 1e-7
"""Depth up to which a way may lead into a piece [m]: corners are on its border."""


@dataclass(frozen=True, slots=True, eq=False)
class Corners:
    """Where ways around pieces bend.

    Attributes
    ----------
    grown : tuple of Polytope
        The pieces, grown by the hull.
    points : (c, 2) array
        Their corners that a hull's center may be at [m].
    is_seen : (c, c) bool array
        Whether there is a straight way from one to another.
    """

    grown: tuple[Polytope, ...]
    points: Matrix
    is_seen: npt.NDArray[np.bool_]

    def times(self, stops: Matrix, speed: Vector) -> Vector:
        """Return the least time from each stop to the next, (s-1,) [s]; inf without a way.

        Parameters
        ----------
        stops : (s, 2) array
            Places that are in no grown piece [m].
        speed : (2,) array
            Largest speed along each axis [m/s].
        """
        points = np.vstack([self.points, stops])
        count = len(points)
        is_seen = np.zeros((count, count), dtype=bool)
        is_seen[: -len(stops), : -len(stops)] = self.is_seen
        views = _seen(stops, points, self.grown)
        is_seen[-len(stops) :] = views
        is_seen[:, -len(stops) :] |= views.T
        lengths = (np.abs(points[:, None] - points) / speed).max(axis=-1)
        links = np.where(is_seen, lengths, np.inf)
        first = range(count - len(stops), count - 1)
        return np.array([_shortest(links, i, i + 1) for i in first])


def corners_around(
    pieces: Sequence[Polytope], radius: float, border: tuple[Vector, Vector] | None
) -> Corners | None:
    """Return where ways of a hull around pieces bend.

    Parameters
    ----------
    pieces : sequence of Polytope
        In the plane, at least one.
    radius : float
        Hull radius [m].
    border : pair of (2,) array or None
        Corners of the box that its center keeps to [m].

    Returns
    -------
    Corners or None
        None where there are too many.
    """
    angles = np.arange(_SIDES) * (2.0 * np.pi / _SIDES)
    disc = radius * np.column_stack([np.cos(angles), np.sin(angles)])
    count = sum(_SIDES + len(piece.vertices) for piece in pieces)
    if count**3 > _MOST:
        return None
    grown = tuple(hull((piece.vertices[:, None] + disc).reshape(-1, 2)) for piece in pieces)
    points = np.vstack([piece.vertices for piece in grown])
    if border is not None:
        points = points[np.all((points >= border[0]) & (points <= border[1]), axis=1)]
    is_within = np.zeros(len(points), dtype=bool)
    for piece in grown:
        is_within |= (points @ piece.normals.T - piece.offsets).max(axis=1) < -_GRAZED
    points = points[~is_within]
    return Corners(grown, points, _seen(points, points, grown))


def _shortest(links: Matrix, begin: int, end: int) -> float:
    """Return the length of the shortest way through a graph that is as good as complete."""
    lengths = np.full(len(links), np.inf)
    lengths[begin] = 0.0
    left = lengths.copy()
    while np.isfinite(left).any():
        nearest = int(left.argmin())
        if nearest == end:
            break
        is_nearer = lengths[nearest] + links[nearest] < lengths
        lengths[is_nearer] = lengths[nearest] + links[nearest, is_nearer]
        left[is_nearer] = lengths[is_nearer]
        left[nearest] = np.inf
    return float(lengths[end])


def _seen(begins: Matrix, ends: Matrix, grown: Sequence[Polytope]) -> npt.NDArray[np.bool_]:
    """Return from where there is a straight way to where."""
    is_seen = np.ones((len(begins), len(ends)), dtype=bool)
    for piece in grown:
        rows, columns = np.nonzero(is_seen & ~_aside(begins, ends, piece))
        first = begins @ piece.normals.T - piece.offsets + _GRAZED
        last = ends @ piece.normals.T - piece.offsets + _GRAZED
        one, other = first[rows], last[columns]
        fall = one - other
        shares = one / np.where(fall == 0.0, 1.0, fall)
        enters = np.where(fall > 0.0, shares, np.where((fall == 0.0) & (one >= 0.0), 2.0, 0.0))
        leaves = np.where(fall < 0.0, shares, 1.0)
        is_shut = np.maximum(enters.max(axis=1), 0.0) < np.minimum(leaves.min(axis=1), 1.0)
        is_seen[rows[is_shut], columns[is_shut]] = False
    return is_seen


def _aside(begins: Matrix, ends: Matrix, piece: Polytope) -> npt.NDArray[np.bool_]:
    """Whether both ends are on the same side of the box around a piece."""
    low, high = piece.vertices.min(axis=0), piece.vertices.max(axis=0)
    is_aside = np.zeros((len(begins), len(ends)), dtype=bool)
    for axis in range(2):
        one, other = begins[:, axis], ends[:, axis]
        is_aside |= (one <= low[axis])[:, None] & (other <= low[axis])
        is_aside |= (one >= high[axis])[:, None] & (other >= high[axis])
    return is_aside
