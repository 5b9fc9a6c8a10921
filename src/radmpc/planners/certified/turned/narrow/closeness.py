"""Where on its track a vehicle would be near another that is placed, and what that costs."""

from __future__ import annotations

import functools
from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from radmpc.arrays import Indices, Matrix, Tensor, Vector
from radmpc.planners.certified.turned.narrow.track import Closeness, Track
from radmpc.program.hazards import Hazards
from radmpc.solvers.compiled_code import is_compiled

if is_compiled():
    from radmpc.solvers import _compiled

__all__ = ["closeness", "passing_by"]

_PLANE = 2
"""Dimension that compiled code is for; in space, the axes that tell who passes by at all."""


def closeness(
    hazards: Hazards, each: Track, other: int, path: Matrix, clearance: float
) -> Closeness:
    """Return what it costs on a track to be near another vehicle.

    Parameters
    ----------
    hazards : Hazards
        The fleet.
    each : Track
        The track.
    other : int
        Who that is.
    path : (T+1, 2) array
        Where it is at each step [m].
    clearance : float
        Standard deviations to keep [-]; one is kept at any cost.
    """
    i, places, most = each.vehicle, each.places, each.num_displacements
    variance = hazards.variances[i].max() + hazards.variances[other].max()
    spread = float(np.sqrt(variance / hazards.dimension))
    touching = float(hazards.radii[i] + hazards.radii[other])
    terms = touching + clearance * spread, touching + spread, each.price
    if not is_compiled() or hazards.dimension != _PLANE:
        return _measured(places, path, most, terms, is_along=hazards.intervals)
    path = np.ascontiguousarray(path)
    found = _compiled.passing_costs(places, path, most, terms, hazards.intervals)
    step, place = (np.frombuffer(numbers, dtype=np.int64) for numbers in found[:2])
    return step, place, np.frombuffer(found[2]).reshape(-1, most)


def _measured(
    places: Matrix, path: Matrix, most: int, terms: tuple[float, float, float], *, is_along: bool
) -> Closeness:
    """Return the same without compiled code."""
    apart, touching, price = terms
    longest = most * _widest(places)
    moved = np.linalg.norm(np.diff(path, axis=0), axis=1)
    near, step = _near(places, path, apart + longest + moved)
    ends = np.minimum(near[:, None] + np.arange(most), len(places) - 1)
    begin = places[near] - path[step]
    # By axes: arrays of pairs, and sums over two numbers each, take three times as long.
    end = [
        column[ends] - after[:, None]
        for column, after in zip(places.T, path[step + 1].T, strict=True)
    ]
    distance = _length(_closest(begin, end) if is_along else end)
    lack = price * np.maximum(apart - distance, 0.0)
    lack[distance < touching] = np.inf
    # Four fifths of what may be near is not, whatever the move, and all of it is kept for long.
    costs_any = lack.any(axis=1)
    return step[costs_any], near[costs_any], lack[costs_any]


def passing_by(
    hazards: Hazards, each: Track, paths: Tensor, clearance: float
) -> npt.NDArray[np.bool_]:
    """Return which of other paths may come near a track at all, (n,).

    Told by cells as wide as what counts as near, so that most of the others need no closer look.

    Parameters
    ----------
    hazards : Hazards
        The fleet.
    each : Track
        The track.
    paths : (n, T+1, 2) array
        Where others are at each step [m].
    clearance : float
        Standard deviations to keep [-].
    """
    places = each.places
    spread = float(np.sqrt(2.0 * hazards.variances.max() / hazards.dimension))
    moved = float(np.abs(np.diff(paths, axis=1)).max(initial=0.0)) * np.sqrt(2.0)
    longest = each.num_displacements * _widest(places)
    reach = 2.0 * float(hazards.radii.max()) + clearance * spread + longest + moved
    # Two cells around all places, so that what is clipped is outside.
    origin = places.min(axis=0) - 2.0 * reach
    of_places = ((places - origin) / reach).astype(np.int64)
    # Above or below counts as near.
    is_near = np.zeros(of_places.max(axis=0)[:_PLANE] + 3, dtype=bool)
    for x in (-1, 0, 1):
        for y in (-1, 0, 1):
            is_near[of_places[:, 0] + x, of_places[:, 1] + y] = True
    cells = ((paths - origin) / reach).astype(np.int64)
    x, y = (np.clip(cells[..., axis], 0, is_near.shape[axis] - 1) for axis in (0, 1))
    return np.asarray(is_near[x, y].any(axis=1))


def _widest(places: Matrix) -> float:
    """Return what two places in a row are apart at most [m]: less where the route turns there."""
    return float(np.linalg.norm(np.diff(places, axis=0), axis=1).max(initial=0.0))


def _near(places: Matrix, path: Matrix, reaches: Vector) -> tuple[Indices, Indices]:
    """Return the places and steps, (c,) each, at which a path is within reach of a place."""
    aside = [column[:, None] - other[:-1] for column, other in zip(places.T, path.T, strict=True)]
    near, step = np.nonzero(_squared(aside) < np.square(reaches))
    return near, step


def _closest(begin: Matrix, end: Sequence[Matrix]) -> list[Matrix]:
    """Return the place nearest to the origin on the way of each move, by axes, (c, m) each."""
    start = [column[:, None] for column in begin.T]
    along = [last - first for first, last in zip(start, end, strict=True)]
    square = _squared(along)
    ways = [first * way for first, way in zip(start, along, strict=True)]
    ahead = -functools.reduce(np.add, ways)
    share = np.clip(ahead / np.where(square > 0.0, square, 1.0), 0.0, 1.0)
    return [first + share * way for first, way in zip(start, along, strict=True)]


def _squared(axes: Sequence[Matrix]) -> Matrix:
    """Return the square of a length from what it is along each axis [m²]."""
    return np.asarray(functools.reduce(np.add, [np.square(axis) for axis in axes]))


def _length(axes: Sequence[Matrix]) -> Matrix:
    """Return a length from what it is along each axis [m]."""
    return np.asarray(functools.reduce(np.hypot, axes))
