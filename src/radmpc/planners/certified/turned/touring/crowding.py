"""What it costs a vehicle on its way to be near those whose paths are given already."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from scipy.spatial import cKDTree

from radmpc.arrays import Matrix, Vector
from radmpc.planners.certified.turned.narrow.track import Track
from radmpc.planners.certified.turned.paths import Paths
from radmpc.program.hazards import Hazards

__all__ = ["crowding"]

_INSTANTS = 12
"""Parts of a step at whose ends distances are compared [-]: at 8 m/s and 1 s those are 0.7 m."""

_CELLS = 256
"""Cells along an axis by which others are told that are far from all places, at most [-]."""

_TOUCHING = 5.0
"""What a meter counts where hulls would touch, in meters of room [-]."""


def crowding(
    each: Track,
    hazards: Hazards,
    paths: Paths,
    counts: npt.NDArray[np.bool_],
    clearance: float,
) -> npt.NDArray[np.float32]:
    """Return what moves along a route cost near others.

    Parameters
    ----------
    each : Track
        The route.
    hazards : Hazards
        The fleet, in the plane.
    paths : Paths
        Everyone's latest paths.
    counts : (N, T) bool array
        Who counts, in which windows.
    clearance : float
        Standard deviations to keep [-].

    Returns
    -------
    (T, m, n) array
        By step, length of the move and place where it begins.
    """
    first = 0 if hazards.intervals else _INSTANTS
    shares = np.arange(first, _INSTANTS + 1) / _INSTANTS
    lacks = _lacks(each, hazards, paths, (counts, shares, clearance))
    count, moves = len(each.places), np.arange(each.num_displacements)
    passed = np.rint(shares * moves[:, None]).astype(np.int64)
    found = np.zeros((hazards.horizon, moves.size, count), dtype=np.float32)
    crowded = np.flatnonzero(lacks.any(axis=(1, 2)))
    # Moves past the end of the route stay there.
    after = np.repeat(lacks[crowded, :, -1:], moves.size, axis=2)
    ahead = np.concatenate([lacks[crowded], after], axis=2).transpose(1, 0, 2)
    worst = np.zeros((moves.size, crowded.size, count), dtype=np.float32)
    for move, late in zip(worst, passed.tolist(), strict=True):
        for instant, at in zip(ahead, late, strict=True):
            np.maximum(move, instant[:, at : at + count], out=move)
    found[crowded] = worst.transpose(1, 0, 2)
    return found


def _lacks(
    each: Track,
    hazards: Hazards,
    paths: Paths,
    asked: tuple[npt.NDArray[np.bool_], Vector, float],
) -> npt.NDArray[np.float32]:
    """Return what places cost at instants of each step, (T, s, n)."""
    counts, shares, clearance = asked
    i, count = each.vehicle, len(each.places)
    lacks = np.zeros((hazards.horizon, shares.size, count), dtype=np.float32)
    others, steps = np.nonzero(counts)
    if not others.size:
        return lacks
    spread = np.sqrt((hazards.variances[i, steps] + hazards.variances[others, steps]) / 2.0)
    radii = hazards.radii[i] + hazards.radii[others]
    begin, end = paths.means[others, steps], paths.means[others, steps + 1]
    there = (begin[:, None] + shares[:, None] * (end - begin)[:, None]).reshape(-1, 2)
    apart = radii + clearance * spread
    most = float(apart.max())
    close = np.flatnonzero(_beside(each.places, there, most))
    tree, points = cKDTree(each.places), cKDTree(there[close])
    near = points.sparse_distance_matrix(tree, most, output_type="ndarray")
    which, instant = np.divmod(close[near["i"]], shares.size)
    cost = (each.price * np.maximum(apart[which] - near["v"], 0.0)).astype(np.float32)
    cost[near["v"] < radii[which]] *= _TOUCHING
    np.maximum.at(lacks, (steps[which], instant, near["j"]), cost)
    return lacks


def _beside(places: Matrix, points: Matrix, distance: float) -> npt.NDArray[np.bool_]:
    """Return which points may be so near to any place: those in its cell and in those beside."""
    extent = np.ptp(places, axis=0)
    size = max(distance, float(extent.max()) / _CELLS)
    origin, last = places.min(axis=0) - 2.0 * size, (extent // size).astype(np.int64) + 4
    # All that is farther off is in cells of the border, where no place is beside.
    cells = np.zeros(last + 1, dtype=bool)
    row, column = ((places - origin) / size).astype(np.int64).T
    for down in (-1, 0, 1):
        for right in (-1, 0, 1):
            cells[row + down, column + right] = True
    at = np.clip((points - origin) / size, 0.0, last).astype(np.int64)
    return np.asarray(cells[at[:, 0], at[:, 1]])
