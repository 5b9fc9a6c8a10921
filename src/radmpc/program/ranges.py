"""Ranges to keep: polytopes inside the disc, or the ball, of all places in range.

A disc is no polytope: with 16 faces in the plane what is left is at least 98.1 % of the range in
every direction, with 26 in space 88.6 %.
"""

from __future__ import annotations

from itertools import product

import numpy as np

from radmpc.arrays import Matrix, Vector

__all__ = ["NUM_RANGE_FACES", "inner_faces"]

NUM_RANGE_FACES = 16
"""Faces of the polygon inside a disc [-]: 32 would leave 99.5 % instead of 98.1 %, and double the
rows."""


def inner_faces(dimension: int, count: int = NUM_RANGE_FACES) -> tuple[Matrix, float]:
    """Return a polytope inside the unit disc or ball, whose corners touch its border.

    Parameters
    ----------
    dimension : int
        2 or 3.
    count : int
        Faces in the plane, >= 4; in space there are always 26: those of a cube, and one at each of
        its edges and corners.

    Returns
    -------
    (f, d) array and float
        Unit normals, outward, and the distance of all faces from the middle.
    """
    if dimension == 2:
        angles = 2.0 * np.pi * np.arange(count) / count
        normals = np.column_stack([np.cos(angles), np.sin(angles)])
        return normals, float(np.cos(np.pi / count))
    signs = np.array([s for s in product((-1.0, 0.0, 1.0), repeat=3) if any(s)])
    # The faces around a corner are one of each kind: (1, √2 − 1, √3 − √2) is on all three.
    corner: Vector = np.array([1.0, np.sqrt(2.0) - 1.0, np.sqrt(3.0) - np.sqrt(2.0)])
    normals = signs / np.linalg.norm(signs, axis=1)[:, None]
    return normals, float(1.0 / np.linalg.norm(corner))
