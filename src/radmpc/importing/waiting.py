"""How long vehicles wait for each other where a passage is too narrow for two abreast."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations

import numpy as np
from scipy import ndimage
from scipy.spatial import cKDTree

from radmpc.arrays import Indices
from radmpc.importing.free_space import FreeSpace
from radmpc.importing.problem import ForeignVehicle
from radmpc.importing.queues import ABREAST, queue_times

__all__ = ["waiting_times"]

_MOST_VEHICLES = 30
"""Vehicles up to which all pairs are compared; more are taken not to wait."""

_HEADWAY = 2.0
"""Sums of radii between the middles of two, one behind the other."""

_LEAST_LENGTH = 2.0
"""Sums of radii: where less is narrow, one waits beside it."""


def waiting_times(
    spaces: Sequence[FreeSpace], vehicles: Sequence[ForeignVehicle], clearances: Sequence[float]
) -> list[float]:
    """Return how long each vehicle waits at narrow passages.

    Until one that comes toward it has left a long one, or in a queue, see `queue_times`.

    Parameters
    ----------
    spaces, vehicles
        As in `queue_times`.
    clearances : sequence of float
        What each keeps beside its hull on its path [m].

    Returns
    -------
    list of float
        The longest wait of each [s], 0 for most; 0 for all of many vehicles.
    """
    waits: list[list[tuple[float, float]]] = [[] for _ in vehicles]
    if len(vehicles) > _MOST_VEHICLES:
        return [0.0] * len(vehicles)
    paths = [
        space.path(vehicle, clearance)
        for space, vehicle, clearance in zip(spaces, vehicles, clearances, strict=True)
    ]
    for i, j in combinations(range(len(vehicles)), 2):
        one, two = vehicles[i], vehicles[j]
        both = (spaces[i], spaces[j])
        length = _shared_length(both, paths[i], paths[j], one.radius + two.radius)
        if length > 0.0:
            gap = _HEADWAY * (one.radius + two.radius)
            waits[i].append((length / two.speed_limit, gap / two.speed_limit))
            waits[j].append((length / one.speed_limit, gap / one.speed_limit))
    queues = queue_times(spaces, vehicles, paths)
    return [max(_longest(met), queue) for met, queue in zip(waits, queues, strict=True)]


def _longest(met: Sequence[tuple[float, float]]) -> float:
    """Return how long those that come toward a vehicle take, one behind the other [s]."""
    if not met:
        return 0.0
    return max(time for time, _ in met) + sum(sorted(gap for _, gap in met)[1:])


def _shared_length(
    spaces: tuple[FreeSpace, FreeSpace], one: Indices, two: Indices, radii: float
) -> float:
    """Return how far two go against each other where they cannot pass [m]."""
    if not len(one) or not len(two):
        return 0.0
    spacing = spaces[0].spacing
    found = cKDTree(two * spacing).query(one * spacing)
    distances, nearest = np.asarray(found[0]), np.asarray(found[1])
    cells = max(1, round(radii / spacing))
    # Where one of them has room, it gives way.
    room = np.maximum(spaces[0].distances, spaces[1].distances)
    widths = ndimage.maximum_filter(room, size=2 * cells + 1)
    is_narrow = widths[one[:, 0], one[:, 1]] < ABREAST * radii
    shared = np.flatnonzero((distances < radii) & is_narrow)
    if shared.size < 2 or nearest[shared[-1]] >= nearest[shared[0]]:
        return 0.0
    # What lies between two narrow places is wide enough to wait in.
    runs = np.split(shared, np.flatnonzero(np.diff(shared) > cells) + 1)
    length = max(float(run[-1] - run[0]) for run in runs) * spacing
    return length if length >= _LEAST_LENGTH * radii else 0.0
