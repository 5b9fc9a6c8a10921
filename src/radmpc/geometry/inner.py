"""Polytopes within discs and balls, whose corners touch the border."""

from __future__ import annotations

from itertools import product

import numpy as np

from radmpc.arrays import Matrix, Vector

__all__ = ["inner_faces"]

_NUM_SIDES = 16
"""Sides of the polygon within a disc [-]: 32 would leave 99.5 % instead of 98.1 % of the radius in
every direction, and double the rows."""


def inner_faces(dimension: int) -> tuple[Matrix, float]:
    """Return a polytope within the unit disc or ball.

    In the plane it has 16 sides and leaves 98.1 % of the radius in every direction; in space it has
    26 faces, those of a cube and one at each of its edges and corners, and leaves 88.6 %.

    Parameters
    ----------
    dimension : int
        2 or 3.

    Returns
    -------
    (f, d) array and float
        Unit normals, outward, and the distance of all faces from the middle.
    """
    if dimension == 2:
        angles = 2.0 * np.pi * np.arange(_NUM_SIDES) / _NUM_SIDES
        normals = np.column_stack([np.cos(angles), np.sin(angles)])
        return normals, float(np.cos(np.pi / _NUM_SIDES))
    signs = np.array([s for s in product((-1.0, 0.0, 1.0), repeat=3) if any(s)])
    # The faces around a corner are one of each kind: (1, √2 − 1, √3 − √2) is on all three.
    corner: Vector = np.array([1.0, np.sqrt(2.0) - 1.0, np.sqrt(3.0) - np.sqrt(2.0)])
    normals = signs / np.linalg.norm(signs, axis=1)[:, None]
    return normals, float(1.0 / np.linalg.norm(corner))
