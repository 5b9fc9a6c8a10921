"""ArduPilot's mission text, ``QGC WPL 110``, one file per vehicle."""

from __future__ import annotations

from radmpc.io.export.job import Job
from radmpc.io.export.mission import WAYPOINT, Item, mission_items, visits_of
from radmpc.io.export.statements import origin_sentence, risk_sentence, timing_sentence, title
from radmpc.io.export.tracks import TimedPath
from radmpc.io.text.files import one_line

__all__ = ["write_waypoints"]

_ABSOLUTE = 0
"""MAV_FRAME_GLOBAL: altitude above mean sea level."""

_DATUM = (
    "altitudes are in meters above home (frame 3); line 0 is home, at the height of the plan's "
    "origin as it was given; the autopilot sets its own on arming"
)


def write_waypoints(job: Job, track: TimedPath) -> bytes:
    """Return a vehicle's part of a plan as an ArduPilot mission.

    Parameters
    ----------
    job : Job
        The plan and its place on earth.
    track : TimedPath
        The vehicle's part.

    Returns
    -------
    bytes
        Text, with comments that MAVProxy and Mission Planner pass over.
    """
    home = job.place.geodetic(track.positions[:1])[0].tolist()
    start = (0.0, 0.0, 0.0, 0.0)
    items = [Item(WAYPOINT, _ABSOLUTE, start, home[0], home[1], job.place.origin.height)]
    items += mission_items(track, job.place)
    comments = [
        title(job.plan, track.name),
        risk_sentence(job.plan, job.is_certified),
        timing_sentence(job.plan),
        *([] if job.note is None else [one_line(job.note)]),
        _DATUM,
        origin_sentence(job.place),
    ]
    # Line 0 is home: lines count as items do.
    comments += [
        f"line {found['item']} is visit {found['visit'] + 1} at {found['time']:g} s"
        for found in visits_of(track)
    ]
    lines = ["QGC WPL 110", *(f"# {comment}" for comment in comments)]
    lines += [_line(number, item) for number, item in enumerate(items)]
    return ("\n".join(lines) + "\n").encode()


def _line(number: int, item: Item) -> str:
    """Return a mission item's twelve columns."""
    fields = [str(number), "1" if number == 0 else "0", str(item.frame), str(item.command)]
    fields += [f"{parameter:.6f}" for parameter in item.parameters]
    fields += [f"{item.latitude:.9f}", f"{item.longitude:.9f}", f"{item.altitude:.4f}", "1"]
    return "\t".join(fields)
