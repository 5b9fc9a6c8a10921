r"""The best half-space between a Gaussian and a grown polytope, in closed form.

The clearance of a half-space is largest where it touches the grown set at the point nearest to the
mean in the metric :math:`\Sigma^{-1}`. That point lies above a corner, an edge or a face of the
polytope. Above a face the normal is the face's. Above a corner v it is the normal of the ball
around v: with :math:`g = \bar x - v`, the point :math:`y = (I + \lambda\Sigma)^{-1} g` at which
:math:`\lVert y \rVert = r`. Above an edge it is the same in the plane across the edge.
"""

from __future__ import annotations

from functools import reduce

import numpy as np

from radmpc.arrays import Matrix, Tensor, Vector
from radmpc.referee.bound.halfspace import unit

__all__ = ["tangent_directions"]

_LEVEL = 1e-24
"""Slope, as a share of the steepest, up to which a Newton step changes nothing, or overflows."""

_NEWTON_STEPS = 12
"""Most Newton steps for one tangent; the square of the error makes a few enough."""

_CONVERGED = 1e-12
"""Share of the multiplier below which a Newton step, which squares the error, is the last."""


def tangent_directions(
    means: Matrix, covariances: Tensor, radii: Vector, corners: Tensor, edges: Tensor
) -> Tensor:
    """Return one normal per corner and edge; the best of them and the faces' is the best of all.

    Parameters
    ----------
    means : (S, d) array
        Means [m].
    covariances : (S, d, d) array
        Covariances, which may be singular [m²].
    radii : (S,) array
        Radii [m].
    corners : (S, V, d) array
        Corners of the polytopes [m].
    edges : (S, R, 2, d) array
        Ends of the edges in space; R = 0 in the plane [m].

    Returns
    -------
    (S, V + R, d) array
        Unit normals away from the set [-].
    """
    above_corners = _ball_normals(means[:, None] - corners, covariances[:, None], radii)
    if not edges.shape[1]:
        return above_corners
    along = unit(edges[:, :, 1] - edges[:, :, 0])
    frame = _across(along)
    gaps = np.einsum("srtd,srd->srt", frame, means[:, None] - edges[:, :, 0])
    flat = np.einsum("srtd,sde,srue->srtu", frame, covariances, frame, optimize=True)
    above_edges = np.einsum("srt,srtd->srd", _ball_normals(gaps, flat, radii), frame)
    return np.concatenate([above_corners, unit(above_edges)], axis=1)


def _ball_normals(gaps: Tensor, covariances: Tensor, radii: Vector) -> Tensor:
    """Return the normal at the point of a ball nearest to a mean, (S, V, d).

    Parameters
    ----------
    gaps : (S, V, d) array
        From the ball's center to the mean.
    covariances : (S, 1 or V, d, d) array
        Metric.
    radii : (S,) array
        Of the balls.
    """
    values, vectors = np.linalg.eigh(covariances)
    values = values.clip(min=0.0)
    # Axes first: numpy then works on long rows.
    g = np.einsum("svde,svd->esv", vectors, gaps)
    values = np.moveaxis(values, -1, 0).copy()
    r = radii[:, None]
    least = _LEVEL * values.max(axis=0)
    multiplier = np.zeros(g.shape[1:])
    for _ in range(_NEWTON_STEPS):
        shrink = 1.0 + multiplier * values
        y2 = np.square(g / shrink)
        length2 = reduce(np.add, y2)
        length = np.sqrt(length2)
        slope = reduce(np.add, y2 * values / shrink)
        # Newton on 1/|y| - 1/r: concave in the multiplier, so it never jumps over the root.
        # Where the gap has next to nothing along the noise, no multiplier turns the normal.
        moves = (length > r) & (slope > length2 * least)
        step = np.where(moves, length2 * (length / r - 1.0) / np.where(moves, slope, 1.0), 0.0)
        multiplier += step
        if (step <= _CONVERGED * multiplier).all():
            break
    y = g / (1.0 + multiplier * values)
    return unit(np.einsum("svde,esv->svd", vectors, y))


def _across(along: Tensor) -> Tensor:
    """Return two unit vectors at right angles to each edge, (S, R, 2, 3)."""
    helper = np.eye(3)[np.abs(along).argmin(axis=2)]
    first = unit(np.cross(along, helper))
    return np.stack([first, np.cross(along, first)], axis=2)
