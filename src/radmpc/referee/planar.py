r"""Exact probability that a planar Gaussian lies in a convex polygon grown by a radius.

A disc is the polygon of one corner. In coordinates that make the Gaussian standard and put the
nearest point of the set straight ahead, s across and t along,

.. math:: \Pr = \int \varphi(s)\,\bigl[Q(t_0(s)) - Q(t_1(s))\bigr]\,ds,

where the set's chord at s runs from t₀ to t₁. The integral is taken by Gauss-Kronrod rules that
are halved until their error is below 3e-7 of the value; the error is added.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.special import ndtr

from radmpc.arrays import Indices, Matrix, Tensor, Vector

__all__ = ["grown_polygon_risks"]

# Beyond 8.5 deviations across there is 2e-17 of what the half-space holds, which is added.
_WIDTH = 8.5
_REL_TOL = 3e-7
_ROUNDS = 14
# Covariances flatter than this are left to half-spaces.
_FLATTEST = 1e-9

_KRONROD = np.array(
    [
        0.991455371120812639206854697526329,
        0.949107912342758524526189684047851,
        0.864864423359769072789712788640926,
        0.741531185599394439863864773280788,
        0.586087235467691130294144691693437,
        0.405845151377397166906606412076961,
        0.207784955007898467600689403773245,
        0.0,
    ]
)
_KRONROD_WEIGHTS = np.array(
    [
        0.022935322010529224963732008058970,
        0.063092092629978553290700663189204,
        0.104790010322250183839876322541518,
        0.140653259715525918745189590510238,
        0.169004726639267902826583426598550,
        0.190350578064785409913256402421014,
        0.204432940075298892414161999234649,
        0.209482141084727828012999174891714,
    ]
)
_GAUSS_WEIGHTS = np.array(
    [
        0.129484966168869693270611432679082,
        0.279705391489276667901467771423780,
        0.381830050505118944950369775488975,
        0.417959183673469387755102040816327,
    ]
)
_NODES = np.concatenate([-_KRONROD[:-1], _KRONROD[::-1]])
_WEIGHTS = np.concatenate([_KRONROD_WEIGHTS[:-1], _KRONROD_WEIGHTS[::-1]])
# The embedded Gauss rule uses every second node.
_EMBEDDED = np.zeros(15)
_EMBEDDED[1::2] = np.concatenate([_GAUSS_WEIGHTS[:-1], _GAUSS_WEIGHTS[::-1]])


@dataclass(frozen=True, slots=True, eq=False)
class _Chords:
    """Lines through grown polygons, one family per site: ``x = mean + s across + t ahead``.

    Corners are relative to the mean; sides are the polygon's, moved out by the radius.
    """

    across: Matrix
    ahead: Matrix
    corners: Tensor
    side_begins: Tensor
    side_ends: Tensor
    radii: Vector

    def ends(self, sites: Indices, s: Matrix) -> tuple[Matrix, Matrix]:
        """Return where lines enter and leave, (M, q); inf and -inf where they miss."""
        ahead = self.ahead[sites]
        length = np.hypot(ahead[:, 0], ahead[:, 1])[:, None, None]
        forward = ahead[:, None, :] / length
        radii = self.radii[sites][:, None, None]
        shift = self.across[sites]
        slip_aside = _cross(forward, shift[:, None, :])[:, :, None] * s[:, None, :]
        slip_ahead = _dot(forward, shift[:, None, :])[:, :, None] * s[:, None, :]

        corners = self.corners[sites]
        aside = slip_aside - _cross(forward, corners)[:, :, None]
        middle = _dot(forward, corners)[:, :, None] - slip_ahead
        square = (radii - aside) * (radii + aside)
        half = np.sqrt(np.maximum(square, 0.0))
        missed = square < 0.0
        enter = np.where(missed, np.inf, middle - half).min(axis=1)
        leave = np.where(missed, -np.inf, middle + half).max(axis=1)
        if corners.shape[1] > 1:
            begins, ends = self.side_begins[sites], self.side_ends[sites]
            left = _cross(forward, begins)[:, :, None] - slip_aside
            right = _cross(forward, ends)[:, :, None] - slip_aside
            crosses = (left < 0.0) != (right < 0.0)
            fraction = left / np.where(crosses, left - right, 1.0)
            place = _dot(forward, begins)[:, :, None] - slip_ahead
            place = place + fraction * _dot(forward, ends - begins)[:, :, None]
            enter = np.minimum(enter, np.where(crosses, place, np.inf).min(axis=1))
            leave = np.maximum(leave, np.where(crosses, place, -np.inf).max(axis=1))
        return enter / length[:, 0], leave / length[:, 0]


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
        Best half-space found, away from the set: only the speed depends on it.
    bounds : (S,) array
        Its risk, returned where it is smaller or the covariance is too flat to integrate.

    Returns
    -------
    (S,) array
        At most 1e-6 above the true value, relatively, and not below it.
    """
    values, vectors = np.linalg.eigh(covariances)
    usable = np.flatnonzero(values[:, 0] > _FLATTEST * values[:, 1])
    result = bounds.copy()
    if not usable.size:
        return result
    roots = vectors[usable] * np.sqrt(values[usable])[:, None, :]
    turned = np.einsum("sdi,sd->si", roots, normals[usable])
    turned /= np.linalg.norm(turned, axis=1)[:, None]
    sideways = np.stack([-turned[:, 1], turned[:, 0]], axis=1)
    corners = _sorted_corners(vertices[usable]) - means[usable][:, None, :]
    chords = _chords(roots, turned, sideways, corners, radii[usable])
    inverse = vectors[usable] / np.sqrt(values[usable])[:, None, :]
    gauge = np.einsum("sdi,si->sd", inverse, sideways)
    spots = np.einsum("sd,svd->sv", gauge, corners)
    margin = radii[usable] * np.linalg.norm(gauge, axis=1)
    low, high = spots.min(axis=1) - margin, spots.max(axis=1) + margin
    cut = (low < -_WIDTH) | (high > _WIDTH)
    low, high = np.maximum(low, -_WIDTH), np.minimum(high, _WIDTH)
    inside = low < high
    exact = np.full(len(usable), np.inf)
    exact[inside] = _integrate(chords, np.flatnonzero(inside), low, high)
    exact += np.where(cut, 2.0 * ndtr(-_WIDTH) * bounds[usable], 0.0)
    result[usable] = np.minimum(result[usable], exact)
    return result


def _sorted_corners(vertices: Tensor) -> Tensor:
    """Return corners counter-clockwise."""
    offsets = vertices - vertices.mean(axis=1, keepdims=True)
    order = np.argsort(np.arctan2(offsets[:, :, 1], offsets[:, :, 0]), axis=1, kind="stable")
    return np.take_along_axis(vertices, order[:, :, None], axis=1)


def _chords(
    roots: Tensor, turned: Matrix, sideways: Matrix, corners: Tensor, radii: Vector
) -> _Chords:
    """Lay lines from each mean towards its set."""
    following = np.roll(corners, -1, axis=1)
    along = following - corners
    length = np.linalg.norm(along, axis=2, keepdims=True)
    outward = np.stack([along[:, :, 1], -along[:, :, 0]], axis=2)
    outward /= np.where(length > 0.0, length, 1.0)
    grown = radii[:, None, None] * outward
    return _Chords(
        across=np.einsum("sdi,si->sd", roots, sideways),
        ahead=np.einsum("sdi,si->sd", roots, -turned),
        corners=corners,
        side_begins=corners + grown,
        side_ends=following + grown,
        radii=radii,
    )


def _integrate(chords: _Chords, sites: Indices, low: Vector, high: Vector) -> Vector:
    """Return integrals over ``low <= s <= high`` plus their errors, per site."""
    # s = center + half sin(angle) takes the vertical tangents off both ends of a round set.
    center, half = 0.5 * (low + high), 0.5 * (high - low)
    ahead = np.arcsin(np.clip(-center[sites] / half[sites], -0.9, 0.9))
    quarter = np.full(len(sites), 0.5 * np.pi)
    marks = np.stack(
        [-quarter, 0.5 * (ahead - quarter), ahead, 0.5 * (ahead + quarter), quarter], axis=1
    )
    owner = np.repeat(np.arange(len(sites)), 4)
    begin, end = marks[:, :-1].ravel(), marks[:, 1:].ravel()
    settled, total_error = np.zeros(len(sites)), np.zeros(len(sites))
    for turn in range(_ROUNDS):
        value, error = _rules(chords, sites[owner], center, half, begin, end)
        count = np.bincount(owner, minlength=len(sites))
        total = settled + np.bincount(owner, value, len(sites))
        allowed = _REL_TOL * total / np.maximum(count, 1) / 2.0
        done = (error <= allowed[owner]) | (turn == _ROUNDS - 1)
        settled += np.bincount(owner[done], value[done], len(sites))
        total_error += np.bincount(owner[done], error[done], len(sites))
        owner, begin, end = owner[~done], begin[~done], end[~done]
        if not owner.size:
            break
        middle = 0.5 * (begin + end)
        owner = np.concatenate([owner, owner])
        begin, end = np.concatenate([begin, middle]), np.concatenate([middle, end])
    return settled + total_error


def _rules(
    chords: _Chords, sites: Indices, center: Vector, half: Vector, begin: Vector, end: Vector
) -> tuple[Vector, Vector]:
    """Return the 15-point value of each piece, and its distance from the 7-point one."""
    scale = 0.5 * (end - begin)
    angles = (0.5 * (begin + end))[:, None] + scale[:, None] * _NODES
    s = center[sites][:, None] + half[sites][:, None] * np.sin(angles)
    enter, leave = chords.ends(sites, s)
    # Tails on the side where they are small: no difference of numbers close to one.
    flip = enter + leave < 0.0
    near, far = np.where(flip, -leave, enter), np.where(flip, -enter, leave)
    mass = np.where(enter < leave, ndtr(-near) - ndtr(-far), 0.0)
    density = np.exp(-0.5 * np.square(s)) / np.sqrt(2.0 * np.pi)
    speed = half[sites][:, None] * np.cos(angles)
    heights = mass * density * speed * scale[:, None]
    value = heights @ _WEIGHTS
    return value, np.abs(value - heights @ _EMBEDDED)


def _cross(first: Tensor, second: Tensor) -> Tensor:
    """Return planar cross products over the last axis."""
    return np.asarray(first[..., 0] * second[..., 1] - first[..., 1] * second[..., 0])


def _dot(first: Tensor, second: Tensor) -> Tensor:
    """Return planar scalar products over the last axis."""
    return np.asarray(first[..., 0] * second[..., 0] + first[..., 1] * second[..., 1])
