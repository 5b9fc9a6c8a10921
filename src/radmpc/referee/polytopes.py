"""Polytopes within the unit disc or ball, of few faces and of many."""

from __future__ import annotations

from functools import cache

import numpy as np

from radmpc.arrays import Matrix

__all__ = ["polytopes_within"]

_SIDES = (4, 8, 16, 32)
"""Corners of the polygons in the plane [-]."""

_FINENESS = (2, 3, 5)
"""Points along the edges of cubes through which faces of polytopes in space are laid [-]: 8, 26
and 98 faces."""


@cache
def polytopes_within(dimension: int) -> tuple[tuple[Matrix, float], ...]:
    """Return polytopes that touch the border with their corners.

    Parameters
    ----------
    dimension : int
        2 or 3.

    Returns
    -------
    tuple of ((f, d) array, float)
        Of each its unit normals, outward, and the distance of all its faces from the middle.
    """
    found = []
    if dimension == 2:
        for sides in _SIDES:
            turn = 2.0 * np.pi / sides * np.arange(sides)
            normals = np.stack([np.cos(turn), np.sin(turn)], axis=1)
            found.append((normals, float(np.cos(np.pi / sides))))
        return tuple(found)
    from scipy.spatial import ConvexHull  # noqa: PLC0415 - the plane does without

    for fineness in _FINENESS:
        grid = np.linspace(-1.0, 1.0, fineness)
        points = np.array(np.meshgrid(grid, grid, grid)).reshape(3, -1).T
        on_cube = points[np.abs(points).max(axis=1) == 1.0]
        normals = on_cube / np.sqrt(np.square(on_cube).sum(axis=1))[:, None]
        # The corners of a polytope are the poles of the facets of its normals' hull.
        found.append((normals, float((-ConvexHull(normals).equations[:, -1]).min())))
    return tuple(found)
