"""Many things to keep out of laid side by side, with as many faces each."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import groupby

import numpy as np

from radmpc.arrays import Matrix, Tensor, Vector
from radmpc.program.avoidance import Windows
from radmpc.program.keepout import KeepOut

__all__ = ["batches", "faces_at_start", "joined_faces", "joined_windows"]

_AT_ONCE = 64
"""Things laid side by side at most [-]: all are filled up to the number of faces of the one that
has most, and from some ten on more at once save nothing."""


def batches(keepouts: Sequence[KeepOut]) -> Iterator[Sequence[KeepOut]]:
    """Return things a few at a time, in order; what spreads on its own comes alone."""
    for _, alike in groupby(keepouts, key=lambda keepout: id(keepout.spread)):
        these = list(alike)
        for first in range(0, len(these), _AT_ONCE):
            yield these[first : first + _AT_ONCE]


def joined_windows(keepouts: Sequence[KeepOut], radius: float, *, intervals: bool) -> Windows:
    """Return the windows of things to keep a round body out of, one thing after the other.

    Parameters
    ----------
    keepouts : sequence of KeepOut
        The things, at least one, over the same windows.
    radius : float
        Of the body [m].
    intervals : bool
        Whether windows are intervals.

    Returns
    -------
    Windows
        Things with fewer faces than others are filled up with faces that are not there.
    """
    count, horizon = len(keepouts), len(keepouts[0].near)
    num_faces = max(k.near.shape[1] for k in keepouts)
    normals = np.zeros((count, horizon, num_faces, keepouts[0].normals.shape[2]))
    near, far = np.full((2, count, horizon, num_faces), -np.inf)
    directions = np.zeros((count, horizon, num_faces), dtype=np.int64)
    for i, keepout in enumerate(keepouts):
        own = slice(0, keepout.near.shape[1])
        np.negative(keepout.normals, out=normals[i, :, own])
        near[i, :, own] = -(keepout.near + radius)
        far[i, :, own] = near[i, :, own] if keepout.far is keepout.near else -(keepout.far + radius)
        directions[i, :, own] = keepout.directions
    return Windows(
        normals.reshape(-1, *normals.shape[2:]),
        near.reshape(-1, num_faces),
        far.reshape(-1, num_faces),
        directions.reshape(-1, num_faces),
        intervals,
        np.tile(np.arange(horizon), count),
        np.repeat(np.arange(count), horizon),
    )


def faces_at_start(keepouts: Sequence[KeepOut], extras: Sequence[Matrix]) -> tuple[Tensor, Matrix]:
    """Return the faces at the first step of those things that are charged there, at least one.

    Parameters
    ----------
    keepouts : sequence of KeepOut
        The things.
    extras : sequence of (e, d) array
        Directions beside the faces of each.

    Returns
    -------
    normals : (n, f, d) array
        Outward; filled up with zeros.
    offsets : (n, f) array
        Filled up with inf [m].
    """
    parts = []
    for keepout, extra in zip(keepouts, extras, strict=True):
        start = keepout.start
        if start is None:
            continue
        if len(extra):
            more = np.append(start.offsets, start.support(extra))
            parts.append((np.vstack([start.normals, extra]), [more]))
        else:
            parts.append((start.normals, [start.offsets]))
    normals, offsets = joined_faces(parts)
    return normals, offsets[:, 0]


def joined_faces(parts: Sequence[tuple[Matrix, Sequence[Vector]]]) -> tuple[Tensor, Tensor]:
    """Return faces of things side by side.

    Parameters
    ----------
    parts : sequence of ((f, d) array, sequence of (f,) array)
        Outward normals of each thing, at least one, and offsets of its faces at some moments, as
        many for all [m].

    Returns
    -------
    normals : (n, f, d) array
        Things with fewer faces than others are filled up with zeros.
    offsets : (n, moments, f) array
        And with inf [m].
    """
    num_faces = max(len(normals) for normals, _ in parts)
    normals = np.zeros((len(parts), num_faces, parts[0][0].shape[1]))
    offsets = np.full((len(parts), len(parts[0][1]), num_faces), np.inf)
    for i, (faces, moments) in enumerate(parts):
        normals[i, : len(faces)] = faces
        for j, moment in enumerate(moments):
            offsets[i, j, : len(faces)] = moment
    return normals, offsets
