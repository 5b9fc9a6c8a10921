"""Logs that `radmpc fly` writes: MCAP with messages in JSON."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np

from radmpc.arrays import Matrix
from radmpc.identification.track import Track
from radmpc.importing.logs.mcap_file import open_mcap
from radmpc.importing.logs.recording import Recording
from radmpc.io.flight.mcap_log import STATE_SCHEMA

__all__ = ["read_flight_log"]

Message = dict[str, list[float]]


def read_flight_log(path: Path) -> Recording | None:
    """Return the vehicles of a flight's log, a track for every mission.

    Parameters
    ----------
    path : Path
        An MCAP file.

    Returns
    -------
    Recording or None
        None where it holds something else.

    Raises
    ------
    FileFormatError
        If the library is missing, or the file's end.
    """
    found: dict[tuple[str, int], tuple[list[float], list[Message]]] = {}
    with path.open("rb") as file:
        reader, kinds = open_mcap(path, file)
        topics = [topic for topic, kind in kinds.items() if kind == STATE_SCHEMA]
        if not topics:
            return None
        for _, _, message in reader.iter_messages(topics=topics):
            content = json.loads(message.data)
            key = (str(content["vehicle"]), int(content["mission"]))
            times, contents = found.setdefault(key, ([], []))
            times.append(1e-9 * message.log_time)
            contents.append(content)
    return Recording(tuple(_track(path, name, *told) for (name, _), told in found.items()))


def _track(path: Path, name: str, times: list[float], contents: list[Message]) -> Track:
    """Return one vehicle in one mission."""
    positions = np.array([content["position"] for content in contents], dtype=np.float64)
    d = positions.shape[1]
    velocities = _rows(contents, "velocity", d)
    # Controls are accelerations only of what has a velocity, and one along each axis.
    is_pushed = velocities is not None and all(
        len(content.get("control", [0.0] * d)) == d for content in contents
    )
    width = d if velocities is None else 2 * d
    return Track(
        name,
        str(path),
        # Missions follow each other in the log's time.
        f"of {path}",
        np.array(times),
        positions,
        velocities,
        _held(_rows(contents, "control", d)) if is_pushed else None,
        _rows(contents, "reference", width),
    )


def _rows(contents: list[Message], key: str, width: int) -> Matrix | None:
    """Return a part of all messages, NaN where one lacks it; None where all do."""
    if not any(key in content for content in contents):
        return None
    gap = [np.nan] * width
    return np.array([content.get(key, gap) for content in contents], dtype=np.float64)


def _held(controls: Matrix | None) -> Matrix | None:
    """Return controls with the last in place of what follows it: nothing is flown from the end."""
    if controls is None:
        return None
    last = int(np.flatnonzero(np.isfinite(controls).all(axis=1))[-1])
    return np.vstack(
        [
            controls[: last + 1],
            np.repeat(controls[last : last + 1], len(controls) - 1 - last, axis=0),
        ]
    )
