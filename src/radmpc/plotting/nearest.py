"""Distances of points from convex pieces. No matplotlib."""

from __future__ import annotations

import numpy as np
import shapely
from scipy.optimize import nnls

from radmpc.arrays import Matrix, Vector
from radmpc.geometry import Polytope, planar

__all__ = ["nearest", "nearest_of"]

_HEAVY = 1e3
"""Weight of a row of a least-squares problem that must hold."""


def nearest(points: Matrix, pieces: tuple[Polytope, ...]) -> tuple[Vector, Matrix]:
    """Return distance and direction from convex pieces to points; inside, from the next face.

    Parameters
    ----------
    points : (p, d) array
        The points [m].
    pieces : tuple of Polytope
        At least one.

    Returns
    -------
    (p,) and (p, d) array
        Distances, negative inside [m], and unit vectors.
    """
    found = [nearest_of(points, piece) for piece in pieces]
    best = np.argmin([distance for distance, _ in found], axis=0)
    rows = np.arange(len(points))
    distances = np.array([distance for distance, _ in found])
    return distances[best, rows], np.array([along for _, along in found])[best, rows]


def nearest_of(points: Matrix, piece: Polytope) -> tuple[Vector, Matrix]:
    """Return distance and direction from a convex piece to points.

    Parameters
    ----------
    points : (p, d) array
        The points [m].
    piece : Polytope
        The piece.

    Returns
    -------
    (p,) and (p, d) array
        As of `nearest`.
    """
    slack = points @ piece.normals.T - piece.offsets
    face = slack.argmax(axis=1)
    distance, along = slack.max(axis=1), piece.normals[face]
    outside = np.flatnonzero(distance > 0.0)
    if outside.size:
        away = points[outside] - _feet(points[outside], piece)
        length = np.linalg.norm(away, axis=1)
        far = length > 1e-9
        along[outside[far]] = away[far] / length[far, None]
        distance[outside[far]] = length[far]
    return distance, along


def _feet(points: Matrix, piece: Polytope) -> Matrix:
    """Return the points of a convex piece that are nearest to points outside."""
    if points.shape[1] == 2:
        lines = shapely.shortest_line(planar(piece), shapely.points(points))
        return np.asarray(shapely.get_coordinates(shapely.get_point(lines, 0)))
    # Least squares over weights of the corners; a heavy row makes the weights sum to one.
    corners = piece.vertices - piece.vertices.mean(axis=0)
    heavy = _HEAVY * max(float(np.abs(corners).max()), 1.0)
    matrix = np.vstack([corners.T, np.full(len(corners), heavy)])
    offsets = points - piece.vertices.mean(axis=0)
    weights = np.array([nnls(matrix, np.append(w, heavy))[0] for w in offsets])
    weights /= weights.sum(axis=1, keepdims=True)
    return np.asarray(weights @ piece.vertices)
