"""A track at steps of dt: what was measured there, or between its neighbors."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from radmpc.arrays import Indices, Matrix, Vector
from radmpc.errors import FileFormatError
from radmpc.identification.timing import native_period
from radmpc.identification.track import Track
from radmpc.records import dataclass

__all__ = ["Samples", "sample"]

_CLOSE = 0.1
"""Share of dt [-] by which a sample may be off its step and still stand for it: steps keep their
own length, so that nothing is smoothed."""

_FAR = 0.25
"""The same where nearly all are close: the few others are no gaps."""

_GAP = 2.5
"""Periods of the log [-] without a sample that count as a gap."""


@dataclass(frozen=True, slots=True, eq=False)
class Samples:
    """One vehicle at steps.

    Attributes
    ----------
    track : Track
        Where they come from.
    steps : (m,) array of int
        Which steps, counted from a start that all tracks of a clock share; gaps leave some out.
    times : (m,) array
        When they were measured [s].
    states : (m, n) array
        Positions, and velocities where they were logged.
    second : (m, d) array or None
        Positions by another sensor [m].
    controls : (m, d) array or None
        Mean command of the step that follows [m/s²].
    effects : (m, n) array or None
        What the commands alone make of a state at rest until the next sample.
    references : (m, n) array or None
        Where the state was to be.
    """

    track: Track
    steps: Indices
    times: Vector
    states: Matrix
    second: Matrix | None
    controls: Matrix | None
    effects: Matrix | None
    references: Matrix | None


def sample(track: Track, dt: float, start: float) -> tuple[Samples, tuple[str, ...]]:
    """Return a track at steps of dt.

    Samples close to a step stand for it, with their own times. Where there are none, positions are
    interpolated by cubics, velocities linearly, which smooths noise and is told.

    Parameters
    ----------
    track : Track
        Cleaned.
    dt : float
        Step [s].
    start : float
        Time of step 0 [s], common to all tracks of a clock.

    Returns
    -------
    samples : Samples
        At steps that have data.
    warnings : tuple of str
        What was done to the samples.

    Raises
    ------
    FileFormatError
        If the log has fewer samples than steps.
    """
    period = native_period(track)
    if period > 1.05 * dt:
        raise FileFormatError(
            f"{track.where}: has a sample every {period:.4g} s, too few for steps of {dt:g} s: "
            f"--dt must be at least {period:.4g}"
        )
    warnings: list[str] = []
    # Only steps beside samples: a clock that is set during a log would make billions of others.
    exact = (track.times - start) / dt
    wanted = np.unique(np.concatenate([np.floor(exact), np.ceil(exact)]))
    places = start + wanted * dt
    nearest = _nearest(track.times, places)
    offset = np.abs(track.times[nearest] - places)
    is_covered = _is_covered(track.times, places, _GAP * period)
    is_close = offset <= max(_CLOSE * dt, 1e-9)
    if is_covered.any() and is_close[is_covered].mean() > 0.9:
        is_close = offset <= max(_FAR * dt, 1e-9)
        steps, chosen = wanted[is_close].astype(np.int64), nearest[is_close]
        first = np.concatenate([[True], np.diff(chosen) > 0])
        return _picked(track, steps[first], chosen[first]), _gap_warning(track, steps[first], dt)
    warnings.append(
        f"{track.where}: samples, one every {period:.4g} s, do not fall on steps of {dt:g} s: "
        "they are interpolated, which hides a part of the noise"
    )
    steps = wanted[is_covered].astype(np.int64)
    return _between(track, steps, places[is_covered]), (
        *warnings,
        *_gap_warning(track, steps, dt),
    )


def _nearest(times: Vector, places: Vector) -> Indices:
    """Return the index of the sample nearest to each place."""
    after = np.clip(np.searchsorted(times, places), 1, len(times) - 1) if len(times) > 1 else None
    if after is None:
        return np.zeros(len(places), dtype=np.int64)
    is_before = places - times[after - 1] <= times[after] - places
    return np.asarray(after - is_before, dtype=np.int64)


def _is_covered(times: Vector, places: Vector, gap: float) -> npt.NDArray[np.bool_]:
    """Whether places lie between two samples that are no gap apart."""
    after = np.clip(np.searchsorted(times, places), 1, max(len(times) - 1, 1))
    if len(times) < 2:
        return np.zeros(len(places), dtype=bool)
    is_inside = (places >= times[0]) & (places <= times[-1])
    return np.asarray(is_inside & (times[after] - times[after - 1] <= gap))


def _gap_warning(track: Track, steps: Indices, dt: float) -> tuple[str, ...]:
    """Tell gaps of a log."""
    missing = np.diff(steps) - 1
    if not np.any(missing > 0):
        return ()
    count, longest = int((missing > 0).sum()), float(missing.max() + 1) * dt
    word = "a gap" if count == 1 else f"{count} gaps, the longest"
    return (f"{track.where}: has {word} of {longest:.4g} s; what lies across is not used",)


def _picked(track: Track, steps: Indices, chosen: Indices) -> Samples:
    """Return samples as they were measured."""
    times = track.times[chosen]
    effects, means = _commanded(track, times)
    states = track.positions[chosen]
    if track.velocities is not None:
        states = np.hstack([states, track.velocities[chosen]])
    references = _references(track)
    second = track.second_positions
    return Samples(
        track, steps, times, states,
        None if second is None else second[chosen],
        means, effects,
        None if references is None else references[chosen],
    )  # fmt: skip


def _between(track: Track, steps: Indices, times: Vector) -> Samples:
    """Return samples interpolated at the steps."""
    effects, means = _commanded(track, times)
    if track.velocities is None:
        states = _linear(track.times, track.positions, times)
    else:
        # Loaded here: few logs need it.
        from scipy.interpolate import CubicHermiteSpline  # noqa: PLC0415 - loads slowly

        path = CubicHermiteSpline(track.times, track.positions, track.velocities)
        states = np.hstack([path(times), _linear(track.times, track.velocities, times)])
    references = _references(track)
    second = track.second_positions
    return Samples(
        track, steps, times, states,
        None if second is None else _linear(track.times, second, times),
        means, effects,
        None if references is None else _linear(track.times, references, times),
    )  # fmt: skip


def _linear(times: Vector, values: Matrix, at: Vector) -> Matrix:
    """Return values between samples."""
    return np.column_stack([np.interp(at, times, column) for column in values.T])


def _references(track: Track) -> Matrix | None:
    """Return references of whole states: velocities from positions where they are not logged."""
    found, d = track.references, track.dimension
    if found is None or track.velocities is None:
        return None if found is None else found[:, :d]
    if found.shape[1] == 2 * d or track.times.size < 2:
        return found
    return np.hstack([found, np.gradient(found, track.times, axis=0)])


def _commanded(track: Track, times: Vector) -> tuple[Matrix | None, Matrix | None]:
    """Return what the commands of every step make of a state at rest, and their means."""
    controls = track.controls
    if controls is None or track.velocities is None:
        return None, None
    # Velocity and position that the commands alone lead to, exact for held commands.
    seconds = np.diff(track.times)[:, None]
    gained = np.vstack([np.zeros(track.dimension), np.cumsum(controls[:-1] * seconds, axis=0)])
    pieces = gained[:-1] * seconds + 0.5 * controls[:-1] * seconds**2
    moved = np.vstack([np.zeros(track.dimension), np.cumsum(pieces, axis=0)])
    last = np.clip(np.searchsorted(track.times, times, side="right") - 1, 0, None)
    into = (times - track.times[last])[:, None]
    velocity = gained[last] + controls[last] * into
    position = moved[last] + gained[last] * into + 0.5 * controls[last] * into**2
    lengths = np.diff(times)[:, None]
    by_velocity = np.diff(velocity, axis=0)
    by_position = np.diff(position, axis=0) - velocity[:-1] * lengths
    effects = np.vstack([np.hstack([by_position, by_velocity]), np.zeros(2 * track.dimension)])
    return effects, np.vstack([by_velocity / lengths, controls[last[-1:]]])
