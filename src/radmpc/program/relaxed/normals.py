"""Directions around a hazard in the plane: those of its faces, and others between them."""

from __future__ import annotations

import numpy as np

from radmpc.arrays import Matrix, Tensor
from radmpc.records import dataclass

__all__ = ["Normals", "chosen_normals", "roots_of"]

_NEAR_FACE = 0.4
"""Share of the angle between directions within which one gives way to a face's normal [-]."""

_MOST_EVEN = 6
"""Faces up to which there is a direction between a face and the middle of a corner in any case."""

_HALF_TURN = np.pi - 1e-3
"""Angle from which a corner has no arc of its own [rad]: nothing can be said of a half turn."""


@dataclass(frozen=True, slots=True, eq=False)
class Normals:
    """Directions in turn.

    Attributes
    ----------
    normals : (I, k, 2) array
        Unit vectors, counter-clockwise.
    beside_faces : int or None
        Where the directions are the middle of a corner, as many as this, a face, as many again, and
        so on; None where they are in no such order.
    """

    normals: Tensor
    beside_faces: int | None


def chosen_normals(faces: Tensor, roots: Tensor, directions: Tensor) -> Normals:
    """Return the faces' normals with about as many directions around the hazard as are given.

    Parameters
    ----------
    faces : (I or 1, f, 2) array
        Outward unit normals of the faces; f is 0 for a point.
    roots : (I, 2, 2) array
        Of the covariances, see `roots_of`.
    directions : (I, k, 2) array
        Unit vectors in the metric in which the noise is the same all around: used as they are
        where there are no faces around which they could be laid out.
    """
    faces = np.broadcast_to(faces, (len(roots), *faces.shape[1:]))
    if faces.shape[1] >= 3:
        seen = np.einsum("iab,ifb->ifa", roots, faces)
        angles = np.mod(np.arctan2(seen[..., 1], seen[..., 0]), 2.0 * np.pi)
        order = angles.argsort(axis=1)
        angles = np.take_along_axis(angles, order, axis=1)
        corners = np.diff(angles, axis=1, append=angles[:, :1] + 2.0 * np.pi)
        if corners.max() <= _HALF_TURN:
            exact = np.take_along_axis(faces, order[..., None], axis=1)
            return _between(exact, angles, corners, roots, directions.shape[1])
    return Normals(_merged(faces, roots, directions), None)


def _between(faces: Tensor, angles: Tensor, corners: Tensor, roots: Tensor, count: int) -> Normals:
    """Return directions evenly between faces, from the middle of a corner on."""
    num_faces = faces.shape[1]
    beside = max(round(0.5 * count / num_faces - 1.0), 1 if num_faces <= _MOST_EVEN else 0)
    shares = np.arange(beside + 1) / (2 * beside + 2)
    before = np.roll(corners, 1, axis=1)
    turned = np.concatenate(
        [
            angles[..., None] - before[..., None] * (0.5 - shares),
            angles[..., None] + corners[..., None] * shares,
        ],
        axis=2,
    ).reshape(len(roots), -1)
    even = np.stack([np.cos(turned), np.sin(turned)], axis=2)
    normals = np.einsum("iab,ikb->ika", _adjoint(roots), even)
    normals /= np.maximum(np.linalg.norm(normals, axis=2), 1e-300)[..., None]
    # Faces as they are, to the last bit: their cones are to have no angle.
    normals[:, beside + 1 :: 2 * beside + 2] = faces
    return Normals(normals, beside)


def _merged(faces: Tensor, roots: Tensor, directions: Tensor) -> Tensor:
    """Return the directions in meters and the faces' normals by angle, near ones merged."""
    normals = np.einsum("iab,ikb->ika", _adjoint(roots), directions)
    normals /= np.maximum(np.linalg.norm(normals, axis=2), 1e-300)[..., None]
    if faces.shape[1]:
        cosines = np.einsum("ika,ifa->ikf", normals, faces)
        nearest = cosines.argmax(axis=2)
        closest = np.take_along_axis(faces, nearest[..., None], axis=1)
        is_near = cosines.max(axis=2) > np.cos(_NEAR_FACE * 2.0 * np.pi / directions.shape[1])
        normals = np.where(is_near[..., None], closest, normals)
        normals = np.concatenate([normals, faces], axis=1)
    angles = np.arctan2(normals[..., 1], normals[..., 0])
    if faces.shape[1]:
        # Wide cones begin between faces: from one face to the next, a chord would cut a box in two.
        first = np.arctan2(faces[:, 0, 1], faces[:, 0, 0]) + 0.25 * np.pi
        angles = np.mod(angles - first[:, None], 2.0 * np.pi)
    order = angles.argsort(axis=1)
    return np.take_along_axis(normals, order[..., None], axis=1)


def roots_of(values: Matrix, vectors: Tensor) -> Tensor:
    """Return symmetric roots of covariances, the identity where there is no noise.

    Parameters
    ----------
    values : (I, 2) array
        Their eigenvalues, ascending [m²].
    vectors : (I, 2, 2) array
        Their eigenvectors, in columns.
    """
    values = np.sqrt(np.maximum(values, 0.0))
    values[values[:, -1] == 0.0] = 1.0
    return np.asarray(np.einsum("iak,ik,ibk->iab", vectors, values, vectors))


def _adjoint(roots: Tensor) -> Tensor:
    """Return the inverses but for their length, which a direction does not need."""
    return np.stack(
        [
            np.stack([roots[:, 1, 1], -roots[:, 0, 1]], axis=1),
            np.stack([-roots[:, 1, 0], roots[:, 0, 0]], axis=1),
        ],
        axis=1,
    )
