"""Unit directions along which a half-space may separate a path from what it passes."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from radmpc.arrays import Matrix, Tensor, Vector
from radmpc.geometry import sphere_directions
from radmpc.planners.certified.turned.normals.encounter import Encounter
from radmpc.planners.certified.turned.tuning import TUNING

__all__ = ["around_approach", "closest_approach", "from_obstacles", "line_of_approach", "refined"]

_THROUGH = 1e-3
"""Share of the distance to keep below which two paths count as through each other [-]: what is left
between them tells no direction."""

_COARSE = {2: sphere_directions(12, 2), 3: sphere_directions(26, 3)}
"""Directions tried beside the line of closest approach before one is refined, by dimension [-]:
where noise differs much between axes the best may be another."""

_EVERYWHERE = sphere_directions(162, 3)
"""Directions tried around a shape in space, some 16 degrees apart: beside an edge the best is
neither of a face nor from a corner, and too far from these to be found by refining them."""

_TINY = 1e-12
"""Stands for a length of 0 where one divides by it [m]."""


def closest_approach(relative: Tensor) -> Tensor:
    """Return where relative paths come closest to the origin between steps, (p, T, d) [m].

    Parameters
    ----------
    relative : (p, T+1, d) array
        Relative positions at the steps [m].
    """
    before, moved = relative[:, :-1], relative[:, 1:] - relative[:, :-1]
    squares = np.maximum(np.einsum("ptd,ptd->pt", moved, moved), _TINY)
    along = np.clip(-np.einsum("ptd,ptd->pt", before, moved) / squares, 0.0, 1.0)
    return np.asarray(before + along[..., None] * moved)


def line_of_approach(
    closest: Matrix, distance: Vector, motions: Callable[[], tuple[Matrix, Vector]]
) -> Matrix:
    """Return unit vectors along the line of closest approach between two vehicles, (w, d).

    Parameters
    ----------
    closest : (w, d) array
        Relative position where they are closest [m].
    distance : (w,) array
        Distance to keep [m].
    motions : callable
        Called where some are through each other: relative motions over the windows, (w, d) [m], and
        which way to part where neither moves, (w,) [-].
    """
    length = np.sqrt(np.einsum("wd,wd->w", closest, closest))
    normals = closest / np.maximum(length, _TINY)[:, None]
    through = length < _THROUGH * distance
    if through.any():
        moved, signs = motions()
        normals[through] = _across(moved[through], signs[through])
    return np.asarray(normals)


def around_approach(
    closest: Matrix, moved: Matrix, distance: Vector, signs: Vector, *, many: bool
) -> Tensor:
    """Return directions to try between two vehicles, the line of closest approach first, (w, c, d).

    Parameters
    ----------
    closest : (w, d) array
        Relative position where they are closest [m].
    moved : (w, d) array
        Relative motion over the window [m].
    distance : (w,) array
        Distance to keep [m].
    signs : (w,) array
        Which way to part where neither moves [-].
    many : bool
        Whether directions all around are wanted, too.
    """
    tried = line_of_approach(closest, distance, lambda: (moved, signs))[:, None]
    if not many:
        return np.asarray(tried)
    coarse = _COARSE[closest.shape[1]]
    everywhere = np.broadcast_to(coarse, (len(closest), *coarse.shape))
    return np.asarray(np.concatenate([tried, everywhere], axis=1))


def refined(encounters: tuple[Encounter, Encounter], tried: Tensor) -> Matrix:
    """Return the best normals of where paths move, of the paths themselves where these cross.

    Parameters
    ----------
    encounters : tuple of Encounter
        Of the latest paths, and of where they move.
    tried : (w, c, d) array
        Unit directions to begin with; zeros stand for none.
    """
    latest, moved = encounters
    normals = moved.best_normals(tried)
    crossed = latest.clearances(normals[:, None])[:, 0] < TUNING.crossed
    if crossed.any():
        normals = np.where(crossed[:, None], latest.best_normals(tried), normals)
    return normals


def _across(moved: Matrix, signs: Vector) -> Matrix:
    """Return unit normals across relative motions, opposite ones for opposite motions or signs."""
    length = np.linalg.norm(moved, axis=1, keepdims=True)
    moves = length > _TINY
    ahead = np.where(moves, moved / np.where(moves, length, 1.0), np.eye(moved.shape[1])[0])
    if moved.shape[1] == 2:
        across = np.stack([-ahead[:, 1], ahead[:, 0]], axis=1)
    else:
        axis = np.eye(3)[np.abs(ahead).argmin(axis=1)]
        across = np.cross(ahead, axis)
        across /= np.linalg.norm(across, axis=1, keepdims=True)
    return np.asarray(across * np.where(moves, 1.0, signs[:, None]))


def from_obstacles(
    encounters: tuple[Encounter, Encounter | None],
    shape: tuple[Tensor, tuple[Tensor, ...]],
) -> Matrix:
    """Return the best normals between paths and shapes, (w, d).

    Parameters
    ----------
    encounters : tuple of Encounter
        Of the latest paths, and of where they move; None where what tells the best direction
        without noise will do.
    shape : tuple
        Outward normals of the shapes, and their corners, see `_from_shape`.
    """
    latest, moved = encounters
    tried = _from_shape(*shape, latest.ends)
    return latest.best_of(tried) if moved is None else refined((latest, moved), tried)


def _from_shape(faces: Tensor, corners: tuple[Tensor, ...], ends: tuple[Matrix, ...]) -> Tensor:
    """Return unit directions from a shape to a path's chord, zeros where there is none, (w, c, d).

    Its faces, the directions from its corners to the nearest points of the chord, and in the plane
    the normals of the chord: the direction of most room without noise is among them there. In space
    directions all around.

    Parameters
    ----------
    faces : (w, f, d) array
        Outward normals of the shape; zeros fill up.
    corners : tuple of (w, v, d) array
        Its corners at both ends of each window [m], or at one where the path is a point.
    ends : tuple of (w, d) array
        The path there [m].
    """
    tried = [faces]
    if len(ends) == 2:
        tried += _along_chord(corners, ends)
    else:
        tried += [_apart(ends[0][:, None] - points) for points in corners]
    if faces.shape[2] == 3:
        tried.append(np.broadcast_to(_EVERYWHERE, (len(faces), *_EVERYWHERE.shape)))
    return np.concatenate(tried, axis=1)


def _along_chord(corners: tuple[Tensor, ...], ends: tuple[Matrix, ...]) -> list[Tensor]:
    """Return a chord's normals in the plane, and directions from corners to its nearest points."""
    start, end = ends
    moved = end - start
    squares = np.einsum("wd,wd->w", moved, moved)
    tried = []
    if moved.shape[1] == 2:
        across = np.stack([-moved[:, 1], moved[:, 0]], axis=1)
        moves = squares > _TINY
        across = np.where(
            moves[:, None], across / np.sqrt(np.where(moves, squares, 1.0))[:, None], 0.0
        )
        tried.append(np.stack([across, -across], axis=1))
    for points in corners:
        along = np.einsum("wvd,wd->wv", points - start[:, None], moved)
        share = np.clip(along / np.maximum(squares, _TINY)[:, None], 0.0, 1.0)
        tried.append(_apart(start[:, None] + share[..., None] * moved[:, None] - points))
    return tried


def _apart(away: Tensor) -> Tensor:
    """Return unit vectors, zeros where there is next to nothing between, (w, v, d)."""
    length = np.linalg.norm(away, axis=2, keepdims=True)
    return np.where(length > 1e-9, away / np.maximum(length, _TINY), 0.0)
