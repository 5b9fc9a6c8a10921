"""What it costs a vehicle on its way to be near those whose paths are given already."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from scipy.spatial import cKDTree

from radmpc.arrays import Tensor, Vector
from radmpc.planners.certified.turned.narrow.track import Closeness, Track
from radmpc.planners.certified.turned.paths import Paths
from radmpc.program.hazards import Hazards

__all__ = ["crowding"]

_INSTANTS = 12
"""Parts of a step at whose ends distances are compared [-]: at 8 m/s and 1 s those are 0.7 m."""

_TOUCHING = 5.0
"""What a meter counts where hulls would touch, in meters of room [-]."""


def crowding(
    each: Track,
    hazards: Hazards,
    paths: Paths,
    counts: npt.NDArray[np.bool_],
    clearance: float,
) -> Closeness:
    """Return what moves along a way cost near others.

    Parameters
    ----------
    each : Track
        The way.
    hazards : Hazards
        The fleet, in the plane.
    paths : Paths
        Everyone's latest paths.
    counts : (N, T) bool array
        Who counts, in which windows.
    clearance : float
        Standard deviations to keep [-].
    """
    first = 0 if hazards.intervals else _INSTANTS
    shares = np.arange(first, _INSTANTS + 1) / _INSTANTS
    lacks = _lacks(each, hazards, paths, (counts, shares, clearance))
    count, moves = len(each.places), np.arange(each.num_moves)
    passed = np.rint(shares * moves[:, None]).astype(np.int64)
    is_crowded = np.asarray(lacks.any(axis=2))
    crowded = np.flatnonzero(is_crowded.any(axis=1))
    found = []
    for k in crowded.tolist():
        worst = np.zeros((count, moves.size))
        for number in np.flatnonzero(is_crowded[k]).tolist():
            # Only who begins at, or a move before, places near others passes these.
            lack, late = lacks[k, number], passed[:, number]
            near = np.flatnonzero(lack)
            begins = np.arange(max(int(near[0] - late[-1]), 0), int(near[-1]) + 1)
            if lack[-1] > 0.0:
                begins = np.arange(begins[0], count)
            at = np.minimum(begins[:, None] + late, count - 1)
            part = worst[begins[0] : begins[-1] + 1]
            np.maximum(part, lack[at], out=part)
        found.append(worst)
    if not found:
        none = np.zeros(0, dtype=np.int64)
        return none, none, np.zeros((0, moves.size))
    steps = np.repeat(crowded, count)
    return steps, np.tile(np.arange(count), crowded.size), np.concatenate(found)


def _lacks(
    each: Track,
    hazards: Hazards,
    paths: Paths,
    asked: tuple[npt.NDArray[np.bool_], Vector, float],
) -> Tensor:
    """Return what places cost at instants of each step, (T, s, n)."""
    counts, shares, clearance = asked
    i, count = each.vehicle, len(each.places)
    lacks = np.zeros((hazards.horizon, shares.size, count))
    others, steps = np.nonzero(counts)
    if not others.size:
        return lacks
    spread = np.sqrt((hazards.variances[i, steps] + hazards.variances[others, steps]) / 2.0)
    radii = hazards.radii[i] + hazards.radii[others]
    begin, end = paths.means[others, steps], paths.means[others, steps + 1]
    there = begin[:, None] + shares[:, None] * (end - begin)[:, None]
    apart = radii + clearance * spread
    tree, points = cKDTree(each.places), cKDTree(there.reshape(-1, 2))
    near = points.sparse_distance_matrix(tree, float(apart.max()), output_type="ndarray")
    which, instant = np.divmod(near["i"], shares.size)
    cost = each.price * np.maximum(apart[which] - near["v"], 0.0)
    cost[near["v"] < radii[which]] *= _TOUCHING
    np.maximum.at(lacks, (steps[which], instant, near["j"]), cost)
    return lacks
