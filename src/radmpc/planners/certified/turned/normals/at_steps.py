"""Half-spaces at steps in isotropic noise: away from the nearest point of what is avoided.

All directions deviate alike there, and one end of each window counts, so nothing is sought.
"""

from __future__ import annotations

import numpy as np

from radmpc.arrays import Indices, Matrix, Tensor, Vector
from radmpc.planners.certified.turned.normals.directions import line_of_approach
from radmpc.planners.certified.turned.normals.encounter import LEAST_DEVIATION
from radmpc.planners.certified.turned.normals.spaces import HalfSpaces
from radmpc.planners.certified.turned.paths import Paths
from radmpc.planners.certified.turned.tuning import TUNING
from radmpc.program.hazards import Hazards

__all__ = ["beside_pieces", "beside_vehicles", "is_nearest_best"]

_TINY = 1e-9
"""Length below which a vector tells no direction [m]."""

_Who = tuple[Indices, Indices, Indices]
"""Two vehicles, or a vehicle and a piece of an obstacle, and a window, (w,) each."""


def is_nearest_best(hazards: Hazards, *, of_pieces: bool) -> bool:
    """Return whether the direction from the nearest point is the best one.

    Parameters
    ----------
    hazards : Hazards
        The fleet.
    of_pieces : bool
        Of obstacles' pieces, whose nearest point is sought in the plane alone, or of vehicles.
    """
    is_planar = hazards.dimension == 2 or not of_pieces
    return hazards.is_isotropic and not hazards.intervals and is_planar


def beside_vehicles(
    hazards: Hazards, both: tuple[Paths, Paths], pairing: _Who, keys: Indices, *, is_refined: bool
) -> HalfSpaces:
    """Return half-spaces between vehicles, along the lines between them.

    Parameters
    ----------
    hazards : Hazards
        The fleet.
    both : tuple of Paths
        The latest, and where they are expected to move.
    pairing : tuple of (w,) int array
        Who meets whom when.
    keys : (w,) int array
        See `HalfSpaces`.
    is_refined : bool
        Whether half-spaces are turned to where paths are expected to move.
    """
    first, second, window = pairing
    step = window + 1
    distance = hazards.radii[first] + hazards.radii[second]
    deviations = _deviations(hazards, first, step, hazards.covariances[second, step, 0, 0])

    def line(paths: Paths) -> tuple[Matrix, Matrix]:
        end = paths.means[first, step] - paths.means[second, step]
        return end, line_of_approach(end, distance, lambda: _motions(paths, pairing, end))

    end, normals = line(both[0])
    if is_refined and first.size:
        turned = line(both[1])[1]
        is_crossed = _along(turned, end) - distance < _crossed(deviations)
        normals = np.where(is_crossed[:, None], normals, turned)
    return _laid_out(pairing, normals, end, (distance, deviations), keys)


def _motions(paths: Paths, pairing: _Who, end: Matrix) -> tuple[Matrix, Vector]:
    """Return how pairs move over their windows, and which way they part where neither moves."""
    first, second, window = pairing
    start = paths.means[first, window] - paths.means[second, window]
    return end - start, np.where(first < second, 1.0, -1.0)


def beside_pieces(
    hazards: Hazards, both: tuple[Paths, Paths], which: _Who, keys: Indices, *, is_refined: bool
) -> HalfSpaces:
    """Return half-spaces between vehicles and pieces of obstacles in the plane.

    Parameters
    ----------
    hazards, both, keys, is_refined
        As in `beside_vehicles`.
    which : tuple of (w,) int array
        Who meets which piece when.
    """
    first, piece, window = which
    step, shapes = window + 1, hazards.shapes
    corners, faces = shapes.vertices[piece, step], shapes.faces[piece, window]
    added = 0.0 if shapes.covariances is None else shapes.covariances[piece, step, 0, 0]
    deviations = _deviations(hazards, first, step, added)
    radii, end = hazards.radii[first], both[0].means[first, step]
    if is_refined and first.size:
        normals = _nearest(faces, corners, both[1].means[first, step])
        reach = _furthest(normals[:, None], corners)[:, 0] + radii
        is_crossed = _along(normals, end) - reach < _crossed(deviations)
        if is_crossed.any():
            latest = _nearest(faces, corners, end)
            normals = np.where(is_crossed[:, None], latest, normals)
    else:
        normals = _nearest(faces, corners, end)
    reach = _furthest(normals[:, None], corners)[:, 0] + radii
    who = first, np.full(first.size, -1), window
    return _laid_out(who, normals, end, (reach, deviations), keys)


def _deviations(hazards: Hazards, first: Indices, step: Indices, added: Vector | float) -> Vector:
    """Return standard deviations of positions in any direction, (w,) [m]."""
    variances = hazards.covariances[first, step, 0, 0] + added
    return np.asarray(np.sqrt(np.maximum(variances, 0.0)))


def _crossed(deviations: Vector) -> Vector:
    """Return the room below which paths count as crossed, (w,) [m]."""
    return np.asarray(TUNING.crossed * np.maximum(deviations, LEAST_DEVIATION))


def _along(normals: Matrix, ends: Matrix) -> Vector:
    """Return how far positions are along one normal each, (w,) [m]."""
    return np.asarray(np.einsum("wd,wd->w", normals, ends))


def _furthest(directions: Tensor, corners: Tensor) -> Matrix:
    """Return how far corners extend along directions, window by window, (w, c) [m]."""
    return np.asarray((directions @ corners.transpose(0, 2, 1)).max(axis=2))


def _nearest(faces: Tensor, corners: Tensor, ends: Matrix) -> Matrix:
    """Return the unit directions from the nearest points of pieces, (w, d).

    They are among the faces, and the directions from the corners; within a piece the face that is
    nearest tells the way out.
    """
    away = ends[:, None] - corners
    length = np.sqrt(np.einsum("wvd,wvd->wv", away, away))[..., None]
    apart = np.where(length > _TINY, away / np.maximum(length, _TINY), 0.0)
    tried = np.concatenate([faces, apart], axis=1)
    scores = (tried @ ends[:, :, None])[..., 0] - _furthest(tried, corners)
    scores[~tried.any(axis=2)] = -np.inf
    return np.asarray(tried[np.arange(len(tried)), scores.argmax(axis=1)])


def _laid_out(
    who: _Who, normals: Matrix, ends: Matrix, room: tuple[Vector, Vector], keys: Indices
) -> HalfSpaces:
    """Return half-spaces along given normals, from what they ask for and deviate by."""
    count = len(normals)
    shares, nearest = np.empty(count), np.empty(count)
    shares.fill(0.5)
    nearest.fill(np.nan)
    # Both columns are those of the one end that counts.
    offsets, deviations, heights = (
        np.repeat(each[:, None], 2, axis=1) for each in (*room, _along(normals, ends))
    )
    return HalfSpaces(*who, normals, offsets, deviations, shares, heights, keys, nearest)
