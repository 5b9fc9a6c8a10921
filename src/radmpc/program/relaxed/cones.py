"""Cones of directions around a hazard in the plane, between points of a level curve."""

from __future__ import annotations

import numpy as np

from radmpc.arrays import Indices, Matrix, Tensor
from radmpc.program.relaxed.arcs import even_arcs, face_arcs
from radmpc.program.relaxed.level_curves import (
    LevelCurve,
    Outline,
    PlaneNoise,
    axes_of,
    level_curve,
)
from radmpc.program.relaxed.normals import chosen_normals, roots_of
from radmpc.program.relaxed.tails import Tails
from radmpc.records import dataclass

__all__ = ["Cones", "cones_around"]

_SAME = 1e-9
"""Length below which two points of a level curve are one [m]."""

_TWIN = 1e-6
"""Distance of two unit vectors below which they are one direction [-]."""


@dataclass(frozen=True, slots=True, eq=False)
class Cones:
    """Affine functions above the distance, one per cone: ``(normal · x − offset) / deviation``.

    Wide cones are made of narrower ones and ask for less; the narrowest, which nothing refines, are
    what counts.

    Attributes
    ----------
    normals : (I, c, 2) array
        Unit vectors away from the hazard [-].
    offsets : (I, c) array
        What the half-space begins at [m]; inf where there is no cone.
    deviations : (I, c) array
        What one standard deviation is along the normal [m], at most what it is in truth.
    parents : (c,) int array
        The wider cone that each is part of; -1 where there is none.
    is_void : (I,) bool array
        Instants at which nothing is asked: the hazard is too small beside the noise.
    """

    normals: Tensor
    offsets: Matrix
    deviations: Matrix
    parents: Indices
    is_void: np.ndarray

    def take(self, chosen: Indices) -> Cones:
        """Return the cones at some of the instants, by their numbers."""
        normals, offsets = self.normals[chosen], self.offsets[chosen]
        deviations, is_void = self.deviations[chosen], self.is_void[chosen]
        return Cones(normals, offsets, deviations, self.parents, is_void)


def cones_around(outline: Outline, covariances: Tensor, tails: Tails, directions: Tensor) -> Cones:
    """Return the cones between neighboring directions around a hazard, and wider ones.

    Let n(θ) be a direction, p its support point on the outline and ``d = Σ n / |n|_Σ``. The points
    ``x = p + radius · n + least · d`` are the level curve at the least distance. Any mean at a
    distance q >= least is ``x + (q − least) d`` for one of them. If its direction lies between two
    given ones, ``m · x >= o`` for the chord's outward normal m, because the curve is convex, and
    ``m · d`` is no less than the smaller of its values at the two, because the angle between m and
    n in the metric Σ is largest there. So ``q <= least + (m · x̄ − o) / min(m · d)``.

    Where a disc within a polygon says too little, the level curve is the hull of means at which the
    polygon is hit with probability Δ at least, and q the distance from that, see `level_points`.

    Parameters
    ----------
    outline : Outline
        The hazard.
    covariances : (I, 2, 2) array
        Of the position relative to it [m²].
    tails : Tails
        What charges are at least.
    directions : (I, k, 2) array
        Unit vectors in the metric in which the noise is the same all around; k >= 3, no two
        neighbors a half turn apart.

    Returns
    -------
    Cones
        At most twice as many narrow ones as directions and faces together.
    """
    values, vectors = np.linalg.eigh(covariances)
    roots = roots_of(values, vectors)
    chosen = chosen_normals(outline.faces, roots, directions)
    noise = PlaneNoise(covariances, values, roots)
    curve, is_void = level_curve(outline, noise, tails, chosen.normals)
    count = curve.points.shape[1]
    beside = chosen.beside_faces
    arcs = even_arcs(count) if beside is None else face_arcs(count, beside)
    firsts, lasts, parents = arcs.firsts, arcs.lasts, arcs.parents
    normals, offsets, deviations, is_cone, is_wide = _spanned(curve, firsts, lasts)
    is_flat = (deviations < 1e-6 * curve.sizes[:, None]) & (curve.sizes > 0.0)[:, None]
    is_narrow = np.arange(firsts.size) < count
    # Nothing is known of some directions, as where all the noise is along one line: then of none.
    is_void = is_void | np.any((is_wide | (is_cone & is_flat)) & is_narrow, axis=1)
    is_there = is_cone & ~is_wide & (is_narrow | ~is_flat)
    margins = deviations * curve.margins[:, None]
    return Cones(
        normals, np.where(is_there, offsets - margins, np.inf), deviations, parents, is_void
    )


def _spanned(
    curve: LevelCurve, firsts: Indices, lasts: Indices
) -> tuple[Tensor, Matrix, Matrix, np.ndarray, np.ndarray]:
    """Return normals, offsets and deviations of arcs of a level curve.

    And which are arcs at all, and which of a half turn or more: nothing can be said of these.
    """
    (bx, by), (ex, ey) = axes_of(curve.points[:, firsts]), axes_of(curve.points[:, lasts])
    (ax, ay), (zx, zy) = axes_of(curve.normals[:, firsts]), axes_of(curve.normals[:, lasts])
    along, up = ex - bx, ey - by
    is_chord = np.sqrt(along * along + up * up) > _SAME
    normals = np.empty((*along.shape, 2))
    across = np.where(is_chord, up, ax + zx), np.where(is_chord, -along, ay + zy)
    lengths = np.maximum(np.sqrt(across[0] * across[0] + across[1] * across[1]), 1e-300)
    nx, ny = np.divide(across[0], lengths), np.divide(across[1], lengths)
    normals[..., 0], normals[..., 1] = nx, ny
    offsets = np.minimum(nx * bx + ny * by, nx * ex + ny * ey)
    (gx, gy), (hx, hy) = axes_of(curve.gradients[:, firsts]), axes_of(curve.gradients[:, lasts])
    deviations = np.minimum(nx * gx + ny * gy, nx * hx + ny * hy)
    # A half turn exactly comes out as either sign.
    sines = ax * zy - ay * zx
    is_wide = (sines < -_TWIN) | ((sines < _TWIN) & (ax * zx + ay * zy < 0.0))
    is_single = (np.abs(ax - zx) < 1e-12) & (np.abs(ay - zy) < 1e-12)
    return normals, offsets, deviations, is_chord | ~is_single, is_wide
