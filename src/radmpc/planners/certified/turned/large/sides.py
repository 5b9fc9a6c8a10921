"""Vehicles that pass something on another side in one plan than in another."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from radmpc.arrays import Matrix
from radmpc.planners.certified.turned.half_spaces import half_spaces
from radmpc.planners.certified.turned.linear.margins import far_of
from radmpc.planners.certified.turned.near import Near
from radmpc.planners.certified.turned.normals.spaces import HalfSpaces
from radmpc.planners.certified.turned.paths import Paths
from radmpc.planners.certified.turned.tuning import TUNING
from radmpc.program.hazards import Hazards

__all__ = ["on_other_sides"]


def on_other_sides(
    hazards: Hazards,
    one: Sequence[Matrix],
    other: Sequence[Matrix],
    same_side: float = TUNING.same_side,
) -> frozenset[int]:
    """Return the vehicles that pass something on another side in the second of two plans.

    Half-spaces turned to paths on the same sides lead to the same paths in the end.

    Parameters
    ----------
    hazards : Hazards
        The fleet.
    one, other : sequence of (T, m) array
        Controls of all vehicles in either plan.
    same_side : float
        Cosine between their half-spaces above which both pass on the same side [-].

    Returns
    -------
    frozenset of int
        Their numbers.
    """
    # Two who do the same in both pass each other, and everything else, as before.
    group = tuple(i for i in range(hazards.count) if not np.array_equal(one[i], other[i]))
    if not group:
        return frozenset()
    first, second = _near(hazards, one, group), _near(hazards, other, group)
    far = far_of(hazards.tail, TUNING.compared)
    return _apart(first, second, far, same_side) | _apart(second, first, far, same_side)


def _near(hazards: Hazards, controls: Sequence[Matrix], group: tuple[int, ...]) -> HalfSpaces:
    """Return half-spaces wherever something is near a group, or could be after a step more."""
    paths = Paths(hazards)
    for i, each in enumerate(controls):
        paths.fly(i, each)
    far = far_of(hazards.tail, TUNING.compared)
    near = Near(far, float(hazards.reaches.max()), is_refined=False)
    return half_spaces(hazards, paths, group, near)


def _apart(spaces: HalfSpaces, others: HalfSpaces, far: float, same_side: float) -> frozenset[int]:
    """Return those near something in one plan, and far from it or beyond it in the other."""
    close = np.flatnonzero(spaces.clearances.min(axis=1) < far)
    order = np.argsort(others.keys)
    place = np.searchsorted(others.keys, spaces.keys[close], sorter=order)
    found = order[np.minimum(place, order.size - 1)] if order.size else np.zeros(0, dtype=np.int64)
    is_near = np.zeros(close.size, dtype=bool)
    if order.size:
        along = np.einsum("wd,wd->w", spaces.normals[close], others.normals[found])
        is_near = (others.keys[found] == spaces.keys[close]) & (along > same_side)
    apart = close[~is_near]
    who = np.concatenate([spaces.first[apart], spaces.second[apart]])
    return frozenset(who[who >= 0].tolist())
