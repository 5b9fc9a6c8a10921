"""What vehicles may come near at all: a first look, by boxes around whole paths."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from radmpc.arrays import Indices, Matrix, Tensor
from radmpc.planners.certified.turned.near import Near
from radmpc.planners.certified.turned.paths import Paths
from radmpc.program.hazards import Hazards

__all__ = ["near_pieces", "near_vehicles", "reached_by"]

_MANY_PAIRS = 200_000
"""Pairs from which on those far from each other are left out by a search tree [-]."""

_ROUNDING = 1e-9
"""Share by which this look is more generous than the one window by window that follows [-]."""


def near_vehicles(
    hazards: Hazards, paths: Paths, members: Indices, near: Near
) -> tuple[Indices, Indices]:
    """Return pairs of members, and of a member and another, once each, that may come near.

    Parameters
    ----------
    hazards : Hazards
        The fleet.
    paths : Paths
        Everyone's paths.
    members : (m,) int array
        Vehicles, ascending.
    near : Near
        What counts as near.

    Returns
    -------
    one, two : (p,) int array
        The member, and whom it may come near.
    """
    is_member = np.zeros(hazards.count, dtype=bool)
    is_member[members] = True
    if members.size * hazards.count > _MANY_PAIRS:
        one, two = paths.near_pairs(near.clearance, near.reach)
        is_swapped = ~is_member[one]
        one, two = np.where(is_swapped, two, one), np.where(is_swapped, one, two)
        kept = is_member[one]
        return one[kept], two[kept]
    # Over the first axis of a copy: numpy takes five times as long over one in the middle.
    means = np.ascontiguousarray(paths.means.transpose(1, 0, 2))
    low, high = means.min(axis=0), means.max(axis=0)
    most = hazards.variances.max(axis=1)
    spread = np.sqrt(most[members, None] + most)
    limit = hazards.radii[members, None] + hazards.radii + near.clearance * spread + near.reach
    one, two = np.nonzero(_closer((low[members], high[members]), (low, high), limit))
    one = members[one]
    kept = (two > one) | ~is_member[two]
    return one[kept], two[kept]


def near_pieces(
    hazards: Hazards, path: Tensor, members: Indices, near: Near
) -> tuple[Indices, Indices]:
    """Return the pieces of obstacles that members may come near.

    Parameters
    ----------
    hazards : Hazards
        The fleet.
    path : (m, T+1, d) array
        Paths of the members [m].
    members : (m,) int array
        Vehicles.
    near : Near
        What counts as near.

    Returns
    -------
    places, pieces : (p,) int array
        The place among the members, and the number of the piece.
    """
    shapes = hazards.shapes
    most = hazards.variances[members].max(axis=1)[:, None] + shapes.variances.max(axis=1)
    limit = hazards.radii[members, None] + near.clearance * np.sqrt(most) + near.reach
    boxes = shapes.lower.min(axis=1), shapes.upper.max(axis=1)
    is_near = _closer((path.min(axis=1), path.max(axis=1)), boxes, limit)
    if hazards.concerned is not None:
        is_near &= hazards.concerned[members]
    places, pieces = np.nonzero(is_near)
    return places, pieces


def reached_by(
    hazards: Hazards, paths: Paths, moved: tuple[int, Matrix], clearance: float
) -> npt.NDArray[np.bool_]:
    """Return whose half-spaces one vehicle's move may have changed, (N,) bool array.

    Parameters
    ----------
    hazards : Hazards
        The fleet.
    paths : Paths
        Everyone's latest paths.
    moved : tuple of int and (T+1, d) array
        Vehicles that moved, and where they were before [m].
    clearance : float
        Standard deviations that all keep [-].
    """
    i, before = moved
    means = np.ascontiguousarray(paths.means.transpose(1, 0, 2))
    both = np.concatenate([before, paths.means[i]])
    most = hazards.variances.max(axis=1)
    limit = hazards.radii[i] + hazards.radii + clearance * np.sqrt(most[i] + most) + hazards.reaches
    box = both.min(axis=0)[None], both.max(axis=0)[None]
    is_reached = _closer(box, (means.min(axis=0), means.max(axis=0)), limit[None])[0]
    for one, two, _ in hazards.ranges:
        if i in (one, two):
            is_reached[[one, two]] = True
    return np.asarray(is_reached)


def _closer(
    ones: tuple[Matrix, Matrix], others: tuple[Matrix, Matrix], limit: Matrix
) -> np.ndarray:
    """Return which boxes, (n, d) corners each, are closer to which others than a limit, (n, k)."""
    gaps = np.maximum(others[0] - ones[1][:, None], ones[0][:, None] - others[1])
    squares = np.square(np.maximum(gaps, 0.0)).sum(axis=2)
    return np.asarray(squares < np.square((1.0 + _ROUNDING) * limit))
