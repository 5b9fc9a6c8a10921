"""Pairs of vehicles that would have to change sides in a passage too narrow for two.

Where all places at which both can be side by side, at the same place along an axis, are nearer each
other than their hulls are wide, who is ahead along this axis stays ahead. Every plan keeps mean
hulls apart, along intervals all the time: what this rules out no plan does.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import combinations

import numpy as np

from radmpc.arrays import Vector
from radmpc.geometry import Polytope, hull
from radmpc.model.relations.concerns import met_by
from radmpc.model.scenario import Scenario
from radmpc.model.vehicle import Vehicle
from radmpc.planners.reaching.enclosed import at_all_steps
from radmpc.records import dataclass

__all__ = ["Blocked", "blocked_pairs", "blocked_text"]

_SLABS = 256
"""Parts into which the workspace is cut along an axis [-]."""

_SIDES = 8
"""Corners of the polygon that stands for a hull's disc [-]."""

_TIGHT = 1e-6
"""Share of both radii by which a passage has to be too narrow, which no rounding is [-]."""

_MOST = 64
"""Vehicles up to which pairs are looked at [-]."""

_Interval = tuple[float, float]
_Span = tuple[Vector, Vector]


@dataclass(frozen=True, slots=True)
class Blocked:
    """Two vehicles that cannot pass each other.

    Attributes
    ----------
    members : pair of int
        The vehicles.
    axis : int
        Along which they would have to.
    widest : float
        What is left for their centers side by side, where it is most [m].
    apart : float
        Distance that their hulls need [m].
    """

    members: tuple[int, int]
    axis: int
    widest: float
    apart: float


def blocked_pairs(scenario: Scenario) -> Iterator[Blocked]:
    """Yield pairs of vehicles that have to pass each other and cannot.

    Parameters
    ----------
    scenario : Scenario
        The fleet.

    Yields
    ------
    Blocked
        Each a proof that there is no plan; none in space, and at steps, where hulls may jump.
    """
    is_told = scenario.dimension == 2 and scenario.avoidance == "intervals"
    if not is_told or scenario.workspace is None or scenario.num_vehicles > _MOST:
        return
    largest = max(vehicle.radius for vehicle in scenario.vehicles)
    known: dict[tuple[int, int], _Span | None] = {}
    grown: dict[tuple[float, tuple[str, ...]], list[Polytope]] = {}
    for i, j in combinations(range(scenario.num_vehicles), 2):
        one, other = scenario.vehicles[i], scenario.vehicles[j]
        apart = one.radius + other.radius
        for axis in range(2):
            if not _have_to_pass(one, other, axis):
                continue
            for k in (i, j):
                if (k, axis) not in known:
                    vehicle = scenario.vehicles[k]
                    pieces = _grown(scenario, vehicle, grown)
                    known[k, axis] = _span(scenario, vehicle, pieces, axis, largest)
            first, second = known[i, axis], known[j, axis]
            if first is None or second is None:
                continue
            widest = _side_by_side(first, second)
            if widest < apart * (1.0 - _TIGHT):
                yield Blocked((i, j), axis, max(widest, 0.0), apart)
                break


def _have_to_pass(one: Vehicle, other: Vehicle, axis: int) -> bool:
    """Whether who is ahead at the start is behind at the end, wherever in their goals they are."""
    begins = one.start_position[axis] - other.start_position[axis]
    if begins > 0.0:
        return bool(one.goal.upper[axis] < other.goal.lower[axis])
    return begins < 0.0 and bool(one.goal.lower[axis] > other.goal.upper[axis])


def _side_by_side(first: _Span, second: _Span) -> float:
    """Return how far two centers can be from each other at most, side by side across an axis."""
    are_there = (first[0] <= first[1]) & (second[0] <= second[1])
    across = np.maximum(first[1] - second[0], second[1] - first[0])
    return float(across[are_there].max(initial=0.0))


def _grown(
    scenario: Scenario,
    vehicle: Vehicle,
    known: dict[tuple[float, tuple[str, ...]], list[Polytope]],
) -> list[Polytope]:
    """Return what stands still, grown by a polygon within the hull; the same for vehicles alike."""
    met = met_by(scenario.obstacles, vehicle.name)
    key = (vehicle.radius, tuple(obstacle.name for obstacle in met))
    if key not in known:
        angles = np.arange(_SIDES) * (2.0 * np.pi / _SIDES)
        disc = vehicle.radius * np.column_stack([np.cos(angles), np.sin(angles)])
        pieces = [piece for obstacle in met for piece in at_all_steps(obstacle)]
        known[key] = [hull((p.vertices[:, None] + disc).reshape(-1, 2)) for p in pieces]
    return known[key]


def _span(
    scenario: Scenario, vehicle: Vehicle, pieces: Sequence[Polytope], axis: int, largest: float
) -> _Span | None:
    """Return from where to where across an axis a vehicle may be, crossed where it never is.

    None where there is room for two beside its start, or it starts beside all that is free.
    """
    room = scenario.workspace
    assert room is not None
    sides = (float(room.lower[1 - axis]), float(room.upper[1 - axis]))
    edges = np.linspace(room.lower[axis], room.upper[axis], _SLABS + 1)
    place, across = (float(vehicle.start_position[k]) for k in (axis, 1 - axis))
    if not edges[0] <= place <= edges[-1]:
        return None
    begin = int(np.clip(np.searchsorted(edges, place) - 1, 0, _SLABS - 1))
    (beside,) = _free(pieces, axis, edges[begin : begin + 2], sides)
    here = [n for n, (low, high) in enumerate(beside) if low <= across <= high]
    if not here or beside[here[0]][1] - beside[here[0]][0] >= vehicle.radius + largest:
        return None
    return _connected(_free(pieces, axis, edges, sides), begin, here[0])


def _free(
    pieces: Sequence[Polytope], axis: int, edges: Vector, sides: _Interval
) -> list[list[_Interval]]:
    """Return what pieces leave of each slab."""
    count = len(edges) - 1
    taken: list[list[_Interval]] = [[] for _ in range(count)]
    for piece in pieces:
        low, high = _chords(piece, axis, edges)
        for k in np.flatnonzero(low < high).tolist():
            taken[k].append((float(low[k]), float(high[k])))
    return [_left(one, sides) for one in taken]


def _chords(piece: Polytope, axis: int, edges: Vector) -> tuple[Vector, Vector]:
    """Return what a piece takes across all of each slab; crossed where that is nothing."""
    along, across = piece.normals[:, axis], piece.normals[:, 1 - axis]
    left = piece.offsets - edges[:, None] * along
    safe = np.where(across == 0.0, 1.0, across)
    low = np.where(across < 0.0, left / safe, -np.inf).max(axis=1)
    high = np.where(across > 0.0, left / safe, np.inf).min(axis=1)
    is_beside = ((across == 0.0) & (left < 0.0)).any(axis=1)
    low, high = np.where(is_beside, np.inf, low), np.where(is_beside, -np.inf, high)
    # Convex: what is within at both edges of a slab is so all along.
    return np.maximum(low[:-1], low[1:]), np.minimum(high[:-1], high[1:])


def _left(taken: Sequence[_Interval], sides: _Interval) -> list[_Interval]:
    """Return what is left between two sides."""
    found, begin = [], sides[0]
    for low, high in sorted(taken):
        if low >= begin:
            found.append((begin, min(low, sides[1])))
        begin = max(begin, high)
        if begin > sides[1]:
            return found
    return [*found, (begin, sides[1])]


def _connected(free: Sequence[Sequence[_Interval]], slab: int, which: int) -> _Span:
    """Return the extent in each slab of all that is connected with one interval of one slab."""
    low, high = np.full(len(free), np.inf), np.full(len(free), -np.inf)
    waiting, seen = [(slab, which)], {(slab, which)}
    while waiting:
        k, n = waiting.pop()
        begin, end = free[k][n]
        low[k], high[k] = min(low[k], begin), max(high[k], end)
        for beside in (k - 1, k + 1):
            if 0 <= beside < len(free):
                for m, (first, last) in enumerate(free[beside]):
                    if (beside, m) not in seen and first <= end and last >= begin:
                        seen.add((beside, m))
                        waiting.append((beside, m))
    return low, high


def blocked_text(scenario: Scenario, blocked: Blocked) -> str:
    """Say which vehicles cannot pass each other.

    Parameters
    ----------
    scenario : Scenario
        Whose vehicles they are.
    blocked : Blocked
        The two.

    Returns
    -------
    str
        A sentence.
    """
    first, second = (repr(scenario.vehicles[i].name) for i in blocked.members)
    return (
        f"Vehicles {first} and {second} have to pass each other along {'xy'[blocked.axis]} and "
        f"cannot: wherever they can get to, their centers are {blocked.widest:.4g} m apart at most "
        f"side by side, and their hulls need {blocked.apart:.4g} m."
    )
