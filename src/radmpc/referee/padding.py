"""Pieces of unequal size as arrays of equal size: a corner, face or edge repeated."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from radmpc.arrays import Tensor
from radmpc.geometry import Polytope
from radmpc.referee.contact import solid_of

__all__ = ["padded_edges", "padded_normals", "padded_vertices"]


def padded_vertices(pieces: Sequence[Sequence[Polytope]]) -> Tensor:
    """Return the corners of each piece at each step, (p, steps, V, d)."""
    largest = max(len(piece.vertices) for steps in pieces for piece in steps)
    return np.array([[_padded(piece.vertices, largest) for piece in steps] for steps in pieces])


def padded_normals(pieces: Sequence[Sequence[Polytope]]) -> Tensor:
    """Return the axes and the distinct normals of each piece over all steps, (p, G, d)."""
    d = pieces[0][0].dimension
    axes = np.concatenate([np.eye(d), -np.eye(d)])
    normals = []
    for steps in pieces:
        faces = np.vstack([piece.normals for piece in steps])
        if len(steps) > 1:
            _, kept = np.unique(faces.round(12), axis=0, return_index=True)
            faces = faces[kept]
        normals.append(np.vstack([axes, faces]))
    largest = max(len(faces) for faces in normals)
    return np.array([_padded(faces, largest) for faces in normals])


def padded_edges(pieces: Sequence[Sequence[Polytope]]) -> Tensor:
    """Return the ends of the edges of each piece at each step in space, (p, steps, R, 2, d)."""
    d = pieces[0][0].dimension
    if d == 2:
        return np.zeros((len(pieces), len(pieces[0]), 0, 2, d))
    edges = [[solid_of(piece).edges for piece in steps] for steps in pieces]
    most = max(len(rows) for steps in edges for rows in steps)
    return np.array([[_padded(rows, most) for rows in steps] for steps in edges])


def _padded(rows: Tensor, count: int) -> Tensor:
    """Repeat the first row until there are enough."""
    return np.concatenate([rows, np.repeat(rows[:1], count - len(rows), axis=0)])
