"""Cones of directions around a hazard in space."""

from __future__ import annotations

import numpy as np

from radmpc.arrays import Matrix, Tensor, Vector
from radmpc.program.relaxed.cones import Cones
from radmpc.program.relaxed.patches import Patches
from radmpc.program.relaxed.tails import Tails

__all__ = ["cones_in_space"]

_FLATTEST = 1e-6
"""Share of the largest deviation that directions take a smaller one for [-]: any parting of the
directions will do, and this one is not degenerate."""


def cones_in_space(
    patches: Patches,
    radius: float,
    covariances: Tensor,
    tails: Tails,
    displacements: Matrix | None = None,
) -> Cones:
    """Return one cone per patch of directions.

    With m the axis of a patch, v a point that supports all of it as far as m sees and ``d(n) = Σ n
    / |n|_Σ``, a mean at a distance q >= least whose direction n lies in the patch is at ``m · v +
    radius · m · n + q m · d(n)`` along m. Directions n with ``m · n >= c >= 0`` are a cap, which
    holds a triangle if it holds the corners; so do those with ``m · d(n) >= c``, in the metric of
    the noise. So m · n and m · d(n) are least at corners of the triangles that a patch is made of,
    and ``q <= least + (m · x̄ − o) / min(m · d)`` with ``o = m · v + radius · min(m · n) + least ·
    min(m · d)``.

    Parameters
    ----------
    patches : Patches
        All directions.
    radius : float
        By how much the hazard is grown [m].
    covariances : (I, 3, 3) array
        Of the position relative to it [m²].
    tails : Tails
        What charges are at least.
    displacements : (I, 3) array or None
        By how much the hazard has moved from where its patches are [m]; None is not at all.

    Returns
    -------
    Cones
        One per patch.
    """
    directions = _directions(patches, covariances)
    along = np.einsum("iab,ikb->ika", covariances, directions)
    lengths = np.sqrt(np.maximum(np.einsum("ika,ika->ik", directions, along), 0.0))
    gradients = along / np.where(lengths > 0.0, lengths, 1.0)[..., None]
    of_patch = directions[:, patches.corners]
    normals = of_patch.sum(axis=2) if patches.axes is None else directions[:, patches.axes]
    normals = normals / np.maximum(np.linalg.norm(normals, axis=2), 1e-300)[..., None]
    cosines = np.einsum("ipa,ipja->ipj", normals, of_patch).min(axis=2)
    deviations = np.einsum("ipa,ipja->ipj", normals, gradients[:, patches.corners]).min(axis=2)
    sizes = np.sqrt(np.maximum(np.trace(covariances, axis1=1, axis2=2), 0.0))
    least, shifts = tails.at(np.full(len(covariances), np.inf))
    is_noisy = (sizes > 0.0)[:, None]
    is_there = (cosines > 0.0) & ((deviations > 1e-6 * sizes[:, None]) | ~is_noisy)
    is_narrow = ~np.isin(np.arange(len(patches.corners)), patches.parents)
    begins = np.einsum("ipa,pa->ip", normals, patches.supports) + radius * cosines
    if displacements is not None:
        begins += np.einsum("ipa,ia->ip", normals, displacements)
    # The level surface is `least` deviations away: what is left in front of it is the shift.
    offsets = begins - deviations * _margin(shifts)[:, None]
    return Cones(
        normals,
        np.where(is_there, offsets, np.inf),
        np.where(is_there, deviations, 1.0),
        patches.parents,
        np.any(~is_there & is_narrow, axis=1) | np.isnan(least),
    )


def _margin(shifts: Vector) -> Vector:
    """Return shifts where they are known, else 0."""
    return np.where(np.isnan(shifts), 0.0, shifts)


def _directions(patches: Patches, covariances: Tensor) -> Tensor:
    """Return unit directions in meters, (I, k, 3)."""
    count = len(covariances)
    if not patches.is_even:
        return np.broadcast_to(patches.directions, (count, *patches.directions.shape))
    values, vectors = np.linalg.eigh(covariances)
    values = np.sqrt(np.maximum(values, 0.0))
    largest = values[:, -1:]
    values = np.where(largest > 0.0, np.maximum(values, _FLATTEST * largest), 1.0)
    inverse = np.einsum("iak,ik,ibk->iab", vectors, 1.0 / values, vectors)
    found = np.einsum("iab,kb->ika", inverse, patches.directions)
    return np.asarray(found / np.linalg.norm(found, axis=2)[..., None])
