"""What a log holds, whatever its format, and how its parts are brought to common times."""

from __future__ import annotations

from importlib import import_module
from pathlib import Path
from types import ModuleType

import numpy as np
import numpy.typing as npt

from radmpc.arrays import Matrix, Vector
from radmpc.errors import FileFormatError
from radmpc.identification.track import Track
from radmpc.io.text.files import one_line
from radmpc.records import dataclass

__all__ = [
    "EPOCH",
    "Recording",
    "clock_of",
    "extra",
    "flat",
    "held",
    "in_silence",
    "interpolated",
    "refusal",
]

EPOCH = 1e8
"""Times beyond it count from 1970 [s]: nothing else is on for three years."""

_SILENCE = 5.0
"""Median periods [-] without a sample from which on a topic is silent: values in between are not
known."""


@dataclass(frozen=True, slots=True)
class Recording:
    """The vehicles of a log.

    Attributes
    ----------
    tracks : tuple of Track
        One per vehicle.
    warnings : tuple of str
        What was left out, or had to be assumed.
    """

    tracks: tuple[Track, ...]
    warnings: tuple[str, ...] = ()


def extra(name: str, path: Path) -> ModuleType:
    """Return an optional library.

    Parameters
    ----------
    name : str
        Of its module.
    path : Path
        The log that needs it.

    Raises
    ------
    FileFormatError
        If it is not installed; the message says what to install.
    """
    try:
        return import_module(name)
    except ImportError as error:
        library = name.partition(".")[0]
        raise refusal(path, f"needs {library}: pip install 'radmpc[logs]'") from error


def refusal(path: Path, message: str) -> FileFormatError:
    """Return the error of a log, in one line.

    Parameters
    ----------
    path : Path
        The log.
    message : str
        What is wrong.
    """
    return FileFormatError(one_line(f"{path}: {message}"))


def clock_of(path: Path, times: Vector) -> str:
    """Return which clock times are from: that of the world, or the file's own.

    Parameters
    ----------
    path : Path
        The log.
    times : (N,) array
        Its times [s].
    """
    finite = times[np.isfinite(times)]
    return "since 1970" if finite.size and finite.min() > EPOCH else f"of {path}"


def held(times: Vector, values: Matrix, at: Vector) -> Matrix:
    """Return the last values at or before some times; NaN before the first.

    Parameters
    ----------
    times : (M,) array
        Of the values, increasing [s].
    values : (M, k) array
        What was logged.
    at : (N,) array
        Where they are wanted [s].
    """
    place = np.searchsorted(times, at, side="right") - 1
    found = np.array(values[np.clip(place, 0, None)], dtype=np.float64)
    found[place < 0] = np.nan
    return found


def interpolated(times: Vector, values: Matrix, at: Vector) -> Matrix:
    """Return values at some times, linearly between samples; NaN outside, in gaps, and beside NaN.

    Parameters
    ----------
    times : (M,) array
        Of the values, increasing [s].
    values : (M, k) array
        What was logged.
    at : (N,) array
        Where they are wanted [s].
    """
    columns = [np.interp(at, times, column, left=np.nan, right=np.nan) for column in values.T]
    found = np.column_stack(columns)
    found[in_silence(times, at)] = np.nan
    return found


def in_silence(times: Vector, at: Vector) -> npt.NDArray[np.bool_]:
    """Return which times fall between samples that are far apart, or long after the last.

    Parameters
    ----------
    times : (M,) array
        Of the samples, not decreasing [s].
    at : (N,) array
        Times to be told apart [s].
    """
    periods = np.diff(times)
    if not np.any(periods > 0.0):
        return np.zeros(len(at), dtype=np.bool_)
    longest = _SILENCE * float(np.median(periods[periods > 0.0]))
    place = np.searchsorted(times, at, side="right") - 1
    before = times[np.clip(place, 0, None)]
    after = np.where(place + 1 < len(times), times[np.clip(place + 1, None, len(times) - 1)], at)
    return (place >= 0) & (at > before) & (after - before > longest)


def flat(track: Track) -> Track:
    """Return a track without a height that never changes.

    Parameters
    ----------
    track : Track
        In space.
    """
    height = track.positions[:, 2]
    height = height[np.isfinite(height)]
    if height.size and np.ptp(height) > 0.0:
        return track
    parts: dict[str, Matrix] = {}
    for name in track.parts():
        array = getattr(track, name)
        kept = [i for i in range(array.shape[1]) if i % 3 != 2]
        parts[name] = array[:, kept]
    return Track(track.name, track.source, track.clock, track.times, **parts)
