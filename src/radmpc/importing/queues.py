"""How long vehicles queue where several come at once to a passage for one at a time."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.spatial import cKDTree

from radmpc.arrays import Indices, Vector
from radmpc.importing.free_space import FreeSpace
from radmpc.importing.problem import ForeignVehicle
from radmpc.records import dataclass

__all__ = ["ABREAST", "queue_times"]

ABREAST = 1.6
"""Half the width that two hulls abreast need, noise included, over the sum of their radii [-]."""

_LEAST = 0.7
"""Wait that counts, over the longest gap that the queue keeps [-]: four of db-CBS that pass one
window wait for 0.75; twelve on a map of 8 x 8 cells wait for 0.65, and need no longer horizon."""

_TURN = 4
"""Points over which a path's direction is taken [-]."""


@dataclass(frozen=True, slots=True)
class _Arrival:
    """A vehicle that comes to a passage, when, and in which direction."""

    seconds: float
    vehicle: int
    heading: tuple[float, float]


def queue_times(
    spaces: Sequence[FreeSpace], vehicles: Sequence[ForeignVehicle], paths: Sequence[Indices]
) -> list[float]:
    """Return how long each vehicle waits behind others at passages for one at a time.

    The vehicle that comes first goes first, at full speed until there. The next one follows at a
    distance of one sum of radii, or goes two later where it comes from the other side. That one
    vehicle gives way is not counted: a horizon has time for it anyway.

    Parameters
    ----------
    spaces : sequence of FreeSpace
        What obstacles leave each, on one grid.
    vehicles : sequence of ForeignVehicle
        In the plane.
    paths : sequence of (k, 2) int array
        Theirs, see `FreeSpace.path`.

    Returns
    -------
    list of float
        The longest wait of each [s], 0 for most.
    """
    trees = [cKDTree(path) if len(path) else None for path in paths]
    waits = []
    for i, (space, path) in enumerate(zip(spaces, paths, strict=True)):
        longest = 0.0
        for point in _middles(space, path, vehicles[i].radius):
            arrivals = []
            for j, (other, tree) in enumerate(zip(paths, trees, strict=True)):
                if tree is None:
                    continue
                apart, nearest = tree.query(path[point])
                if apart * space.spacing < vehicles[i].radius + vehicles[j].radius:
                    arrivals.append(_arrival(j, int(nearest), other, (space, vehicles[j])))
            longest = max(longest, _wait(i, arrivals, vehicles))
        waits.append(longest)
    return waits


def _middles(space: FreeSpace, path: Indices, radius: float) -> list[int]:
    """Return the point in the middle of each passage for one at a time along a path."""
    if len(path) < 2:
        return []
    narrow = np.flatnonzero(_room_beside(space, path, 2.0 * radius) < 2.0 * ABREAST * radius)
    runs = np.split(narrow, np.flatnonzero(np.diff(narrow) > 1) + 1)
    return [int(run[run.size // 2]) for run in runs if run.size]


def _room_beside(space: FreeSpace, path: Indices, reach: float) -> Vector:
    """Return the largest distance from obstacles straight beside each point of a path, (k,) [m]."""
    points = np.arange(len(path))
    ahead = path[np.minimum(points + _TURN, len(path) - 1)] - path[np.maximum(points - _TURN, 0)]
    across = np.column_stack([-ahead[:, 1], ahead[:, 0]])
    across = across / np.maximum(np.linalg.norm(across, axis=1, keepdims=True), 1.0)
    last = np.array(space.distances.shape) - 1
    room: Vector = space.distances[path[:, 0], path[:, 1]]
    for side in (1.0, -1.0):
        is_open = np.ones(len(path), dtype=bool)
        for step in range(1, round(reach / space.spacing) + 1):
            at = np.clip(np.rint(path + side * step * across).astype(int), 0, last)
            found = space.distances[at[:, 0], at[:, 1]]
            # What lies behind a wall is another room.
            is_open &= found > 0.0
            room = np.where(is_open, np.maximum(room, found), room)
    return room


def _arrival(
    number: int, at: int, path: Indices, flown: tuple[FreeSpace, ForeignVehicle]
) -> _Arrival:
    """Return when a vehicle comes to a point of its path, and where it is going."""
    space, vehicle = flown
    ahead = path[min(at + _TURN, len(path) - 1)] - path[max(at - _TURN, 0)]
    return _Arrival(
        at * space.spacing / vehicle.speed_limit, number, (float(ahead[0]), float(ahead[1]))
    )


def _wait(who: int, arrivals: list[_Arrival], vehicles: Sequence[ForeignVehicle]) -> float:
    """Return how long a vehicle waits in a queue, beyond giving way to one [s]."""
    if len(arrivals) < 3:
        return 0.0
    queue = sorted(arrivals, key=lambda each: (each.seconds, each.vehicle))
    first, clock, longest = queue[0], queue[0].seconds, 0.0
    for each in queue[1:]:
        one, two = vehicles[first.vehicle], vehicles[each.vehicle]
        is_facing = sum(a * b for a, b in zip(first.heading, each.heading, strict=True)) < 0.0
        gap = (2.0 if is_facing else 1.0) * (one.radius + two.radius)
        gap /= min(one.speed_limit, two.speed_limit)
        clock = max(each.seconds, clock + gap)
        longest = max(longest, gap)
        if each.vehicle == who:
            waiting = clock - each.seconds - longest
            return waiting if waiting > _LEAST * longest else 0.0
        first = each
    return 0.0
