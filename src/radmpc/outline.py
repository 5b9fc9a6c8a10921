"""Corners of convex hulls in the plane, without Qhull: it takes a quarter of a second to load."""

from __future__ import annotations

import math

import numpy as np

from radmpc.arrays import Indices, Matrix

__all__ = ["outline"]

_STRAIGHT = 4e-15
"""Distance from the line between its neighbors up to which a corner is none, relative to the
largest coordinate. Above what the coordinates of points on one line are rounded by (5e-16 for
turned rectangles up to 10 km from the origin), and where Qhull draws the line as well: it drops
corners from 3e-15 to 6e-15 down."""


def outline(points: Matrix) -> Indices:
    """Return which points are corners of the hull of points in the plane.

    By a monotone chain: the points in the order of their first coordinate, once along the lower
    side and once back along the upper.

    Parameters
    ----------
    points : (p, 2) array
        Not all on one line, up to rounding.

    Returns
    -------
    (v,) int array
        At least three, counter-clockwise: one of every place, none on the line between others.
    """
    # Scaled, or the squares of tiny coordinates would be zero.
    x, y = (points / np.abs(points).max()).T
    order = np.lexsort((y, x)).tolist()
    x, y = x.tolist(), y.tolist()
    lower, upper = _chain(order, x, y), _chain(order[::-1], x, y)
    return np.array(_without_straight(lower[:-1] + upper[:-1], x, y), dtype=np.int64)


def _turn(before: int, corner: int, after: int, x: list[float], y: list[float]) -> float:
    """Return twice the area of a triangle, positive where it is counter-clockwise."""
    along = (x[after] - x[before]) * (y[corner] - y[before])
    return (x[corner] - x[before]) * (y[after] - y[before]) - along


def _chain(order: list[int], x: list[float], y: list[float]) -> list[int]:
    """Return one side of the hull, from the first point to the last with left turns only."""
    kept: list[int] = []
    for i in order:
        if kept and x[i] == x[kept[-1]] and y[i] == y[kept[-1]]:
            continue
        while len(kept) > 1 and _turn(kept[-2], kept[-1], i, x, y) <= 0.0:
            kept.pop()
        kept.append(i)
    return kept


def _without_straight(corners: list[int], x: list[float], y: list[float]) -> list[int]:
    """Return corners without those that rounding made: where sides meet and at both ends too."""
    num_kept = i = 0
    # Once around without one to drop.
    while num_kept < len(corners) > 3:
        before, corner, after = corners[i - 1], corners[i], corners[(i + 1) % len(corners)]
        length = math.hypot(x[after] - x[before], y[after] - y[before])
        if _turn(before, corner, after, x, y) <= _STRAIGHT * length:
            del corners[i]
            num_kept = 0
            i = max(i - 1, 0)
        else:
            num_kept += 1
            i += 1
        i %= len(corners)
    return corners
