"""The period of a log, whatever the last digits of its times."""

from __future__ import annotations

import numpy as np

from radmpc.arrays import Vector
from radmpc.identification.track import Track

__all__ = ["evened", "native_period", "phase", "rounded_step"]

_BREAK = 1.5
"""Median periods [-] without a sample that end a run of samples."""

_DIGITS = range(4, 13)
"""Digits that a step is written with: as few as do not drift off the samples."""

_DRIFT = 0.02
"""Share of a step [-] that a log's last sample may be off by such rounding."""

_RESOLUTIONS = range(7)
"""Decimals that times may be rounded to."""

_EXACT = 1e-6
"""Share of a period [-] below which times are even already."""

_ALIKE = 0.8
"""Mean resultant [-] of the places of samples in their steps above which these have a phase."""


def native_period(track: Track) -> float:
    """Return the time between two samples [s], by all of them; NaN for a single one.

    Least squares of times against counts in runs without a gap: a median would be off by the last
    digit of rounded times, which adds up.

    Parameters
    ----------
    track : Track
        With increasing times.
    """
    times = track.times
    if times.size < 2:
        return float("nan")
    lengths = np.diff(times)
    median = float(np.median(lengths))
    size = product = 0.0
    for run in np.split(times, np.flatnonzero(lengths > _BREAK * median) + 1):
        order = np.arange(run.size) - 0.5 * (run.size - 1)
        size += float(order @ order)
        product += float(order @ (run - run[0]))
    return product / size if size > 0.0 else median


def rounded_step(period: float, count: int) -> float:
    """Return a period with few digits, with more where the last of many steps would be off.

    Parameters
    ----------
    period : float
        As fitted [s].
    count : int
        Of how many steps.
    """
    steps = (float(f"{period:.{digits}g}") for digits in _DIGITS)
    allowed = _DRIFT * period / max(count, 1)
    return next((step for step in steps if abs(step - period) <= allowed), period)


def evened(track: Track) -> tuple[Track, tuple[str, ...]]:
    """Return a track whose times were rounded with the even ones that they stand for.

    Rounded times make positions and velocities disagree, which looks like noise.

    Parameters
    ----------
    track : Track
        With increasing times.

    Returns
    -------
    track : Track
        The same where times are no even ones that were rounded.
    warnings : tuple of str
        What was done.
    """
    times, period = track.times, native_period(track)
    if times.size < 3 or not period > 0.0 or np.ptp(times) > 1e9 * period:
        return track, ()
    since, counts = times - times[0], np.rint((times - times[0]) / period)
    if np.any(np.diff(counts) < 1.0):
        return track, ()
    even = np.polyval(np.polyfit(counts, since, 1), counts)
    off = float(np.abs(since - even).max())
    # Times since 1970 have no more than microseconds in 64 bits.
    noise = 4.0 * float(np.spacing(np.abs(times).max()))
    for decimals in _RESOLUTIONS:
        unit = 10.0**-decimals
        if np.abs(times / unit - np.rint(times / unit)).max() * unit <= noise:
            if off <= max(_EXACT * period, noise) or off > 0.55 * unit or unit >= period:
                return track, ()
            told = f"times are multiples of {unit:g} s, and are taken as even, {period:.6g} s apart"
            return track.changed({}, times[0] + even), (f"{track.where}: {told}",)
    return track, ()


def phase(times: Vector, dt: float) -> float:
    """Return the time of step 0 that goes with most samples, near the first one [s].

    Parameters
    ----------
    times : (N,) array
        Of a log.
    dt : float
        Step [s].
    """
    angles = np.exp(2j * np.pi * ((times - times[0]) / dt % 1.0))
    mean = complex(angles.mean())
    shift = float(np.angle(mean)) / (2.0 * np.pi)
    # The first sample may be off like any other; dense samples have no phase.
    return float(times[0]) + (shift * dt if abs(mean) > _ALIKE and abs(shift) > _EXACT else 0.0)
