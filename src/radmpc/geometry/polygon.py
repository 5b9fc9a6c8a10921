"""Polygons in the plane: convex pieces of theirs, and as shapely has them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy.typing as npt

from radmpc.arrays import Matrix, as_matrix
from radmpc.geometry.polytope import Polytope, hull

if TYPE_CHECKING:
    import shapely

__all__ = ["convex_pieces", "planar"]


def planar(piece: Polytope) -> shapely.Geometry:
    """Return a set in the plane as shapely has it: a polygon, a line or a point."""
    import shapely  # noqa: PLC0415 - convex obstacles do without until they are drawn

    corners = piece.vertices
    if len(corners) == 1:
        return shapely.Point(corners[0])
    return shapely.LineString(corners) if len(corners) == 2 else shapely.Polygon(corners)


def convex_pieces(
    vertices: npt.ArrayLike, holes: Sequence[npt.ArrayLike] = ()
) -> tuple[Polytope, ...]:
    """Split a simple polygon into convex pieces that cover it exactly.

    Parameters
    ----------
    vertices : (v, 2) array_like
        Corners in order, either way round; all on one line make a segment [m].
    holes : sequence of (h, 2) array_like
        Corners of what is left out, in order, either way round [m].

    Returns
    -------
    tuple of Polytope
        One piece where the polygon is convex.

    Raises
    ------
    ScenarioError
        If there is no corner, an outline crosses itself, or holes are not within it, apart.
    """
    outline = as_matrix(vertices, (None, 2))
    around = hull(outline)
    free = [as_matrix(hole, (None, 2)) for hole in holes]
    if not free and (len(around.vertices) < 3 or _goes_around(outline, around.vertices)):
        return (around,)
    from radmpc.geometry.splitting import split  # noqa: PLC0415 - loads shapely

    return split(outline, around, free)


def _goes_around(outline: Matrix, corners: Matrix) -> bool:
    """Whether an outline has these corners and no others, in this order or backwards."""
    if len(outline) != len(corners):
        return False
    places: list[list[float]] = outline.tolist()
    wanted: list[list[float]] = corners.tolist()
    first = places.index(wanted[0])
    onward = places[first:] + places[:first]
    return onward == wanted or [onward[0], *onward[:0:-1]] == wanted
