"""PX4 logs: ``vehicle_local_position`` and its setpoints, turned to east, north and up."""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import redirect_stdout
from io import StringIO
from mmap import ACCESS_READ, mmap
from pathlib import Path
from struct import Struct
from typing import Any

import numpy as np
import numpy.typing as npt

from radmpc.arrays import Matrix, Vector
from radmpc.identification.track import Track
from radmpc.importing.logs.recording import (
    Recording,
    extra,
    held,
    in_silence,
    interpolated,
    refusal,
)
from radmpc.wording import count_text

__all__ = ["read_ulog"]

_STATES, _SETPOINTS = "vehicle_local_position", "vehicle_local_position_setpoint"

_NO_COMMAND = 50.0
"""Acceleration setpoint [m/s²] from which on it is none: on the ground PX4 asks for 100 m/s² down,
so that motors idle."""

_START = 16
"""Bytes before the first message, which is that of flags."""

_HEAD = Struct("<HB")
"""A message's length behind these bytes, and its type."""

_FLAGS = Struct("<16xQQQ")
"""Where data begin that were appended after a crash, from the content of a message of flags."""

Data = Mapping[str, npt.NDArray[Any]]


def read_ulog(path: Path) -> Recording:
    """Return the vehicle of a PX4 log.

    Commands are the accelerations that its controller asked for, references the positions; the
    velocities of setpoints hold feedback already and are not used.

    Parameters
    ----------
    path : Path
        The log.

    Returns
    -------
    Recording
        One track, named like the file, with times since the autopilot's start.

    Raises
    ------
    FileFormatError
        If it cannot be read, holds no positions, or pyulog is missing.
    """
    library = extra("pyulog", path)
    if not path.is_file():
        raise refusal(path, "No such file or directory")
    try:
        # Opened here: the library leaves a file open that it cannot read.
        # What it prints would stand among what is printed here.
        with path.open("rb") as file, redirect_stdout(StringIO()):
            log = library.ULog(file, [_STATES, _SETPOINTS])
    except Exception as error:  # the library raises whatever its parser stumbles on
        raise refusal(path, f"cannot be read as ULog: {error}") from error
    found = {one.name: one.data for one in reversed(log.data_list)}
    if _STATES not in found or not len(found[_STATES]["timestamp"]):
        raise refusal(path, f"holds no {_STATES}")
    states = found[_STATES]
    times = _seconds(states)
    warnings = _losses(path, log, times, is_cut=_ends_within_message(path))
    positions = _valid(states, _turned(states, ("x", "y", "z")), ("xy_valid", "z_valid"))
    velocities = _valid(states, _turned(states, ("vx", "vy", "vz")), ("v_xy_valid", "v_z_valid"))
    if np.isnan(positions[:, 0]).all():
        raise refusal(path, f"{_STATES}: xy_valid is never true: there is no horizontal position")
    positions, resets = _without_resets(states, positions, "xy", "z", "delta_xy", "delta_z")
    velocities, more = _without_resets(states, velocities, "vxy", "vz", "delta_vxy", "delta_vz")
    if resets + more:
        warnings.append(f"{path}: undone: {count_text(resets + more, 'reset')} of the estimator")
    controls, references = _setpoints(found.get(_SETPOINTS), times)
    track = Track(
        path.stem, str(path), f"of {path}", times, positions, velocities, controls, references
    )
    return Recording((track,), tuple(warnings))


def _losses(path: Path, log: Any, times: Vector, *, is_cut: bool) -> list[str]:
    """Return what is missing in a log, in words."""
    lost = []
    told = f"{count_text(len(times), 'sample')} from {times[0]:.6g} s to {times[-1]:.6g} s"
    if log.file_corruption:
        lost.append(f"{path}: a part of the log is corrupt: {told} are read")
    elif is_cut:
        lost.append(f"{path}: ends within a message: the log was cut off: {told} are read")
    if log.dropouts:
        seconds = sum(dropout.duration for dropout in log.dropouts) / 1000.0
        dropouts = count_text(len(log.dropouts), "dropout")
        lost.append(f"{path}: {dropouts} of the log, {seconds:.3g} s in all")
    return lost


def _ends_within_message(path: Path) -> bool:
    """Whether a log's last message is cut off: the library leaves it out without a word."""
    with path.open("rb") as file, mmap(file.fileno(), 0, access=ACCESS_READ) as content:
        size, at, appended = len(content), _START, []
        while at + _HEAD.size <= size:
            length, kind = _HEAD.unpack_from(content, at)
            is_first, begin = at == _START, at + _HEAD.size
            at = begin + length
            if is_first and kind == ord("B") and _FLAGS.size <= length <= size - begin:
                appended = sorted(offset for offset in _FLAGS.unpack_from(content, begin) if offset)
            # A crash may have cut off the message before what was appended after it.
            if appended and at >= appended[0]:
                at = appended.pop(0)
        return at != size


def _seconds(data: Data) -> Vector:
    """Return the times of messages [s]."""
    return np.asarray(data["timestamp"], dtype=np.float64) * 1e-6


def _turned(data: Data, names: tuple[str, str, str]) -> Matrix:
    """Return north, east, down as east, north, up."""
    north, east, down = (np.asarray(data[name], dtype=np.float64) for name in names)
    return np.column_stack([east, north, -down])


def _valid(data: Data, values: Matrix, flags: tuple[str, str]) -> Matrix:
    """Return values, NaN where the estimator says that they are none."""
    found = values.copy()
    for flag, axes in zip(flags, (slice(0, 2), slice(2, 3)), strict=True):
        if flag in data:
            found[np.asarray(data[flag]) == 0, axes] = np.nan
    return found


def _without_resets(
    data: Data, values: Matrix, across: str, up: str, by: str, by_up: str
) -> tuple[Matrix, int]:
    """Return values as they would be without the estimator's resets, and how many there were."""
    found, count = values.copy(), 0
    parts = ((across, (f"{by}[1]", f"{by}[0]"), (0, 1), 1.0), (up, (by_up,), (2,), -1.0))
    for name, deltas, axes, sign in parts:
        counter = data.get(f"{name}_reset_counter")
        if counter is None or any(delta not in data for delta in deltas):
            continue
        resets = np.flatnonzero(np.diff(np.asarray(counter, dtype=np.int64)) != 0) + 1
        # What was never valid before has nothing to be continued.
        resets = np.array([k for k in resets if np.isfinite(values[k - 1, axes[0]])], dtype=int)
        count += len(resets)
        for delta, axis in zip(deltas, axes, strict=True):
            for k in resets:
                found[k:, axis] -= sign * float(data[delta][k])
    return found, count


def _setpoints(data: Data | None, times: Vector) -> tuple[Matrix | None, Matrix | None]:
    """Return commanded accelerations and reference positions at the states' times."""
    if data is None or not len(data["timestamp"]):
        return None, None
    at = _seconds(data)
    new = "acceleration[0]" in data
    names = [f"acceleration[{i}]" for i in range(3)] if new else ["acc_x", "acc_y", "acc_z"]
    controls = None
    if all(name in data for name in names):
        asked = _turned(data, (names[0], names[1], names[2]))
        asked[np.abs(asked).max(axis=1) >= _NO_COMMAND] = np.nan
        controls = held(at, asked, times)
        # Flown by hand, a vehicle is commanded nothing.
        controls[in_silence(at, times)] = np.nan
    references = interpolated(at, _turned(data, ("x", "y", "z")), times)
    return controls, references
