r"""Probability that a planar Gaussian lies in a convex polygon grown by a radius, from above.

The grown polygon's outline is a closed chain of its sides, moved out by the radius, and of arcs
around its corners; a disc is the polygon of one corner. In coordinates that make the Gaussian
standard, with t toward the set, the probability is an integral along that outline, taken by Gauss
rules whose error is bounded, not estimated (see `radmpc.referee.bound.contour`), at any ratio of
deviations. The bound is added, and so is all that rounding can do.
"""

from __future__ import annotations

import numpy as np

from radmpc.arrays import Indices, Matrix, Tensor, Vector
from radmpc.referee.bound.contour import enclosed
from radmpc.referee.bound.outlines import Outlines

__all__ = ["grown_polygon_risks"]

_FLATTEST = 1e-15
"""Determinant of a covariance, as a share of the larger variance squared [-], below which it is
singular up to rounding and left to half-spaces."""

_FINEST = 1e-14
"""Smaller deviation, as a share of the largest coordinate [-], below which a covariance is left to
half-spaces, too: places along outlines have no more digits than that."""

_ROUNDING = 16.0
"""Units in the last place of the largest coordinate by which radii are rounded up, and one more for
each corner: more than rounding moves any point of an outline."""

_MARKS = np.array([-10.0, -5.0, 0.0, 5.0, 10.0])
"""Ends of the first pieces [standard deviations], along the outline from its nearest point."""


def grown_polygon_risks(
    means: Matrix,
    covariances: Tensor,
    vertices: Tensor,
    radii: Vector,
    normals: Matrix,
    bounds: Vector,
) -> Vector:
    """Return the probability of being within a radius of a polygon, or the half-space bound.

    Parameters
    ----------
    means : (S, 2) array
        Means [m].
    covariances : (S, 2, 2) array
        Covariances [m²].
    vertices : (S, V, 2) array
        Corners of convex polygons, in any order, repeated ones allowed [m].
    radii : (S,) array
        Radii [m].
    normals : (S, 2) array
        Best half-space found, away from the set: speed and tightness depend on it, nothing else.
    bounds : (S,) array
        Its risk, returned where it is smaller or the covariance is singular, or too small for the
        coordinates' digits.

    Returns
    -------
    (S,) array
        Not below the true value. Along the best half-space relatively at most 1e-6 above it where
        deviations are larger than 1e-10 of the coordinates, and the set and its chords not thinner
        than 1e-6 deviations; measured 6e-5 where one deviation is 1e7 times the other.
    """
    result = bounds.copy()
    variances = np.diagonal(covariances, axis1=1, axis2=2)
    # The axis of the larger variance comes first.
    axes = np.where(variances[:, :1] >= variances[:, 1:], [0, 1], [1, 0])
    large = np.take_along_axis(variances, axes[:, :1], axis=1)[:, 0]
    determinants = _determinants(covariances)
    size = np.abs(vertices).max(axis=(1, 2)) + np.abs(means).max(axis=1) + radii
    finest = np.square(_FINEST * size) * large
    usable = np.flatnonzero(determinants > np.maximum(_FLATTEST * np.square(large), finest))
    if not usable.size:
        return result
    axes = axes[usable]
    standard = _whitening(covariances[usable, 0, 1], large[usable], determinants[usable])
    corners = np.take_along_axis(vertices[usable], axes[:, None, :], axis=2)
    middles = np.take_along_axis(means[usable], axes, axis=1)
    outward = np.take_along_axis(normals[usable], axes, axis=1)
    units = np.finfo(float).eps * (_ROUNDING + corners.shape[1])
    grown = radii[usable] + units * size[usable]
    corners, angles = _convex(corners - middles[:, None, :])
    outlines, begin, end = _outlines(standard, corners, angles, grown, outward)
    element, begin, end = _first_pieces(outlines, begin, end, outward)
    exact = enclosed(outlines, element, begin, end, len(usable))
    result[usable] = np.fmin(result[usable], exact)
    return result


def _determinants(covariances: Tensor) -> Vector:
    """Return determinants, accurate however flat: products are split into exact parts."""
    product, rest = _product(covariances[:, 0, 0], covariances[:, 1, 1])
    square, lost = _product(covariances[:, 0, 1], covariances[:, 0, 1])
    return (product - square) + (rest - lost)


def _product(a: Vector, b: Vector) -> tuple[Vector, Vector]:
    """Return products and what rounding took from them (Dekker 1971)."""
    (high_a, low_a), (high_b, low_b) = _halves(a), _halves(b)
    product = a * b
    rest = ((high_a * high_b - product) + high_a * low_b + low_a * high_b) + low_a * low_b
    return product, rest


def _halves(a: Vector) -> tuple[Vector, Vector]:
    """Return the upper and lower 26 bits."""
    shifted = 134217729.0 * a
    high = shifted - (shifted - a)
    return high, a - high


def _whitening(covariance: Vector, large: Vector, determinants: Vector) -> Tensor:
    """Return inverse Cholesky factors, (S, 2, 2)."""
    standard = np.zeros((len(large), 2, 2))
    standard[:, 0, 0] = 1.0 / np.sqrt(large)
    standard[:, 1, 1] = np.sqrt(large / determinants)
    standard[:, 1, 0] = -covariance / large * standard[:, 1, 1]
    return standard


def _convex(corners: Tensor) -> tuple[Tensor, Matrix]:
    """Return corners counter-clockwise and the angles of the sides that begin there, rising.

    Sides sorted by their angles and chained are a convex polygon, whatever rounding has done to
    repeated corners and to corners on a side.
    """
    if corners.shape[1] == 1:
        # A disc, as of every pair: nothing to sort.
        return corners, np.zeros(corners.shape[:2])
    offsets = corners - corners.mean(axis=1, keepdims=True)
    order = np.argsort(np.arctan2(offsets[:, :, 1], offsets[:, :, 0]), axis=1, kind="stable")
    corners = np.take_along_axis(corners, order[:, :, None], axis=1)
    sides = np.roll(corners, -1, axis=1) - corners
    angles = np.arctan2(sides[:, :, 1], sides[:, :, 0])
    order = np.argsort(angles, axis=1, kind="stable")
    sides = np.take_along_axis(sides, order[:, :, None], axis=1)
    # Angles from -pi on begin at the top, at its left end.
    heights = corners[:, :, 1]
    top = heights == heights.max(axis=1, keepdims=True)
    first = np.where(top, corners[:, :, 0], np.inf).argmin(axis=1)
    start = np.take_along_axis(corners, first[:, None, None], axis=1)
    chained = start + np.cumsum(sides, axis=1) - sides
    return chained, np.take_along_axis(angles, order, axis=1)


def _outlines(
    standard: Tensor, corners: Tensor, angles: Matrix, radii: Vector, outward: Matrix
) -> tuple[Outlines, Vector, Vector]:
    """Return all sides and arcs and where each begins and ends."""
    num_sites, num_corners = angles.shape
    sides = np.roll(corners, -1, axis=1) - corners
    normals = angles - 0.5 * np.pi
    aside = np.stack([np.cos(normals), np.sin(normals)], axis=2) * radii[:, None, None]
    previous = np.concatenate([normals[:, -1:] - 2.0 * np.pi, normals[:, :-1]], axis=1)
    # Of each corner the side that begins there, then the arc around it.
    place, slope, even, odd = np.zeros((4, num_sites, 2, num_corners, 2))
    place[:, 0] = _turned(standard, corners + aside)
    place[:, 1] = _turned(standard, corners)
    slope[:, 0] = _turned(standard, sides)
    even[:, 1] = (radii[:, None] * standard[:, :, 0])[:, None]
    odd[:, 1] = (radii[:, None] * standard[:, :, 1])[:, None]
    place, slope, even, odd = (each.reshape(-1, 2) for each in (place, slope, even, odd))
    curved = np.tile(np.repeat([False, True], num_corners), num_sites)
    begin = np.stack([np.zeros_like(angles), previous], axis=1).ravel()
    end = np.stack([np.ones_like(angles), normals], axis=1).ravel()
    # Repeated corners make sides and arcs of nothing.
    real = (begin < end) & (curved | slope.any(axis=1))
    outlines = Outlines(
        site=np.repeat(np.arange(num_sites), 2 * num_corners)[real],
        place=place[real],
        slope=slope[real],
        even=even[real],
        odd=odd[real],
        curved=curved[real],
        turn=_ahead(standard, outward),
    )
    return outlines, begin[real], end[real]


def _turned(standard: Tensor, vectors: Tensor) -> Tensor:
    """Return vectors, (S, V, 2), in standard coordinates; their matrices are lower triangular."""
    turned = np.empty_like(vectors)
    turned[..., 0] = standard[:, 0, 0, None] * vectors[..., 0]
    turned[..., 1] = standard[:, 1, 0, None] * vectors[..., 0]
    turned[..., 1] += standard[:, 1, 1, None] * vectors[..., 1]
    return turned


def _ahead(standard: Tensor, outward: Matrix) -> Matrix:
    """Return unit vectors toward the sets, in standard coordinates."""
    across, along, skew = standard[:, 0, 0], standard[:, 1, 1], standard[:, 1, 0]
    ahead = np.stack([skew / along * outward[:, 1] - outward[:, 0], -outward[:, 1]], axis=1)
    ahead /= np.stack([across, along], axis=1)
    return np.asarray(ahead / np.linalg.norm(ahead, axis=1, keepdims=True))


def _first_pieces(
    outlines: Outlines, begin: Vector, end: Vector, outward: Matrix
) -> tuple[Indices, Vector, Vector]:
    """Return pieces around the nearest place of each element: elements, begins and ends."""
    square = np.square(outlines.slope).sum(axis=1)
    line = -(outlines.place * outlines.slope).sum(axis=1) / np.where(square > 0.0, square, 1.0)
    facing = np.arctan2(outward[:, 1], outward[:, 0])[outlines.site]
    turned = np.mod(facing - begin, 2.0 * np.pi)
    past = turned - (end - begin)
    arc = begin + np.where(past <= 0.5 * (2.0 * np.pi - (end - begin)), turned, 0.0)
    nearest = np.clip(np.where(outlines.curved, arc, line), begin, end)
    local = outlines.expand(np.arange(len(nearest)), nearest)
    s, t, s1, t1, s2, t2 = local.numbers
    rate = np.square(s1) + np.square(t1)
    rate += np.hypot(s, t) * np.hypot(s2, t2)
    marks = nearest[:, None] + _MARKS / np.sqrt(np.where(rate > 0.0, rate, 1.0))[:, None]
    marks = np.concatenate([begin[:, None], marks, end[:, None]], axis=1)
    marks = np.clip(marks, begin[:, None], end[:, None])
    element = np.repeat(np.arange(len(nearest)), len(_MARKS) + 1)
    begin, end = marks[:, :-1].ravel(), marks[:, 1:].ravel()
    # Marks beyond an end make pieces of nothing.
    real = begin < end
    return element[real], begin[real], end[real]
