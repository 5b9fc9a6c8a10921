r"""Where a polygon that is grown by a radius is hit with a given probability, from within.

With H a convex hazard and x a mean under the noise, the clearance from a half-plane that is hit
as likely, :math:`g(x) = -\Phi^{-1}(\Pr[x + w \in H])`, is convex in x (Ehrhard 1983), and differs
from mean to mean by no more than their distance in standard deviations (Li and Kuelbs 1998). So g
is at most z in the hull of any means where it is, and z and the distance from that hull elsewhere.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from scipy.special import ndtr, ndtri

from radmpc.arrays import Matrix, Tensor

__all__ = ["level_points"]

_DEPTHS = 4.0 * np.square(np.linspace(1e-4, 1.0, 16))
"""Where a polygon is cut, behind what it has outermost [standard deviations]."""

_STEPS = 3
"""Steps outward, before a straight line is followed [-]: each leaves a tenth of what there was to
go where a polygon is like a half-plane, and half of it at a sharp corner."""

_BEYOND, _LEAST_SLOPE = 1.2, 0.2
"""How much further is looked than the line leads, and the least slope of that line [-]: where it is
less, the chord is a shorter one."""

_SAFETY = 1e-6
"""By how much means stay within the level, above rounding [standard deviations]."""

_SAME = 1e-9
"""Length below which two points are one [standard deviations]."""

Flags = npt.NDArray[np.bool_]


def level_points(
    support: tuple[Tensor, Tensor], normals: Tensor, roots: Tensor, level: float
) -> tuple[Tensor, Flags]:
    """Return means at which a polygon is hit with a probability at least, nearly as far as any.

    Parameters
    ----------
    support : tuple of (I, k, 2) array
        The first and the last point of its outline that each of k normals supports, in turn and
        counter-clockwise, those of its faces among them [m].
    normals : (I, k, 2) array
        The unit normals.
    roots : (I, 2, 2) array
        Symmetric roots of the noise's covariances, which are regular [m].
    level : float
        z: the probability is that of a half-plane so far away [standard deviations].

    Returns
    -------
    (I, 2 k, 2) array
        The means, two per normal [m].
    (I,) bool array
        Whether it is reached on the outline; nothing is said where it is not.
    """
    # In units in which the noise is the same all around.
    inverse = np.linalg.inv(roots)
    first, last = (each @ inverse for each in support)
    ahead = normals @ roots
    ahead /= np.linalg.norm(ahead, axis=2, keepdims=True)
    sides = _sides(np.stack([first, last], axis=2).reshape(len(first), -1, 2))
    is_face = np.linalg.norm(last - first, axis=2).max(axis=0) > _SAME
    points = np.concatenate([first, last[:, is_face]], axis=1)
    ahead = np.concatenate([ahead, ahead[:, is_face]], axis=1)
    beside = _beside(points, ahead, sides)
    moved, is_reached = _outward(beside, level - _SAFETY)
    found = (points + moved[..., None] * ahead) @ roots
    both = np.repeat(found[:, : is_face.size], 2, axis=1)
    both[:, 2 * np.flatnonzero(is_face) + 1] = found[:, is_face.size :]
    return both, is_reached


def _outward(beside: Tensor, level: float) -> tuple[Matrix, Flags]:
    """Return how far points move outward to be at a level, and where they begin within it."""
    near = np.zeros(beside.shape[:2])
    here = _clearances(beside, near)
    is_reached = np.asarray((here <= level).all(axis=1))
    for _ in range(_STEPS):
        # They grow by no more than a deviation per deviation, and the faster the farther out.
        before, moved = here, np.maximum(level - here, 0.0)
        near = near + moved
        here = _clearances(beside, near)
    slopes = np.maximum(here - before, _SAME) / np.maximum(moved, _SAME)
    far = near + _BEYOND * np.maximum(level - here, 0.0) / np.maximum(slopes, _LEAST_SLOPE)
    # Between the two they are no more than on the chord.
    share = np.maximum(level - here, 0.0) / np.maximum(_clearances(beside, far) - here, _SAME)
    return near + np.minimum(share, 1.0) * (far - near), is_reached


def _sides(points: Tensor) -> tuple[Tensor, Matrix]:
    """Return unit normals and offsets of the half-planes that a polygon lies in, (I, j, 2).

    Where one of its chords is a point, as that of twin directions is, the offset is inf.
    """
    chords = np.roll(points, -1, axis=1) - points
    lengths = np.sqrt(np.square(chords).sum(axis=2))
    kept = np.flatnonzero((lengths > _SAME).any(axis=0))
    chords, lengths = chords[:, kept], lengths[:, kept]
    across = np.stack([chords[..., 1], -chords[..., 0]], axis=2)
    across /= np.maximum(lengths, _SAME)[..., None]
    offsets = np.einsum("ija,ija->ij", across, points[:, kept])
    return across, np.where(lengths > _SAME, offsets, np.inf)


def _beside(points: Tensor, ahead: Tensor, sides: tuple[Tensor, Matrix]) -> Tensor:
    """Return the probability of each cut across the direction ahead of a point, (I, p, c)."""
    normals, offsets = sides
    by_side = normals.transpose(1, 0, 2)[:, :, None]
    across = np.stack([-ahead[..., 1], ahead[..., 0]], axis=2)
    room = offsets.T[..., None] - np.einsum("jipa,ipa->jip", by_side, points)
    along = np.einsum("jipa,ipa->jip", by_side, across)
    along = np.where(np.abs(along) < _SAME, _SAME, along)
    slopes = np.einsum("jipa,ipa->jip", by_side, ahead) / along
    ends = slopes[..., None] * _DEPTHS
    ends += (room / along)[..., None]
    is_left = (along > 0.0)[..., None]
    left = np.where(is_left, ends, np.inf).min(axis=0)
    right = np.where(is_left, -np.inf, ends).max(axis=0)
    return np.asarray(np.maximum(ndtr(left) - ndtr(right), 0.0))


def _clearances(beside: Tensor, moved: Matrix) -> Matrix:
    """Return the clearances from half-planes that are hit as likely, at most, (I, p).

    The density of a polygon's cuts is log-concave (Prékopa 1973): between two of them it is no less
    than the exponential through both.
    """
    density = beside * np.exp(-0.5 * np.square(moved[..., None] + _DEPTHS))
    one, two = density[..., :-1], density[..., 1:]
    ratios = np.diff(np.log(np.maximum(density, 1e-300)), axis=2)
    is_flat = np.abs(ratios) < _SAME
    mean = np.where(is_flat, np.minimum(one, two), (two - one) / np.where(is_flat, 1.0, ratios))
    is_cut = (one > 0.0) & (two > 0.0)
    total = (np.where(is_cut, mean, 0.0) * np.diff(_DEPTHS)).sum(axis=2)
    return np.asarray(-ndtri(np.clip(total / np.sqrt(2.0 * np.pi), 1e-300, 1.0)))
