"""Polytopes within discs and balls, whose corners touch the border."""

from __future__ import annotations

from functools import cache
from itertools import permutations, product

import numpy as np

from radmpc.arrays import Matrix, Vector

__all__ = ["directions_ahead", "inner_corners", "inner_faces", "inner_faces_ahead"]

_NUM_SIDES = 16
"""Sides of the polygon within a disc [-]: 32 would leave 99.5 % instead of 98.1 % of the radius in
every direction, and double the rows."""

_AHEAD = (1.5, 4.0, 9.0, 18.0, 33.0)
"""Angles from the first axis at which directions are laid [degrees]: a chord of the first leaves
more than 0.9999 of the radius."""

_ELSEWHERE = 40.0
"""Angle beyond which directions are those of the corners of `inner_faces` [degrees]."""

_ROUND = 6
"""Directions around the first axis at each of these angles, in space [-]."""

_CORNER: Vector = np.array([1.0, np.sqrt(2.0) - 1.0, np.sqrt(3.0) - np.sqrt(2.0)])
"""In space, where faces at unit distance meet: the faces around a corner are one of each kind."""


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
    normals = signs / np.linalg.norm(signs, axis=1)[:, None]
    return normals, float(1.0 / np.linalg.norm(_CORNER))


def inner_corners(dimension: int) -> Matrix:
    """Return the directions of the corners of `inner_faces`, (c, d) unit vectors.

    Parameters
    ----------
    dimension : int
        2 or 3.
    """
    if dimension == 2:
        angles = 2.0 * np.pi * (np.arange(_NUM_SIDES) + 0.5) / _NUM_SIDES
        return np.column_stack([np.cos(angles), np.sin(angles)])
    signs = np.array(list(product((-1.0, 1.0), repeat=3)))
    corners: Matrix = np.vstack([signs * _CORNER[list(order)] for order in permutations(range(3))])
    return corners / np.linalg.norm(_CORNER)


def directions_ahead(dimension: int) -> Matrix:
    """Return the first axis and unit vectors close to it, (c, d).

    Parameters
    ----------
    dimension : int
        2 or 3.
    """
    found = [np.eye(dimension)[:1]]
    for number, angle in enumerate(np.radians(_AHEAD)):
        # Every other ring is turned by half a step, for triangles of even sides.
        turns = np.pi * (2.0 * np.arange(_ROUND) + number % 2) / _ROUND
        across = np.column_stack([np.cos(turns), np.sin(turns)])
        if dimension == 2:
            across = np.array([[1.0], [-1.0]])
        along = np.full((len(across), 1), np.cos(angle))
        found.append(np.hstack([along, np.sin(angle) * across]))
    return np.vstack(found)


def inner_faces_ahead(dimension: int) -> tuple[Matrix, Vector]:
    """Return the polytope within the unit disc or ball with corners at `directions_ahead`.

    Elsewhere its corners are those of `inner_faces`.

    Parameters
    ----------
    dimension : int
        2 or 3.

    Returns
    -------
    (f, d) and (f,) array
        Unit normals, outward, and the distances of the faces from the middle.
    """
    return _inner_faces_ahead(dimension)


@cache
def _inner_faces_ahead(dimension: int) -> tuple[Matrix, Vector]:
    """Compute its faces."""
    from scipy.spatial import ConvexHull  # noqa: PLC0415 - loads slowly; few limit norms

    corners = inner_corners(dimension)
    far = corners[corners[:, 0] < np.cos(np.radians(_ELSEWHERE))]
    equations = ConvexHull(np.vstack([directions_ahead(dimension), far])).equations
    return equations[:, :-1], -equations[:, -1]
