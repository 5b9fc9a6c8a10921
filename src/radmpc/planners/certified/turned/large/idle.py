"""Which vehicles can become no cheaper: they neither go out of the way nor risk anything."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from radmpc.arrays import Vector
from radmpc.planners.certified.turned.half_spaces import half_spaces
from radmpc.planners.certified.turned.linear.margins import far_of
from radmpc.planners.certified.turned.near import Near
from radmpc.planners.certified.turned.paths import Paths
from radmpc.planners.certified.turned.tuning import TUNING
from radmpc.program.hazards import Hazards

__all__ = ["not_idle"]


def not_idle(
    hazards: Hazards, paths: Paths, base: Sequence[float], price: float, gap: float
) -> frozenset[int]:
    """Return the vehicles that pay for hazards or for risk.

    Parameters
    ----------
    hazards : Hazards
        The fleet.
    paths : Paths
        Everyone's paths.
    base : sequence of float
        What every vehicle costs at least, in empty space.
    price : float
        Cost of a unit of probability.
    gap : float
        Relative difference of costs below which plans count as equal [-].

    Returns
    -------
    frozenset of int
        Their numbers. All others together could gain little of the gap, at this price.
    """
    pairs = zip(hazards.models, paths.controls, strict=True)
    costs = np.array([model.vehicle.cost_weight * np.abs(u).sum() for model, u in pairs])
    paid = costs - np.array(base) + price * _risks(hazards, paths)
    least = TUNING.idle * gap * float(costs.sum()) / hazards.count
    return frozenset(np.flatnonzero(paid > least).tolist())


def _risks(hazards: Hazards, paths: Paths) -> Vector:
    """Return what every vehicle's half-spaces risk, (N,) [-]: both ends, and not at their best."""
    near = Near(far_of(hazards.tail, TUNING.compared), 0.0, is_refined=False)
    spaces = half_spaces(hazards, paths, tuple(range(hazards.count)), near)
    each = hazards.tail.probability(spaces.clearances).sum(axis=1)
    risks = np.bincount(spaces.first, each, hazards.count)
    has_second = spaces.second >= 0
    risks += np.bincount(spaces.second[has_second], each[has_second], hazards.count)
    return np.asarray(risks)
