"""A track as mission items: waypoints, the speed of each leg, and waits."""

from __future__ import annotations

import numpy as np

from radmpc.arrays import Matrix, Vector
from radmpc.io.export.origin import Placement
from radmpc.io.export.tracks import TimedPath
from radmpc.records import dataclass

__all__ = [
    "CHANGE_SPEED",
    "FRAME_MISSION",
    "FRAME_RELATIVE",
    "WAYPOINT",
    "Item",
    "Stop",
    "mission_items",
    "stops",
    "visits_of",
]

WAYPOINT = 16
"""MAV_CMD_NAV_WAYPOINT."""

CHANGE_SPEED = 178
"""MAV_CMD_DO_CHANGE_SPEED."""

FRAME_MISSION = 2
"""MAV_FRAME_MISSION: an item without a position."""

FRAME_RELATIVE = 3
"""MAV_FRAME_GLOBAL_RELATIVE_ALT: altitude above home."""

_SHORTEST_LEG = 0.01
"""Waypoints closer than this are one [m]: MAVLink rounds positions to 1e-7 degrees, 1.1 cm."""

_AT_REST = 0.001
"""Displacement since it stopped up to which a vehicle waits [m]."""

_GROUND_SPEED, _KEEP_THROTTLE = 1.0, -1.0


@dataclass(frozen=True, slots=True)
class Stop:
    """A step that becomes a waypoint.

    Attributes
    ----------
    step : int
        0..T.
    speed : float or None
        On the leg that ends here [m/s]; None at the first.
    wait : float
        Until the next leg starts [s].
    """

    step: int
    speed: float | None
    wait: float


@dataclass(frozen=True, slots=True)
class Item:
    """A MAVLink mission item.

    Attributes
    ----------
    command, frame : int
        As MAVLink numbers them.
    parameters : tuple of float
        The first four.
    latitude, longitude : float
        [°]; 0 where the command has no place.
    altitude : float
        Above home [m].
    """

    command: int
    frame: int
    parameters: tuple[float, float, float, float]
    latitude: float = 0.0
    longitude: float = 0.0
    altitude: float = 0.0


def stops(times: Vector, positions: Matrix) -> tuple[Stop, ...]:
    """Return the steps that become waypoints; steps less than a centimeter on are left out.

    Parameters
    ----------
    times : (T+1,) array
        Of the steps [s].
    positions : (T+1, d) array
        Mean positions [m].

    Returns
    -------
    tuple of Stop
        Waits and legs together take as long as the plan. Speeds are those of straight legs.
    """
    chosen: list[Stop] = []
    step, speed, left = 0, None, 0
    for k in range(1, len(times)):
        distance = float(np.linalg.norm(positions[k] - positions[step]))
        # Only a stay that has lasted since the arrival is a wait; a crawl is a slow leg.
        if distance < _AT_REST and left == k - 1:
            left = k
        if distance >= _SHORTEST_LEG:
            chosen.append(Stop(step, speed, float(times[left] - times[step])))
            speed = float(f"{distance / (times[k] - times[left]):.6g}")
            step = left = k
    chosen.append(Stop(step, speed, float(times[-1] - times[step])))
    return tuple(chosen)


def mission_items(track: TimedPath, placement: Placement) -> tuple[Item, ...]:
    """Return a track as waypoints, the speed of each leg set before it.

    Parameters
    ----------
    track : TimedPath
        Whose means become waypoints, the start included.
    placement : Placement
        Where its local frame lies.

    Returns
    -------
    tuple of Item
        Waypoints with altitudes above home, which stands at the origin's height.
    """
    placement.geodetic(track.positions)  # refuses what lies too far away to measure its ways
    chosen = stops(track.times, track.positions)
    points = track.positions[[stop.step for stop in chosen]]
    items: list[Item] = []
    places = placement.geodetic(points).tolist()
    for stop, place, level in zip(chosen, places, placement.levels(points), strict=True):
        if stop.speed is not None:
            speed = (_GROUND_SPEED, stop.speed, _KEEP_THROTTLE, 0.0)
            items.append(Item(CHANGE_SPEED, FRAME_MISSION, speed))
        wait = (round(stop.wait, 6), 0.0, 0.0, 0.0)
        items.append(Item(WAYPOINT, FRAME_RELATIVE, wait, place[0], place[1], level))
    return tuple(items)


def visits_of(track: TimedPath) -> list[dict[str, float]]:
    """Return which waypoints are visits: their number in a mission, the visit's, step and time.

    Parameters
    ----------
    track : TimedPath
        Whose means become waypoints.

    Returns
    -------
    list of dict
        ``item``, counted from 1 through speeds and waypoints as `mission_items` are, ``visit``
        from 0, ``step`` among those written, and ``time`` [s].
    """
    # Item 1 is the start; each further stop has its speed before it.
    steps = [stop.step for stop in stops(track.times, track.positions)]
    found = []
    for number, step in enumerate(track.visits):
        place = max(k for k, stop in enumerate(steps) if stop <= step)
        when = {"step": step, "time": float(track.times[step])}
        found.append({"item": 1 + 2 * place, "visit": number, **when})
    return found
