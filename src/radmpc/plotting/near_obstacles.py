"""How close vehicles come to obstacles at least: what need not be measured. No matplotlib."""

from __future__ import annotations

from bisect import insort
from collections.abc import Callable, Sequence
from typing import TypeVar

import numpy as np

from radmpc.arrays import Indices, Matrix, Tensor, Vector
from radmpc.model.obstacle import Obstacle

__all__ = ["closest_of", "least_shares"]

_Measured = TypeVar("_Measured")

_ROUNDING = 1e-6
"""By how much measured distances may come out smaller than they are, as a share and [m]."""


def least_shares(
    obstacle: Obstacle, paths: Tensor, noise: Tensor, radii: Vector, stride: int
) -> Vector:
    """Return bounds from below on how close each vehicle's hull comes to an obstacle, (v,).

    Parameters
    ----------
    obstacle : Obstacle
        Of a scenario.
    paths : (v, p, d) array
        Mean paths, from step 0 on [m].
    noise : (v, p, d, d) array
        Covariances of the vehicles' places [m²].
    radii : (v,) array
        Of the vehicles [m].
    stride : int
        Points from one step to the next.

    Returns
    -------
    (v,) array
        In standard deviations; minus infinity where the box around it is met.
    """
    windows = np.arange(paths.shape[1]) // stride
    lower, upper = _boxes(obstacle, windows)
    beside = np.maximum(np.maximum(lower - paths, paths - upper), 0.0)
    distances = np.linalg.norm(beside, axis=2).min(axis=1) - radii
    variances = np.trace(noise, axis1=2, axis2=3).max(axis=1)
    if obstacle.spread is not None:
        before = np.minimum(windows, len(obstacle.steps) - 2)
        shares = np.arange(len(windows)) / stride - before
        strays = obstacle.spread.between(before, shares)
        variances = variances + np.trace(strays, axis1=1, axis2=2).max()
    least = distances * (1.0 - _ROUNDING) - _ROUNDING
    # No direction has more variance than all axes together.
    shares_of = least / (np.maximum(np.sqrt(variances), 1e-9) * (1.0 + _ROUNDING))
    return np.where(least > 0.0, shares_of, -np.inf)


def _boxes(obstacle: Obstacle, windows: Indices) -> tuple[Matrix, Matrix]:
    """Return boxes around an obstacle at each point, (p, d): of one that moves, over its step."""
    corners = [np.vstack([piece.vertices for piece in pieces]) for pieces in obstacle.steps]
    lower = np.array([each.min(axis=0) for each in corners])
    upper = np.array([each.max(axis=0) for each in corners])
    if not obstacle.is_moving:
        return lower, upper
    before, after = (np.minimum(windows + k, len(corners) - 1) for k in (0, 1))
    return np.minimum(lower[before], lower[after]), np.maximum(upper[before], upper[after])


def closest_of(
    bounds: Sequence[float],
    measure: Callable[[int], _Measured],
    least: Callable[[_Measured], float],
    most: int,
) -> list[_Measured]:
    """Return what may be among the closest, in order; the others are not measured.

    Parameters
    ----------
    bounds : sequence of float
        How close each comes at least.
    measure : callable
        Measures one by its number.
    least : callable
        Tells how close what was measured comes; never below its bound.
    most : int
        How many are wanted.
    """
    measured: dict[int, _Measured] = {}
    closest: list[float] = []
    for number in np.argsort(bounds, kind="stable").tolist():
        if len(closest) >= most and bounds[number] > closest[most - 1]:
            break
        measured[number] = measure(number)
        insort(closest, least(measured[number]))
    return [measured[number] for number in sorted(measured)]
