"""QGroundControl's ``.plan`` files, one per vehicle."""

from __future__ import annotations

import json

from radmpc.io.export.job import Job
from radmpc.io.export.mission import WAYPOINT, Item, mission_items, visits_of
from radmpc.io.export.statements import origin_sentence, risk_sentence, timing_sentence, title
from radmpc.io.export.tracks import TimedPath

__all__ = ["write_qgc"]

_RELATIVE = 1
"""QGroundControl's altitude mode: above home."""

_GENERIC = 0
"""MAV_TYPE and MAV_AUTOPILOT: no special vehicle."""

_DATUM = "altitudes are in meters above home, which stands at the height of the plan's origin"


def write_qgc(job: Job, track: TimedPath) -> bytes:
    """Return a vehicle's part of a plan as a QGroundControl plan.

    Parameters
    ----------
    job : Job
        The plan and its place on earth.
    track : TimedPath
        The vehicle's part.

    Returns
    -------
    bytes
        JSON. Its key ``radmpc`` holds what waypoints cannot say; QGroundControl ignores it.
    """
    items = mission_items(track, job.place)
    home = job.place.geodetic(track.positions[:1])[0].tolist()
    legs = [item.parameters[1] for item in items if item.command != WAYPOINT]
    fastest = max(legs, default=0.0)
    told: dict[str, object] = {
        "title": title(job.plan, track.name),
        "risk": risk_sentence(job.plan, job.is_certified),
        "timing": timing_sentence(job.plan),
        "altitude": _DATUM,
        "origin": origin_sentence(job.place),
        "times": track.times.tolist(),
    }
    if job.note is not None:
        told["steps"] = job.note
    if track.visits:
        told["visits"] = visits_of(track)
    content = {
        "fileType": "Plan",
        "version": 1,
        "groundStation": "QGroundControl",
        "geoFence": {"circles": [], "polygons": [], "version": 2},
        "rallyPoints": {"points": [], "version": 2},
        "mission": {
            "version": 2,
            "firmwareType": _GENERIC,
            "vehicleType": _GENERIC,
            "cruiseSpeed": fastest,
            "hoverSpeed": fastest,
            "globalPlanAltitudeMode": _RELATIVE,
            "plannedHomePosition": [*home[:2], job.place.origin.height],
            "items": [_item(number, item) for number, item in enumerate(items, start=1)],
        },
        "radmpc": told,
    }
    # As Qt writes it: keys in order, four blanks.
    return (json.dumps(content, indent=4, sort_keys=True, allow_nan=False) + "\n").encode()


def _item(number: int, item: Item) -> dict[str, object]:
    """Return a mission item as QGroundControl spells it."""
    parameters: list[float | None] = list(item.parameters)
    content: dict[str, object] = {
        "type": "SimpleItem",
        "command": item.command,
        "frame": item.frame,
        "autoContinue": True,
        "doJumpId": number,
    }
    if item.command == WAYPOINT:
        # No yaw is asked for: null is MAVLink's NaN.
        parameters[3] = None
        content |= {
            "Altitude": item.altitude,
            "AltitudeMode": _RELATIVE,
            "AMSLAltAboveTerrain": None,
        }
    return content | {"params": [*parameters, item.latitude, item.longitude, item.altitude]}
