"""Level curves around a hazard in the plane, and the cones of directions between their points."""

from __future__ import annotations

import numpy as np

from radmpc.arrays import Indices, Matrix, Tensor, Vector
from radmpc.program.relaxed.arcs import even_arcs, face_arcs
from radmpc.program.relaxed.level_sets import level_points
from radmpc.program.relaxed.normals import chosen_normals, roots_of
from radmpc.program.relaxed.tails import DiscTails, Tails
from radmpc.records import dataclass

__all__ = ["Cones", "Outline", "cones_around"]

_SAME = 1e-9
"""Length below which two points of a level curve are one [m]."""

_TWIN = 1e-6
"""Distance of two unit vectors below which they are one direction [-]."""

_LINE = 1e-6
"""Share of the larger deviation up to which noise counts as along a line [-]: directions cannot be
parted in its metric, and nothing is asked."""

_ROUND = 2.0
"""Ratio of the variances of the noise up to which a disc is left a disc [-]: with sixteen times the
disturbance along one axis, gaps of `paper(6)` are 0.81 % in the mean instead of 0.86."""

_LOOSE = 0.3
"""What a disc within a polygon loses from which on the polygon's own level set is looked for
[standard deviations], a millisecond for ten instants: with 0.2 `paper(8)` in disturbances of
correlation 0.8 takes 1.06 of the time, for gaps of 1.11 instead of 1.12 %. With none, those to
plans past a box of 1 by 2 m that is known within 0.3 m and 0.06 m/s are 9.4 % in the mean of ten
draws instead of 3.7."""


@dataclass(frozen=True, slots=True, eq=False)
class Outline:
    """A convex hazard at I instants.

    Attributes
    ----------
    vertices : (I or 1, v, 2) array
        Its corners, counted in any order; points within the hull do no harm [m].
    faces : (I or 1, f, 2) array
        Outward unit normals of its faces; f is 0 for a point.
    radius : float
        By how much it is grown [m].
    """

    vertices: Tensor
    faces: Tensor
    radius: float

    def take(self, chosen: Indices) -> Outline:
        """Return the hazard at some of the instants, by their numbers."""
        vertices = self.vertices if len(self.vertices) == 1 else self.vertices[chosen]
        faces = self.faces if len(self.faces) == 1 else self.faces[chosen]
        return Outline(vertices, faces, self.radius)


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


@dataclass(frozen=True, slots=True, eq=False)
class _LevelCurve:
    """Points of a level curve, counter-clockwise, two per direction.

    Attributes
    ----------
    points, normals, gradients : (I, c, 2) array
        Where, the outward normal there [-], and where the distance grows by one deviation [m].
    margins : (I,) array
        Deviations at which tails begin: the least distance and the shift [-].
    sizes : (I,) array
        Size of the noise [m].
    """

    points: Tensor
    normals: Tensor
    gradients: Tensor
    margins: Vector
    sizes: Vector


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
    roots = roots_of(covariances)
    chosen = chosen_normals(outline.faces, roots, directions)
    curve, is_void = _level_curve(outline, covariances, tails, chosen.normals, roots)
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


def _level_curve(
    outline: Outline, covariances: Tensor, tails: Tails, normals: Tensor, roots: Tensor
) -> tuple[_LevelCurve, np.ndarray]:
    """Return the level curve at the least distance, and where none is known."""
    least, shifts, is_void = _least(outline.radius, covariances, tails)
    along = np.einsum("iab,ikb->ika", covariances, normals)
    lengths = np.sqrt(np.maximum(np.einsum("ika,ika->ik", normals, along), 0.0))
    gradients = along / np.where(lengths > 0.0, lengths, 1.0)[..., None]
    first, last = _sides_of(outline.vertices, normals)
    first, last = first + outline.radius * normals, last + outline.radius * normals
    far, margins = least[:, None, None] * gradients, least + shifts
    ends = first + far, last + far
    is_loose = _are_loose(covariances, shifts, is_void, is_disc=not outline.faces.shape[1])
    if isinstance(tails, DiscTails) and is_loose.any():
        some = np.flatnonzero(is_loose)
        support = first[some], last[some]
        means, is_reached = level_points(support, normals[some], roots[some], tails.level)
        some, means = some[is_reached], means[is_reached]
        for end, of_hull in zip(ends, _sides_of(means, normals[some]), strict=True):
            end[some] = of_hull
        margins[some], is_void[some] = tails.level, False
    sizes = np.sqrt(np.maximum(np.trace(covariances, axis1=1, axis2=2), 0.0))
    curve = _LevelCurve(
        _interleaved(*ends),
        _interleaved(normals, normals),
        _interleaved(gradients, gradients),
        margins,
        sizes,
    )
    return curve, is_void


def _spanned(
    curve: _LevelCurve, firsts: Indices, lasts: Indices
) -> tuple[Tensor, Matrix, Matrix, np.ndarray, np.ndarray]:
    """Return normals, offsets and deviations of arcs of a level curve.

    And which are arcs at all, and which of a half turn or more: nothing can be said of these.
    """
    begin, end = curve.points[:, firsts], curve.points[:, lasts]
    chords = end - begin
    lengths = np.linalg.norm(chords, axis=2)
    across = np.stack([chords[..., 1], -chords[..., 0]], axis=2)
    one, two = curve.normals[:, firsts], curve.normals[:, lasts]
    turned = np.where(lengths[..., None] > _SAME, across, one + two)
    turned /= np.maximum(np.linalg.norm(turned, axis=2), 1e-300)[..., None]
    offsets = np.minimum(
        np.einsum("ica,ica->ic", turned, begin), np.einsum("ica,ica->ic", turned, end)
    )
    deviations = np.minimum(
        np.einsum("ica,ica->ic", turned, curve.gradients[:, firsts]),
        np.einsum("ica,ica->ic", turned, curve.gradients[:, lasts]),
    )
    angles = np.arctan2(
        one[..., 0] * two[..., 1] - one[..., 1] * two[..., 0], (one * two).sum(axis=2)
    )
    # A half turn exactly comes out as either sign.
    is_wide = (angles < -_TWIN) | (angles > np.pi - _TWIN)
    is_single = np.all(np.abs(one - two) < 1e-12, axis=2)
    return turned, offsets, deviations, (lengths > _SAME) | ~is_single, is_wide


def _least(radius: float, covariances: Tensor, tails: Tails) -> tuple[Vector, Vector, Vector]:
    """Return the least distance and the shift at every instant, and whether none is known."""
    values = np.sqrt(np.maximum(np.linalg.eigvalsh(covariances), 0.0))
    small, large = values[:, 0], values[:, -1]
    is_certain = large == 0.0
    # An ellipse with semi-axes a >= b contains the disc of radius b²/a that touches it anywhere.
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        radii = radius * small / large**2
    least, shifts = tails.at(np.where(is_certain, 0.0, radii))
    is_line = small <= _LINE * large
    is_void = (np.isnan(least) | is_line) & ~is_certain
    return (
        np.where(np.isnan(least), 0.0, least),
        np.where(np.isnan(least), 0.0, shifts),
        is_void,
    )


def _are_loose(
    covariances: Tensor, shifts: Vector, is_void: np.ndarray, *, is_disc: bool
) -> np.ndarray:
    """Return where a disc within a polygon, or within an ellipse, says much less than these do."""
    values = np.linalg.eigvalsh(covariances)
    is_regular = values[:, 0] > np.square(_LINE) * values[:, 1]
    if is_disc:
        is_regular &= values[:, 0] * _ROUND < values[:, 1]
    return np.asarray(is_regular & (is_void | (shifts > _LOOSE)))


def _sides_of(vertices: Tensor, normals: Tensor) -> tuple[Tensor, Tensor]:
    """Return what `_support_points` does, but each side once where two directions coincide.

    Not once there and once back.
    """
    first, last = _support_points(vertices, normals)
    is_twin = np.linalg.norm(normals - np.roll(normals, 1, axis=1), axis=2) < _TWIN
    return np.where(is_twin[..., None], last, first), last


def _support_points(vertices: Tensor, normals: Tensor) -> tuple[Tensor, Tensor]:
    """Return the first and the last corner, counter-clockwise, that each normal supports."""
    vertices = np.broadcast_to(vertices, (len(normals), *vertices.shape[1:]))
    heights = np.einsum("ika,iva->ikv", normals, vertices)
    top = heights.max(axis=2, keepdims=True)
    is_top = heights >= top - 1e-9 * (1.0 + np.abs(top))
    across = np.stack([-normals[..., 1], normals[..., 0]], axis=2)
    along = np.einsum("ika,iva->ikv", across, vertices)
    first = np.where(is_top, along, np.inf).argmin(axis=2)
    last = np.where(is_top, along, -np.inf).argmax(axis=2)
    return (
        np.take_along_axis(vertices, first[..., None], axis=1),
        np.take_along_axis(vertices, last[..., None], axis=1),
    )


def _interleaved(first: Tensor, second: Tensor) -> Tensor:
    """Return one point of each in turn, (I, 2 k, 2)."""
    return np.stack([first, second], axis=2).reshape(len(first), -1, first.shape[2])
