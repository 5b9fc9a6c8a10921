"""Level curves of the distance from a hazard in the plane, in standard deviations."""

from __future__ import annotations

import numpy as np

from radmpc.arrays import Indices, Matrix, Tensor, Vector
from radmpc.program.relaxed.level_sets import level_points
from radmpc.program.relaxed.tails import DiscTails, Tails
from radmpc.records import dataclass

__all__ = ["LevelCurve", "Outline", "PlaneNoise", "axes_of", "level_curve"]

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
class PlaneNoise:
    """Of a position relative to a hazard.

    Attributes
    ----------
    covariances : (I, 2, 2) array
        Covariances [m²].
    values : (I, 2) array
        Their eigenvalues, the smaller one first [m²].
    roots : (I, 2, 2) array
        Their roots, see `roots_of` [m].
    """

    covariances: Tensor
    values: Matrix
    roots: Tensor


@dataclass(frozen=True, slots=True, eq=False)
class LevelCurve:
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


def level_curve(
    outline: Outline, noise: PlaneNoise, tails: Tails, normals: Tensor
) -> tuple[LevelCurve, np.ndarray]:
    """Return the level curve at the least distance from a hazard, and where none is known.

    Parameters
    ----------
    outline : Outline
        The hazard.
    noise : PlaneNoise
        Of the position relative to it, at the same instants.
    tails : Tails
        What charges are at least.
    normals : (I, k, 2) array
        Unit vectors, counter-clockwise.

    Returns
    -------
    curve : LevelCurve
        Two points per direction: the ends of the side that it supports.
    is_void : (I,) bool array
        Instants at which nothing is asked.
    """
    least, shifts, is_void = _least(outline.radius, noise.values, tails)
    along = np.einsum("iab,ikb->ika", noise.covariances, normals)
    lengths = np.sqrt(np.maximum(np.einsum("ika,ika->ik", normals, along), 0.0))
    gradients = along / np.where(lengths > 0.0, lengths, 1.0)[..., None]
    first, last = _sides_of(outline.vertices, normals)
    first, last = first + outline.radius * normals, last + outline.radius * normals
    far, margins = least[:, None, None] * gradients, least + shifts
    ends = first + far, last + far
    is_loose = _are_loose(noise.values, shifts, is_void, is_disc=not outline.faces.shape[1])
    if isinstance(tails, DiscTails) and is_loose.any():
        some = np.flatnonzero(is_loose)
        support = first[some], last[some]
        means, is_reached = level_points(support, normals[some], noise.roots[some], tails.level)
        some, means = some[is_reached], means[is_reached]
        for end, of_hull in zip(ends, _sides_of(means, normals[some]), strict=True):
            end[some] = of_hull
        margins[some], is_void[some] = tails.level, False
    sizes = np.sqrt(np.maximum(noise.covariances[:, 0, 0] + noise.covariances[:, 1, 1], 0.0))
    curve = LevelCurve(
        _interleaved(*ends),
        _interleaved(normals, normals),
        _interleaved(gradients, gradients),
        margins,
        sizes,
    )
    return curve, is_void


def axes_of(vectors: Tensor) -> tuple[Matrix, Matrix]:
    """Return both coordinates of vectors of the plane, as numpy is slow over axes of two.

    Parameters
    ----------
    vectors : (..., 2) array
        The vectors.
    """
    return vectors[..., 0], vectors[..., 1]


def _least(radius: float, variances: Matrix, tails: Tails) -> tuple[Vector, Vector, Vector]:
    """Return the least distance and the shift at every instant, and whether none is known."""
    small, large = axes_of(np.sqrt(np.maximum(variances, 0.0)))
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
    variances: Matrix, shifts: Vector, is_void: np.ndarray, *, is_disc: bool
) -> np.ndarray:
    """Return where a disc within a polygon, or within an ellipse, says much less than these do."""
    small, large = axes_of(variances)
    is_regular = small > np.square(_LINE) * large
    if is_disc:
        is_regular &= small * _ROUND < large
    return np.asarray(is_regular & (is_void | (shifts > _LOOSE)))


def _sides_of(vertices: Tensor, normals: Tensor) -> tuple[Tensor, Tensor]:
    """Return what `_support_points` does, but each side once where two directions coincide.

    Not once there and once back.
    """
    first, last = _support_points(vertices, normals)
    (x, y), (before_x, before_y) = (
        axes_of(normals),
        axes_of(normals[:, np.arange(-1, normals.shape[1] - 1)]),
    )
    is_twin = np.square(x - before_x) + np.square(y - before_y) < np.square(_TWIN)
    return np.where(is_twin[..., None], last, first), last


def _support_points(vertices: Tensor, normals: Tensor) -> tuple[Tensor, Tensor]:
    """Return the first and the last corner, counter-clockwise, that each normal supports."""
    if vertices.shape[1] == 1:
        only = np.broadcast_to(vertices, normals.shape)
        return only, only
    (nx, ny), (vx, vy) = axes_of(normals[:, :, None]), axes_of(vertices[:, None])
    heights, along = nx * vx + ny * vy, nx * vy - ny * vx
    top = heights.max(axis=2, keepdims=True)
    is_top = heights >= top - 1e-9 * (1.0 + np.abs(top))
    first = np.where(is_top, along, np.inf).argmin(axis=2)
    last = np.where(is_top, along, -np.inf).argmax(axis=2)
    instants = 0 if len(vertices) == 1 else np.arange(len(normals))[:, None]
    return vertices[instants, first], vertices[instants, last]


def _interleaved(first: Tensor, second: Tensor) -> Tensor:
    """Return one point of each in turn, (I, 2 k, 2)."""
    return np.stack([first, second], axis=2).reshape(len(first), -1, first.shape[2])
