"""Pieces of obstacles and borders at the instants at which collisions count."""

from __future__ import annotations

import numpy as np

from radmpc.arrays import Matrix, Tensor
from radmpc.model.workspace import Workspace
from radmpc.program.keepout import KeepOut
from radmpc.program.relaxed.cones import Cones
from radmpc.program.relaxed.instants import Instants

__all__ = ["Found", "moved_since", "seen_at", "walls_of"]

_RIGID = 1e-9
"""By how much the corners of a body that does not turn may move differently, as a share of how far
they move [-]: coordinates are rounded."""

Found = tuple[KeepOut, Tensor, Tensor]
"""A piece of an obstacle, its corners and its faces at the instants."""


def seen_at(instants: Instants, keepout: KeepOut) -> Found:
    """Return the corners and faces of a piece of an obstacle at some instants.

    Parameters
    ----------
    instants : Instants
        Of any vehicle.
    keepout : KeepOut
        The piece, at all steps.
    """
    shapes = keepout.shapes
    if len(shapes) == 1:
        return keepout, shapes[0].vertices[None], shapes[0].normals[None]
    at = [
        _between(shapes[k].vertices, shapes[k + 1].vertices, s)
        for k, s in zip(instants.windows, instants.shares, strict=True)
    ]
    faces = [np.vstack([shapes[k].normals, shapes[k + 1].normals]) for k in instants.windows]
    return keepout, _stacked(at), _stacked(faces)


def _between(first: Matrix, second: Matrix, share: float) -> Matrix:
    """Return points whose hull is the Minkowski interpolation of two hulls."""
    if share == 1.0:
        return second
    sums = (1.0 - share) * first[:, None] + share * second[None]
    return np.asarray(sums.reshape(-1, first.shape[1]))


def _stacked(points: list[Matrix]) -> Tensor:
    """Stack lists of different lengths, the last of each repeated."""
    most = max(len(p) for p in points)
    return np.array([np.concatenate([p, np.repeat(p[-1:], most - len(p), axis=0)]) for p in points])


def moved_since(keepout: KeepOut, instants: Instants) -> Matrix | None:
    """Return how far a body has moved from where it is first, (I, d) [m]; None where it turns too.

    Parameters
    ----------
    keepout : KeepOut
        The body at all steps.
    instants : Instants
        When.
    """
    first, shapes = keepout.shapes[0].vertices, keepout.shapes
    if len(shapes) == 1:
        return np.zeros((instants.count, first.shape[1]))
    if any(shape.vertices.shape != first.shape for shape in shapes):
        return None
    moves = np.array([shape.vertices - first for shape in shapes])
    if np.ptp(moves, axis=1).max() > _RIGID * (1.0 + float(np.abs(moves).max())):
        return None
    steps, share = moves.mean(axis=1), instants.shares[:, None]
    return np.asarray((1.0 - share) * steps[instants.windows] + share * steps[instants.windows + 1])


def walls_of(workspace: Workspace | None, instants: Instants) -> list[Cones]:
    """Return the faces of the workspace at some instants: a half-space each, as it is.

    Parameters
    ----------
    workspace : Workspace or None
        None has no faces.
    instants : Instants
        Of a vehicle.
    """
    if workspace is None:
        return []
    dimension, found = instants.lower.shape[1], []
    for axis in range(dimension):
        for sign, corner in ((1.0, workspace.lower), (-1.0, workspace.upper)):
            normals = np.zeros((instants.count, 1, dimension))
            normals[:, 0, axis] = sign
            variances = np.maximum(instants.covariances[:, axis, axis], 0.0)
            offsets = np.full((instants.count, 1), sign * corner[axis])
            nothing = np.zeros(instants.count, dtype=bool)
            deviations, alone = np.sqrt(variances)[:, None], np.array([-1])
            found.append(Cones(normals, offsets, deviations, alone, nothing))
    return found
