"""How far sets extend along directions; outlines of many corners without looking at all of them."""

from __future__ import annotations

import numpy as np

from radmpc.arrays import Indices, Matrix, Tensor

__all__ = ["is_searched", "planar_supports"]

_CORNERS, _PRODUCTS = 64, 20_000
"""Corners, and products of corners and directions of a site, from which on corners are searched for
by angles [-]: fewer are compared sooner than angles are computed."""

_TURN = 2.0 * np.pi

_ROW = 3.0 * _TURN
"""What sets the angles of one outline apart from those of the next [rad]."""

_BESIDE = _TURN * 1.25
"""Where there is no edge: beyond all angles of an outline [rad]."""


def is_searched(num_corners: int, num_directions: int, dimension: int) -> bool:
    """Return whether `planar_supports` is quicker than to compare all corners.

    Parameters
    ----------
    num_corners, num_directions, dimension : int
        Of every site.
    """
    many = num_corners >= _CORNERS and num_corners * num_directions >= _PRODUCTS
    return many and dimension == 2


def planar_supports(vertices: Tensor, directions: Tensor) -> Matrix | None:
    """Return the largest product of any corner of convex outlines with directions, (S, C).

    The farthest corner lies between the two edges whose normals enclose the direction. So that
    rounding of angles takes no other, its neighbors are compared with it.

    Parameters
    ----------
    vertices : (S, V, 2) array
        Corners counter-clockwise, the first repeated at the end where there are fewer [m].
    directions : (S, C, 2) array
        Directions [-].

    Returns
    -------
    (S, C) array or None
        Supports [m]; None where some corners go another way round.
    """
    counts, rows = _counted(vertices), np.arange(len(vertices))[:, None]
    first, edges = _edge_angles(vertices, counts)
    if np.any(edges[:, 1:] < edges[:, :-1]):
        return None
    turned = first + (np.arctan2(directions[..., 1], directions[..., 0]) - first) % _TURN
    # Angles of all outlines in one ascending row: one search for all of them.
    place = np.searchsorted((edges + _ROW * rows).ravel(), turned + _ROW * rows, side="right")
    place -= rows * edges.shape[1]
    found = np.full(turned.shape, -np.inf)
    for beside in (-1, 0, 1):
        corner = vertices[rows, (place + beside) % counts[:, None]]
        along = corner[..., 0] * directions[..., 0] + corner[..., 1] * directions[..., 1]
        np.maximum(found, along, out=found)
    return found


def _counted(vertices: Tensor) -> Indices:
    """Return how many corners each outline has without those repeated at its end, (S,)."""
    differs = np.any(vertices != vertices[:, :1], axis=2)
    return np.where(differs.any(axis=1), vertices.shape[1] - differs[:, ::-1].argmax(axis=1), 1)


def _edge_angles(vertices: Tensor, counts: Indices) -> tuple[Matrix, Matrix]:
    """Return the angle of each outline's first normal, (S, 1), and of all from it on, (S, V)."""
    steps = np.roll(vertices, -1, axis=1) - vertices
    angles = np.arctan2(-steps[..., 0], steps[..., 1])
    first = angles[:, :1]
    edges = first + (angles - first) % _TURN
    is_padding = np.arange(vertices.shape[1]) >= counts[:, None]
    return first, np.where(is_padding, first + _BESIDE, edges)
