"""Directions beside the faces, for starts and goals that the faces alone call contact.

Faces see a round hull as a box: what is apart along a diagonal may touch by every face. Where a
start or a goal is such a position, the direction that separates it best joins the faces of that
one avoidance. All others keep their faces.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from radmpc.arrays import Matrix, Vector
from radmpc.gaussian import GAUSSIAN, Tail, clearance
from radmpc.geometry import Polytope
from radmpc.program.joined import joined_faces
from radmpc.program.keepout import KeepOut

__all__ = ["best_clearance", "clearances", "opening_directions", "openings"]

_POOR = 1e-3
"""Risk of the best face from which on further directions are tried at a start or a goal [-]."""

_NEARLY = 0.99
"""Share of that risk from which it is computed once more, face by face [-]."""

_WORTH = 0.1
"""Share of that risk below which another direction must come to be added [-]."""

_HALVINGS = 80
"""Steps that bracket the multiplier of the nearest point, then bisections [-]: all digits of it."""


def clearances(
    mean: Vector, covariance: Matrix, normals: Matrix, corners: Matrix, radius: float
) -> Vector:
    """Return the clearance of half-spaces between a mean and a convex set.

    Parameters
    ----------
    mean : (d,) array
        Mean position, relative to the same origin as the corners [m].
    covariance : (d, d) array
        Its covariance [m²].
    normals : (f, d) array
        Unit normals that point away from the set.
    corners : (v, d) array
        Corners of the set [m].
    radius : float
        By how much it is grown [m].

    Returns
    -------
    (f,) array
        In standard deviations; without noise +inf where they touch at most, else −inf.
    """
    slack = normals @ mean - (normals @ corners.T).max(axis=1) - radius
    variances = np.einsum("fa,ab,fb->f", normals, covariance, normals)
    return clearance(slack, np.sqrt(np.maximum(variances, 0.0)))


def best_clearance(
    mean: Vector, covariance: Matrix, normals: Matrix, corners: Matrix, radius: float
) -> tuple[float, Vector]:
    """Return the largest clearance over faces and corners, and its direction.

    Parameters
    ----------
    mean, covariance, normals, corners, radius
        As in `clearances`; the normals are the faces of the set.

    Returns
    -------
    clearance : float
        In standard deviations. The largest of all directions in the plane, and for pairs; in
        space the edges of a polytope may allow more.
    direction : (d,) array
        Unit normal away from the set.
    """
    tried = np.vstack([normals, [_over_corner(mean - c, covariance, radius) for c in corners]])
    found = clearances(mean, covariance, tried, corners, radius)
    best = int(found.argmax())
    return float(found[best]), tried[best]


def openings(
    endpoints: tuple[tuple[Vector, Vector, Matrix], ...],
    keepouts: Sequence[KeepOut],
    radius: float,
    tail: Tail = GAUSSIAN,
) -> list[Matrix]:
    """Return what `opening_directions` finds for each set, asked only where it may find any.

    Parameters
    ----------
    endpoints : tuple of ((d,) array, (d,) array, (d, d) array)
        As there.
    keepouts : sequence of KeepOut
        The sets; nothing is found for those whose start is charged elsewhere.
    radius : float
        By how much they are grown [m].
    tail : Tail
        Of what the mean's deviations are.

    Returns
    -------
    list of (e, d) array
        Mostly empty ones.
    """
    found = [np.zeros((0, k.normals.shape[2])) for k in keepouts]
    asked = [i for i, k in enumerate(keepouts) if k.start is not None and k.shapes]
    if not asked:
        return found
    poor = _poorly_separated(endpoints, [keepouts[i].shapes for i in asked], radius, tail)
    for i, is_poor in zip(asked, poor, strict=True):
        first, last = keepouts[i].shapes[0], keepouts[i].shapes[-1]
        if is_poor:
            corners = (first.vertices, last.vertices)
            found[i] = opening_directions(endpoints, first.normals, corners, radius, tail)
    return found


def _poorly_separated(
    endpoints: tuple[tuple[Vector, Vector, Matrix], ...],
    shapes: Sequence[Sequence[Polytope]],
    radius: float,
    tail: Tail,
) -> list[bool]:
    """Tell from which sets the faces may not separate a start or a goal, all sets at once."""
    parts = []
    for first, last in ((some[0], some[-1]) for some in shapes):
        at_goal = first.offsets if last is first else last.support(first.normals)
        parts.append((first.normals, [first.offsets, at_goal]))
    normals, offsets = joined_faces(parts)
    worst = np.full(len(parts), np.inf)
    for (lower, upper, covariance), moment in zip(endpoints, (0, 1), strict=True):
        reached = np.maximum(normals * upper, normals * lower).sum(axis=2)
        variances = ((normals @ covariance) * normals).sum(axis=2)
        slack = reached - offsets[:, moment] - radius
        cleared = clearance(slack, np.sqrt(np.maximum(variances, 0.0)))
        worst = np.minimum(worst, cleared.max(axis=1))
    # A little less than what `opening_directions` asks for: it rounds in another order.
    return [risk > _NEARLY * _POOR for risk in tail.probability(worst).tolist()]


def opening_directions(
    endpoints: tuple[tuple[Vector, Vector, Matrix], ...],
    normals: Matrix,
    corners: tuple[Matrix, ...],
    radius: float,
    tail: Tail = GAUSSIAN,
) -> Matrix:
    """Return directions that separate where no face does.

    Parameters
    ----------
    endpoints : tuple of ((d,) array, (d,) array, (d, d) array)
        Boxes that hold the mean at the start and at the end [m], and its covariance [m²].
    normals : (f, d) array
        The faces.
    corners : tuple of (v, d) array
        Corners of the set at each of them [m].
    radius : float
        By how much it is grown [m].
    tail : Tail
        Of what the mean's deviations are.

    Returns
    -------
    (e, d) array
        At most one per endpoint; mostly none.
    """
    found: list[Vector] = []
    for (lower, upper, covariance), points in zip(endpoints, corners, strict=True):
        # Each face at the corner of the box that is best for it.
        best = -np.inf
        for normal in (*normals, *found):
            mean = np.where(normal > 0.0, upper, lower)
            one = clearances(mean, covariance, normal[None], points, radius)
            best = max(best, float(one[0]))
        risk = tail.probability(best)
        if risk <= _POOR:
            continue
        middle = points.mean(axis=0)
        away = np.where(0.5 * (lower + upper) >= middle, upper, lower)
        around, direction = best_clearance(away, covariance, normals, points, radius)
        if tail.probability(around) < _WORTH * risk:
            found.append(direction)
    return np.array(found).reshape(-1, normals.shape[1])


def _over_corner(gap: Vector, covariance: Matrix, radius: float) -> Vector:
    """Return the normal of the ball around a corner where it is nearest to a mean.

    Nearest in the metric of the noise: at ``y = (I + μ Σ)⁻¹ gap`` with ``|y| = radius``.
    """
    values, vectors = np.linalg.eigh(covariance)
    values = np.maximum(values, 0.0)
    along = vectors.T @ gap
    low, high = 0.0, 1.0 / max(float(values.max()), 1e-300)
    for _ in range(_HALVINGS):
        if np.linalg.norm(along / (1.0 + high * values)) <= radius or high > 1e200:
            break
        low, high = high, 4.0 * high
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        if np.linalg.norm(along / (1.0 + middle * values)) > radius:
            low = middle
        else:
            high = middle
    normal = vectors @ (along / (1.0 + low * values))
    length = float(np.linalg.norm(normal))
    first: Vector = np.eye(gap.size)[0]
    return normal / length if length > 1e-150 else first
