"""Pieces of unequal size as arrays of equal size: a corner, face or edge repeated."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from radmpc.arrays import Matrix, Tensor, distinct
from radmpc.geometry import Polytope
from radmpc.referee.contact import solid_of

__all__ = ["padded_edges", "padded_normals", "padded_vertices"]


def padded_vertices(pieces: Sequence[Sequence[Polytope]]) -> Tensor:
    """Return the corners of each piece at each step, (p, steps, V, d)."""
    padded = _padded([piece.vertices for steps in pieces for piece in steps])
    return padded.reshape(len(pieces), -1, *padded.shape[1:])


def padded_normals(pieces: Sequence[Sequence[Polytope]]) -> Tensor:
    """Return the axes and the distinct normals of each piece over all steps, (p, G, d)."""
    d = pieces[0][0].dimension
    axes = np.concatenate([np.eye(d), -np.eye(d)])
    return _padded([_distinct_normals(steps) for steps in pieces], axes)


def _distinct_normals(steps: Sequence[Polytope]) -> Matrix:
    """Return the distinct normals of a piece over all steps, (f, d)."""
    if len(steps) == 1:
        return steps[0].normals
    faces = np.vstack([piece.normals for piece in steps])
    _, kept = np.unique(faces.round(12), axis=0, return_index=True)
    return np.asarray(faces[kept])


def padded_edges(pieces: Sequence[Sequence[Polytope]]) -> Tensor:
    """Return the ends of the edges of each piece at each step in space, (p, steps, R, 2, d)."""
    d = pieces[0][0].dimension
    if d == 2:
        return np.zeros((len(pieces), len(pieces[0]), 0, 2, d))
    padded = _padded([solid_of(piece).edges for steps in pieces for piece in steps])
    return padded.reshape(len(pieces), -1, *padded.shape[1:])


def _padded(every: Sequence[Tensor], before: Tensor | None = None) -> Tensor:
    """Stack rows, common ones before them if any; each one's first is repeated up to the most.

    Those with as many rows are stacked at once: maps hold thousands of pieces.
    """
    counts = np.array([len(rows) for rows in every])
    first = 0 if before is None else len(before)
    padded = np.empty((len(every), first + int(counts.max()), *every[0].shape[1:]))
    if before is not None:
        padded[:, :first] = before
    for count in distinct(counts).tolist():
        which = np.flatnonzero(counts == count)
        padded[which, first : first + count] = np.array([every[k] for k in which.tolist()])
        padded[which, first + count :] = padded[which, :1]
    return padded
