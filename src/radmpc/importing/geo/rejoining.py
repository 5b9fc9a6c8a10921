"""Shapes that were cut at the antimeridian, as RFC 7946 wants them, become whole again."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

import numpy as np
import shapely

from radmpc.arrays import Matrix
from radmpc.importing.geo.feature import Feature

__all__ = ["rejoined"]

_ROUNDING = 3e-9
"""How far beside an edge [°] a corner of a cut may lie: degrees are written to 1e-9."""


def rejoined(parts: Iterable[Feature]) -> list[Feature]:
    """Return the shapes of one feature, those whole that were cut at the antimeridian.

    Parameters
    ----------
    parts : iterable of Feature
        In the order of the file.

    Returns
    -------
    list of Feature
        Lines of which one ends where the next begins, and polygons with a common side, both there,
        are one; without the corners that only the cut made.
    """
    whole: list[Feature] = []
    for part in parts:
        shape, i = part, 0
        while i < len(whole):
            rings = _together(whole[i], shape)
            # What became larger may meet those that its parts did not meet.
            shape, i = (shape, i + 1) if rings is None else (replace(whole.pop(i), rings=rings), 0)
        whole.append(shape)
    return whole


def _together(one: Feature, two: Feature) -> tuple[Matrix, ...] | None:
    """Return the rings of two parts as one shape, None where they do not meet at the cut."""
    if one.kind != two.kind or not (_touches(one) and _touches(two)):
        return None
    if one.kind == "LineString":
        (first,), (second,) = one.rings, two.rings
        ends = np.abs([first[-1, :2], second[0, :2]])
        if not (ends[0, 0] == ends[1, 0] == 180.0 and first[-1, 1] == second[0, 1]):
            return None
        line = _eastern(np.vstack([first, second[1:]]))
        return (_western(_without_cuts(line, is_closed=False)),)
    areas = [shapely.Polygon(*_border_and_holes(part)) for part in (one, two)]
    if not all(area.is_valid for area in areas):
        return None
    area = shapely.union(*areas)
    if area.geom_type != "Polygon":
        return None
    borders = [shapely.get_coordinates(ring, include_z=True)[:-1] for ring in _rings(area)]
    return tuple(_western(_without_cuts(ring, is_closed=True)) for ring in borders)


def _border_and_holes(polygon: Feature) -> tuple[Matrix, list[Matrix]]:
    """Return a polygon's rings without the jump."""
    outer, *holes = (_eastern(ring) for ring in polygon.rings)
    return outer, holes


def _rings(area: shapely.Polygon) -> list[shapely.LinearRing]:
    """Return the outline and the holes of an area."""
    return [area.exterior, *area.interiors]


def _touches(feature: Feature) -> bool:
    """Whether a line or polygon has corners on the antimeridian."""
    is_shape = feature.kind != "Point"
    return is_shape and any(np.any(np.abs(ring[:, 0]) == 180.0) for ring in feature.rings)


def _eastern(ring: Matrix) -> Matrix:
    """Return positions whose longitudes run from 0° to 360°, without the jump."""
    return np.column_stack(
        [np.where(ring[:, 0] < 0.0, ring[:, 0] + 360.0, ring[:, 0]), ring[:, 1:]]
    )


def _western(ring: Matrix) -> Matrix:
    """Return positions whose longitudes run from -180° to 180°; undoes `_eastern`."""
    # What the sum had lost comes back by rounding.
    longitudes = np.where(ring[:, 0] > 180.0, np.round(ring[:, 0] - 360.0, 12), ring[:, 0])
    return np.column_stack([longitudes, ring[:, 1:]])


def _without_cuts(ring: Matrix, *, is_closed: bool) -> Matrix:
    """Return positions without those at 180° that lie on the line between their neighbors."""
    kept = []
    for i, corner in enumerate(ring):
        is_end = not is_closed and i in {0, len(ring) - 1}
        before, after = ring[i - 1, :2], ring[(i + 1) % len(ring), :2]
        way, aside = after - before, corner[:2] - before
        cross = abs(way[0] * aside[1] - way[1] * aside[0])
        is_cut = corner[0] == 180.0 and cross <= _ROUNDING * np.linalg.norm(way)
        if is_end or not is_cut:
            kept.append(corner)
    return np.array(kept)
