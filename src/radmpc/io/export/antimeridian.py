"""Shapes cut where the longitude jumps from 180° to -180° (RFC 7946, section 3.1.9).

Readers of maps draw straight from corner to corner, and would draw a line that crosses there
around the whole earth.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
import shapely

from radmpc.arrays import Matrix, Vector

__all__ = ["cut_area", "cut_face", "cut_line"]

_TURN = 360.0
"""Longitudes [°] that are one place."""

_BEYOND = 91.0
"""A latitude [°] that no place has."""


def cut_line(line: Matrix) -> list[Matrix]:
    """Return the parts of a line on either side of the antimeridian.

    Parameters
    ----------
    line : (k, c) array
        Longitude, latitude [°], height [m], and whatever else changes evenly along it.

    Returns
    -------
    list of (k, c) array
        In order, with a corner more at both ends of each cut; the line itself if it does not cross.
    """
    if not _jumps(line[:, 0]):
        return [line]
    rows = _with_cuts(_unrolled(line), 0.5 * _TURN)
    parts: list[list[Vector]] = []
    last = None
    for start, end in pairwise(rows):
        turn = _turn_of(start[0], end[0], last)
        if turn != last:
            parts.append([_turned(start, turn)])
        parts[-1].append(_turned(end, turn))
        last = turn
    return [np.array(part) for part in parts]


def cut_face(corners: Matrix) -> list[Matrix]:
    """Return the parts of a convex face, upright or not, on either side of the antimeridian.

    Parameters
    ----------
    corners : (v, 3) array
        Longitude, latitude [°] and height [m], in order, the first not repeated.

    Returns
    -------
    list of (v, 3) array
        Corners in the same order; the face itself if it does not cross.
    """
    if not _jumps(np.append(corners[:, 0], corners[0, 0])):
        return [corners]
    closed = _unrolled(np.vstack([corners, corners[:1]]))
    rows = _with_cuts(closed, 0.5 * _TURN)[:-1]
    parts = []
    for turn in _turns(rows):
        away = np.abs(rows[:, 0] - turn * _TURN)
        # A face on one side touches the other in an edge or a corner at most.
        if np.any(away < 0.5 * _TURN):
            parts.append(_turned(rows[away <= 0.5 * _TURN], turn))
    return parts or [_turned(rows, _turns(rows)[0])]


def cut_area(rings: Sequence[Matrix]) -> list[list[Matrix]]:
    """Return the parts of a polygon on either side of the antimeridian.

    Parameters
    ----------
    rings : sequence of (v, 3) array
        The outline and then holes: longitude, latitude [°] and height [m], in order, the first
        corner not repeated. An outline around a pole is led along the cut to the pole.

    Returns
    -------
    list of list of (v, 3) array
        Rings of each part, outlines counter-clockwise and holes clockwise; the polygon itself if
        it does not cross.
    """
    if not any(_jumps(np.append(ring[:, 0], ring[0, 0])) for ring in rings):
        return [list(rings)]
    outer, *holes = (_around(ring) for ring in rings)
    area = _valid(outer)
    for hole in holes:
        away = round((np.mean(outer[:, 0]) - np.mean(hole[:, 0])) / _TURN)
        area = shapely.difference(area, _valid(np.add(hole, [away * _TURN, 0.0, 0.0])))
    parts: list[list[Matrix]] = []
    for turn in _turns(outer):
        west, east = (turn - 0.5) * _TURN, (turn + 0.5) * _TURN
        side = shapely.intersection(area, shapely.box(west, -_BEYOND, east, _BEYOND))
        polygons = [one for one in shapely.get_parts(side) if one.geom_type == "Polygon"]
        for polygon in shapely.orient_polygons(polygons):
            borders = [polygon.exterior, *polygon.interiors]
            corners = [shapely.get_coordinates(ring, include_z=True)[:-1] for ring in borders]
            parts.append([_turned(ring, turn) for ring in corners])
    return parts


def _jumps(longitudes: Vector) -> bool:
    """Whether a line of such longitudes [°] crosses the antimeridian: the shorter way counts."""
    return bool(np.any(np.abs(np.diff(longitudes)) > 0.5 * _TURN))


def _unrolled(rows: Matrix) -> Matrix:
    """Return rows whose longitudes run on beyond 180° instead of jumping."""
    return np.column_stack([np.unwrap(rows[:, 0], period=_TURN), rows[:, 1:]])


def _with_cuts(rows: Matrix, meridian: float) -> Matrix:
    """Return rows with one more wherever they cross a meridian [°], however often turned."""
    found = [rows[:1]]
    for start, end in pairwise(rows):
        low, high = sorted([start[0], end[0]])
        first = np.floor((low - meridian) / _TURN) + 1.0
        crossed = meridian + _TURN * np.arange(first, np.ceil((high - meridian) / _TURN))
        for longitude in crossed if end[0] > start[0] else crossed[::-1]:
            share = (longitude - start[0]) / (end[0] - start[0])
            between = start + share * (end - start)
            between[0] = longitude
            found.append(_rounded(between)[None])
        found.append(end[None])
    return np.vstack(found)


def _turn_of(start: float, end: float, last: int | None) -> int:
    """Return how many turns [-] an edge lies from the usual longitudes."""
    is_along = start == end and (start / _TURN) % 1.0 == 0.5
    if is_along and last is not None:
        return last
    return int(np.floor(0.5 * (start + end) / _TURN + 0.5))


def _turns(rows: Matrix) -> range:
    """Return the turns [-] on which unrolled rows lie."""
    low, high = np.floor(np.array([rows[:, 0].min(), rows[:, 0].max()]) / _TURN + 0.5).astype(int)
    return range(int(low), int(high) + 1)


def _turned(rows: Matrix, turn: int) -> Matrix:
    """Return one row or several, turned back to the usual longitudes [°]."""
    moved = np.array(rows)
    moved[..., 0] -= turn * _TURN
    return _rounded(moved)


def _around(ring: Matrix) -> Matrix:
    """Return a ring unrolled, (v, 3); one around a pole goes along two meridians to the pole."""
    closed = _unrolled(np.vstack([ring, ring[:1]]))
    first, last = closed[0], closed[-1]
    if abs(last[0] - first[0]) < 0.5 * _TURN:
        return closed[:-1]
    pole = np.copysign(90.0, float(np.mean(ring[:, 1])))
    ends = [[last[0], pole, last[2]], [first[0], pole, first[2]]]
    return np.vstack([closed, ends])


def _valid(ring: Matrix) -> shapely.Geometry:
    """Return a ring as an area that can be cut: degrees bend what is large or near a pole."""
    polygon = shapely.Polygon(ring)
    return polygon if polygon.is_valid else shapely.make_valid(polygon)


def _rounded(rows: Matrix) -> Matrix:
    """Return rows to 1e-9° and 0.1 mm, and to 1e-6 of all else, without negative zeros."""
    digits = [9, 9, 4, *[6] * (rows.shape[-1] - 3)]
    rounded = [np.round(rows[..., i], digit) for i, digit in enumerate(digits)]
    return np.stack(rounded, axis=-1) + 0.0
