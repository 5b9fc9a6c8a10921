"""Samples that can be used, and what had to be left out: every flaw of a log is told."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from radmpc.errors import FileFormatError
from radmpc.identification.axes import check_axes, check_still
from radmpc.identification.track import Track

__all__ = ["clean", "without_copies"]

_LEAST_SHARE, _LEAST_SAMPLES = 0.2, 40
"""Share [-] and number of samples below which a part that is mostly missing counts as not logged:
else the rest goes instead, such as the time on the ground, where nothing is commanded."""

_COPIED = 1e-9
"""Distance between references and states, over the largest of these, at which those are copies
of these [-]."""

_LONGEST_PERIOD, _SHORTEST_PERIOD = 60.0, 1e-5
"""Time between two samples [s] beyond which times are hardly in seconds."""

_LATEST = 1e11
"""Times [s] that no clock has yet: 3000 years after 1970."""

_LEAST_STEP, _FARTHEST = 1e-4, 180.0
"""Median way between two samples [m], and place, that look like degrees."""


def clean(track: Track, *, dimension: int | None = None) -> tuple[Track | None, tuple[str, ...]]:
    """Return a track without samples that say nothing, and what was left out.

    Parameters
    ----------
    track : Track
        As logged.
    dimension : int or None
        Axes to keep; None keeps all.

    Returns
    -------
    track : Track or None
        All numbers finite, times increasing; None if no sample is left.
    warnings : tuple of str
        A sentence for every flaw.

    Raises
    ------
    FileFormatError
        If time runs backwards, nothing moves or units contradict each other.
    """
    warnings: list[str] = []
    found = _with_axes(track, dimension)
    for step in (_without_missing_parts, _without_missing_samples):
        found = step(found, warnings)
    if not found.times.size:
        axes = "xyz"[: dimension or track.dimension]
        empty = [axis for i, axis in enumerate(axes) if np.isnan(track.positions[:, i]).all()]
        is_part = 0 < len(empty) < len(axes)
        lack = f"position along {' and '.join(empty)}" if is_part else "data"
        return None, (f"{track.where}: has no {lack}, and is left out",)
    found = _in_order(found, warnings)
    found = _without_constants(found, warnings)
    warnings += check_axes(found)
    _check_period(found, warnings)
    return found, tuple(warnings)


def without_copies(track: Track) -> Track:
    """Return a track without references that are its states, as plans made at every step begin.

    They tell nothing of what the vehicle does off them.

    Parameters
    ----------
    track : Track
        With all numbers finite.
    """
    if track.references is None:
        return track
    states = track.positions
    if track.references.shape[1] > track.dimension and track.velocities is not None:
        states = np.hstack([track.positions, track.velocities])
    apart = np.abs(track.references[:, : states.shape[1]] - states).max(axis=1)
    is_apart = apart > _COPIED * max(float(np.abs(states).max()), 1.0)
    return track.changed({"references": None}) if is_apart.mean() < _LEAST_SHARE else track


def _with_axes(track: Track, dimension: int | None) -> Track:
    """Return the first axes of a track."""
    own = track.dimension
    if dimension is None or dimension == own:
        return track
    if dimension > own:
        raise FileFormatError(f"{track.where}: has {own} axes, and {dimension} are needed")
    parts = {
        name: np.hstack(
            [
                array[:, first : first + dimension]
                for array in (getattr(track, name),)
                for first in range(0, array.shape[1], own)
            ]
        )
        for name in track.parts()
    }
    return track.changed(parts)


def _without_missing_parts(track: Track, warnings: list[str]) -> Track:
    """Drop commands, references and the like that are there in few samples only."""
    for name in track.parts():
        if name == "positions":
            continue
        is_there = np.isfinite(getattr(track, name)).all(axis=1)
        is_little = is_there.sum() < _LEAST_SAMPLES and is_there.mean() < 0.5
        if is_there.mean() < _LEAST_SHARE or is_little:
            if is_there.any():
                told = f"{name.replace('_', ' ')} stand in {is_there.sum()} of {is_there.size}"
                warnings.append(f"{track.where}: {told} samples only, and are not used")
            track = track.changed({name: None})
    return track


def _without_missing_samples(track: Track, warnings: list[str]) -> Track:
    """Drop samples of which a number is missing."""
    parts = [np.isfinite(getattr(track, name)).all(axis=1) for name in track.parts()]
    is_whole = np.logical_and.reduce([np.isfinite(track.times), *parts])
    missing = int((~is_whole).sum())
    if missing and is_whole.any():
        told = f"{missing} of {is_whole.size} samples lack a number"
        warnings.append(f"{track.where}: {told}, and are left out")
    return _taken(track, is_whole)


def _in_order(track: Track, warnings: list[str]) -> Track:
    """Drop repeated times; refuse a time that runs backwards."""
    forward = np.diff(track.times)
    if np.any(forward < 0.0):
        at = int(np.argmax(forward < 0.0)) + 1
        cause = "are these two logs in one?"
        if np.all(forward <= 0.0):
            cause = "the whole log does: turn its rows and times around"
        # As few digits as tell a time from all others: stamps since 1970 have ten before the point.
        earlier, later = (
            f"{float(time)!r}".removesuffix(".0") for time in track.times[at - 1 : at + 1]
        )
        raise FileFormatError(
            f"{track.where}: time runs backwards at sample {at + 1}: {later} s after {earlier} s; "
            f"{cause}"
        )
    is_new = np.concatenate([[True], forward > 0.0])
    repeated = int((~is_new).sum())
    if repeated:
        told = (
            f"{repeated} samples repeat the time before them"
            if repeated > 1
            else ("a sample repeats the time before it")
        )
        warnings.append(f"{track.where}: {told}, and {'are' if repeated > 1 else 'is'} left out")
    return _taken(track, is_new)


def _without_constants(track: Track, warnings: list[str]) -> Track:
    """Tell what never changes; velocities that never change were not measured."""
    warnings += check_still(track)
    is_still = np.ptp(track.positions, axis=0) == 0.0
    references, velocities = track.references, track.velocities
    if references is not None and track.times.size > 1 and not np.ptp(references, axis=0).any():
        warnings.append(f"{track.where}: references never change: were they logged?")
    if velocities is None or track.times.size < 2:
        return track
    if np.any((np.ptp(velocities, axis=0) == 0.0) & ~is_still):
        warnings.append(f"{track.where}: velocities never change, and are not used")
        return track.changed({"velocities": None})
    return track


def _check_period(track: Track, warnings: list[str]) -> None:
    """Refuse times that are no seconds, tell those that hardly are."""
    if track.times.size < 2:
        return
    latest = float(track.times[-1])
    if latest > _LATEST:
        raise FileFormatError(
            f"{track.where}: times go up to {latest:.9g}: they must be in seconds, these look like "
            "milliseconds or less"
        )
    period = float(np.median(np.diff(track.times)))
    if not _SHORTEST_PERIOD <= period <= _LONGEST_PERIOD:
        warnings.append(f"{track.where}: a sample every {period:.3g} s: are times in seconds?")
    step = float(np.median(np.abs(np.diff(track.positions, axis=0)).max(axis=1)))
    size = float(np.abs(track.positions).max())
    way = float(np.ptp(track.positions, axis=0).max())
    if 0.0 < step < _LEAST_STEP and 100.0 * way < size < _FARTHEST:
        warnings.append(
            f"{track.where}: moves {step:.3g} m from sample to sample: are positions in m, and not "
            "degrees?"
        )


def _taken(track: Track, which: npt.NDArray[np.bool_]) -> Track:
    """Return some of the samples."""
    if which.all():
        return track
    parts = {name: getattr(track, name)[which] for name in track.parts()}
    return track.changed(parts, track.times[which])
