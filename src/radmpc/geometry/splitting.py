"""Polygons that are not convex, split into convex pieces."""

from __future__ import annotations

import heapq
from collections.abc import Sequence
from itertools import pairwise

import numpy as np
import shapely

from radmpc.arrays import Matrix
from radmpc.errors import ScenarioError
from radmpc.geometry.polytope import Polytope, hull

__all__ = ["split"]


def split(outline: Matrix, around: Polytope, holes: Sequence[Matrix] = ()) -> tuple[Polytope, ...]:
    """Split a simple polygon into convex pieces that cover it exactly.

    Parameters
    ----------
    outline : (v, 2) array
        Corners in order, either way round [m].
    around : Polytope
        Its hull, which is returned where the polygon fills it.
    holes : sequence of (h, 2) array
        Corners of what is left out, in order, either way round [m].

    Raises
    ------
    ScenarioError
        If an outline crosses itself, or holes are not within it, apart from one another.
    """
    few = next((len(hole) for hole in holes if len(hole) < 3), None)
    if few is not None or (holes and len(outline) < 3):
        which = "the outline" if few is None else "every hole"
        number = len(outline) if few is None else few
        raise ScenarioError(f"{which} must have at least 3 corners, got {number}")
    polygon = shapely.Polygon(outline, holes)
    if not polygon.is_valid or polygon.area <= 0.0:
        why = shapely.is_valid_reason(polygon)
        raise ScenarioError(f"must be a simple polygon with an area, got one with: {why}")
    if not holes and _is_convex(polygon):
        return (around,)
    pieces = list(shapely.constrained_delaunay_triangles(polygon).geoms)
    return tuple(hull(np.array(piece.exterior.coords)[:-1]) for piece in _merge_convex(pieces))


def _merge_convex(pieces: list[shapely.Geometry]) -> list[shapely.Geometry]:
    """Join triangles as long as the union stays convex: fewer pieces, fewer avoidances."""
    left, neighbors = dict(enumerate(pieces)), _neighbors(pieces)
    # The first pair that can be joined is, until none can; a pair that changed is asked again.
    pairs = [(i, j) for i, others in neighbors.items() for j in others if i < j]
    heapq.heapify(pairs)
    while pairs:
        i, j = heapq.heappop(pairs)
        union = shapely.union(left[i], left[j]) if i in left and j in left else None
        if union is None or union.geom_type != "Polygon" or not _is_convex(union):
            continue
        left[i], taken = union, left.pop(j)
        neighbors[i] = (neighbors[i] | neighbors.pop(j)) - {i, j}
        for k in neighbors[i]:
            neighbors[k] = (neighbors[k] - {j}) | {i}
            if shapely.intersects(taken, left[k]):  # elsewhere all corners are as they were
                heapq.heappush(pairs, (min(i, k), max(i, k)))
    return list(left.values())


def _neighbors(triangles: list[shapely.Geometry]) -> dict[int, set[int]]:
    """Return which triangles share an edge with each."""
    owners: dict[frozenset[tuple[float, ...]], int] = {}
    neighbors: dict[int, set[int]] = {i: set() for i in range(len(triangles))}
    for i, triangle in enumerate(triangles):
        for edge in pairwise(triangle.exterior.coords):
            j = owners.setdefault(frozenset(edge), i)
            if j != i:
                neighbors[i].add(j)
                neighbors[j].add(i)
    return neighbors


def _is_convex(polygon: shapely.Geometry) -> bool:
    """Whether a polygon fills its hull, up to rounding."""
    return bool(polygon.convex_hull.area - polygon.area <= 1e-12 * polygon.convex_hull.area)
