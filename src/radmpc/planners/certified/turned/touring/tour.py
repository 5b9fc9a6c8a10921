"""The pace of a vehicle from visit to visit on a given route: at which steps it makes them."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from radmpc.arrays import Indices, Matrix
from radmpc.planners.certified.turned.narrow.clear import Clear
from radmpc.planners.certified.turned.narrow.track import Closeness, Track, track
from radmpc.program.condensed import CondensedModel
from radmpc.program.hazards import Hazards
from radmpc.program.visits.columns import windows_of
from radmpc.records import dataclass, replace

__all__ = ["Tour", "tour"]

_FINENESS = 0.5
"""Places on the route, in multiples of the usual number [-]: a pace takes some 10 ms."""

_NEAR = 1.3
"""Multiple of the size of a box that counts as in it [-]: no path is just as places are."""


@dataclass(frozen=True, slots=True, eq=False)
class Tour:
    """A route laid out, with the visits on it.

    Attributes
    ----------
    laid_out : Track
        Its places; moves that skip a visit cost what they are beside its box.
    visits : (v, 2) int array
        The first and the last place in the box of each visit.
    due : tuple of Closeness
        What it costs to be out of time.
    """

    laid_out: Track
    visits: Indices
    due: tuple[Closeness, ...]


def tour(
    hazards: Hazards,
    model: CondensedModel,
    i: int,
    route: Matrix,
    kept: tuple[Clear, float],
) -> Tour | None:
    """Lay out a route with the visits on it.

    Parameters
    ----------
    hazards : Hazards
        The fleet, in the plane.
    model : CondensedModel
        The vehicle, visits at any step of their windows.
    i : int
        Its number.
    route : (p, 2) array
        Corners, no two in a row at the same place; the route passes all boxes in order [m].
    kept : tuple of Clear and float
        How far places are from obstacles, and standard deviations to keep from them [-].

    Returns
    -------
    Tour or None
        None where the route is too long for that.
    """
    laid_out = track(hazards, i, route, kept, _FINENESS)
    if laid_out is None:
        return None
    visits = _visits(model, laid_out.places)
    costs = laid_out.costs.copy()
    length = float(np.linalg.norm(laid_out.places[1] - laid_out.places[0]))
    count, levels = len(laid_out.places), len(costs)
    start = np.arange(count)
    for (first, last), visit in zip(visits.tolist(), model.vehicle.via, strict=True):
        skips = (start < first) & (laid_out.ends > last)
        beside = np.minimum(first - start, laid_out.ends - last) * length
        costs[skips] += (laid_out.price * beside)[skips]
        if visit.speed is not None:
            unit = (
                2.0
                * length
                / model.vehicle.system.B[list(model.vehicle.system.velocity or ())].max()
            )
            fast = np.flatnonzero(unit * np.arange(levels) > float(np.max(visit.speed)))
            costs[fast[:, None], :, np.arange(first, last + 1)] += laid_out.price
    return Tour(
        replace(laid_out, costs=costs), visits, tuple(_due(model, laid_out, visits, length))
    )


def _visits(model: CondensedModel, places: Matrix) -> Indices:
    """Return the first and the last place in each box, in order, (v, 2)."""
    found, before = [], 0
    for visit in model.vehicle.via:
        half = 0.5 * (visit.upper - visit.lower)
        beside = (np.abs(places[before:] - visit.center) / np.maximum(half, 1e-9)).max(axis=1)
        inside = np.flatnonzero(beside <= _NEAR)
        at = int(inside[0]) if inside.size else int(beside.argmin())
        last = at
        while last + 1 < beside.size and beside[last + 1] <= _NEAR:
            last += 1
        found.append((before + at, before + last))
        before += at
    return np.array(found, dtype=np.int64).reshape(-1, 2)


def _due(
    model: CondensedModel, laid_out: Track, visits: Indices, length: float
) -> Iterator[Closeness]:
    """Yield what it costs to be past a box before its window, or short of it after."""
    start, moves = np.arange(len(laid_out.places)), laid_out.num_displacements
    horizon, last_place = model.horizon, len(laid_out.places) - 1
    bounds = []
    for (begin, end), (first, last) in zip(visits.tolist(), windows_of(model), strict=True):
        bounds += [(first, np.maximum(start - end, 0)), (last, np.maximum(begin - start, 0))]
    early, late = model.vehicle.goal.window(horizon)
    bounds.append((late, last_place - start))
    for step, beside in bounds:
        if step < horizon and beside.any():
            cost = np.broadcast_to((laid_out.price * length * beside)[:, None], (start.size, moves))
            yield np.full(start.size, step), start, cost
    if model.time_cost > 0.0 and early < late and model.vehicle.cost_weight > 0.0:
        each = model.time_cost / horizon * _dt(model) / model.vehicle.cost_weight
        cost = np.broadcast_to(each * (start < last_place)[:, None], (start.size, moves))
        for step in range(early, late):
            yield np.full(start.size, step), start, cost


def _dt(model: CondensedModel) -> float:
    """Return the length of a step [s]."""
    rates = model.vehicle.system.rates
    return 1.0 if rates is None else float(rates[1])
