"""Files that hold no problem, though radmpc writes or reads them: what they are, and what for."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path

from radmpc.io.flight.flight_file import is_flight
from radmpc.io.ranges import PLAN_FORMAT, SCENARIO_FORMAT

__all__ = ["content_text", "name_text"]

_LOG = "is a log, not a problem: 'radmpc identify' reads logs"
_MISSION = "is a mission for an autopilot, not a problem: a plan's own .json holds its scenario"

_ENDINGS: Mapping[str, str] = {
    ".csv": "is a table of a plan or of a log, not a problem: 'radmpc identify' reads logs, and a "
    "plan's own .json holds its scenario",
    ".db3": _LOG,
    ".mcap": _LOG,
    ".ulg": _LOG,
    ".plan": _MISSION,
    ".waypoints": _MISSION,
}


def content_text(value: object) -> str | None:
    """Return what a document is that no importer knows; None if that cannot be told.

    Parameters
    ----------
    value : object
        Its content.
    """
    if not isinstance(value, Mapping):
        return None
    if value.get("format") == SCENARIO_FORMAT:
        return "is a scenario already"
    if value.get("format") == PLAN_FORMAT:
        return (
            "is a plan, not a problem: 'radmpc verify', 'draw', 'fly' and 'export' read it, and "
            "its scenario stands in it"
        )
    return _MISSION if value.get("fileType") == "Plan" else None


def name_text(path: str | os.PathLike[str]) -> str | None:
    """Return what a file is that cannot be read as a problem; None if that cannot be told.

    Parameters
    ----------
    path : path
        The file.
    """
    if not Path(path).is_file():
        return None
    if is_flight(path):
        return "is a flight, not a problem: 'radmpc verify', 'draw' and 'fly' read it"
    return _ENDINGS.get(Path(path).suffix.lower())
