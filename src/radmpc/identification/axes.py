"""Whether positions move as velocities say, axis by axis."""

from __future__ import annotations

import numpy as np
from scipy.special import stdtrit

from radmpc.arrays import Indices, Matrix, Vector
from radmpc.errors import FileFormatError
from radmpc.identification.track import Track

__all__ = ["check_axes", "check_still"]

_UNIT_RATIO = 3.0
"""Factor [-] between distances covered and velocities above which units are wrong: 3.6 between
km/h and m/s is found, a velocity that lags or is smoothed passes."""

_LEAST_MOTION = 0.5
"""Share of the spread of displacements [-] that velocities must explain, by whatever factor, before
their units are judged: of a vehicle at rest they tell nothing."""

_CLEAR = 0.9
"""The same where they leave hardly any doubt."""

_CLEAR_RATIO, _ODD_RATIO = 1.6, 1.15
"""Factors [-] that are then refused, as 1.94 between knots and m/s is, where all axes have them
alike, and told: along one axis a current may move a vehicle half as far as its velocity says."""

_SURE = 0.999
"""Probability [-] with which an odd factor is told from 1 before it is told of: of 200 logs each of
40 to 80 samples in which nothing is wrong up to 61 were, by chance. What is refused is further off
than that: asked as much, one log of 40 samples in five would be refused that should be."""

_CROSSED = 4.0
"""Factor [-] between what velocities of two axes leave unexplained from which on axes are mixed up:
ways along both may look alike."""

_WINDOW = 20
"""Samples over which distances are compared: noise averages out, motion adds up."""

_GAP = 1.5
"""Median times between samples [-] above which one is a gap."""

_RESTING = 0.1
"""Share of the samples [-] without any change above which it is told: variances are too small by as
much."""

_STUCK = 0.1
"""Share of the other axes' way [-] that velocities along one may tell while its position stays."""


def check_axes(track: Track) -> tuple[str, ...]:
    """Refuse velocities that contradict the positions by a factor, a sign or the axis.

    Parameters
    ----------
    track : Track
        With all numbers finite.

    Returns
    -------
    tuple of str
        What is odd, and may be right.

    Raises
    ------
    FileFormatError
        If positions and velocities cannot both be right.
    """
    if track.velocities is None or track.times.size < 3:
        return ()
    moved, told = _ways(track)
    _check_together(track, moved, told)
    warnings: list[str] = []
    slopes, shares = _explained(moved, told)
    _check_alike(track, np.diag(slopes), np.diag(shares))
    for i, axis in enumerate("xyz"[: track.dimension]):
        slope, share, best = slopes[i, i], shares[i, i], int(np.argmax(shares[i]))
        # Mixed-up axes change places: where paths along both look alike, one may explain both.
        is_clear = shares[i, best] > _CLEAR and best not in {i, int(np.argmax(shares[best]))}
        if is_clear and 1.0 - share > _CROSSED * (1.0 - shares[i, best]):
            raise FileFormatError(
                f"{track.where}: {axis} moves as v{'xyz'[best]} says, and not as v{axis}: are axes "
                "of positions and velocities the same?"
            )
        # Of less there is doubt: a current, or gusts that last, may move it otherwise.
        if share <= _CLEAR:
            continue
        if slope < 0.0:
            raise FileFormatError(
                f"{track.where}: {axis} moves against v{axis}: do they have the same sign?"
            )
        apart = max(slope, 1.0 / slope)
        if apart > _UNIT_RATIO:
            raise _wrong_units(track, slope, f"along {axis} ")
        if apart > _ODD_RATIO and _is_sure(track, slope, share):
            warnings.append(
                f"{track.where}: moves {slope:.3g} times as far along {axis} as v{axis} says: are "
                "both in the same units?"
            )
    return tuple(warnings)


def check_still(track: Track) -> tuple[str, ...]:
    """Refuse an axis whose position is stuck while its velocity goes somewhere.

    Parameters
    ----------
    track : Track
        With all numbers finite.

    Returns
    -------
    tuple of str
        What never changes, and how often nothing does.

    Raises
    ------
    FileFormatError
        If a position is stuck, or all are.
    """
    is_still = np.ptp(track.positions, axis=0) == 0.0
    if track.times.size < 2:
        return ()
    if is_still.all():
        raise FileFormatError(f"{track.where}: its position never changes: nothing to learn")
    warnings: list[str] = []
    for i in np.flatnonzero(is_still):
        axis, velocities = "xyz"[i], track.velocities
        if velocities is None or np.ptp(velocities[:, i]) == 0.0:
            told = f"{axis} never changes: its noise cannot be told, and is taken as 0"
        else:
            near = _without_gaps(track)
            steps = velocities[near, i] * np.diff(track.times)[near]
            way = float(np.ptp(np.cumsum(steps)))
            if way > _STUCK * float(np.ptp(track.positions, axis=0).max()):
                raise FileFormatError(
                    f"{track.where}: {axis} never changes, and v{axis} says that it moves "
                    f"{way:.3g} m: is the position stuck?"
                )
            told = f"{axis} never changes, though v{axis} does: its noise is that of v{axis}"
        warnings.append(f"{track.where}: {told}")
    return (*warnings, *_at_rest(track))


def _at_rest(track: Track) -> tuple[str, ...]:
    """Return how often nothing of a vehicle changes, where that makes its noise look small."""
    states = [part for part in (track.positions, track.velocities) if part is not None]
    rest = float(np.mean(np.all(np.diff(np.hstack(states), axis=0) == 0.0, axis=1)))
    if rest <= _RESTING:
        return ()
    return (
        f"{track.where}: nothing changes from {100.0 * rest:.0f} % of its samples to the next: at "
        "rest, or repeated? They count as steps without noise, so that the covariance is too "
        "small: leave them out",
    )


def _ways(track: Track) -> tuple[Matrix, Matrix]:
    """Return distances over some samples by positions and by velocities."""
    velocities = track.velocities
    assert velocities is not None
    near = _without_gaps(track)
    seconds = np.diff(track.times)[near, None]
    moved = np.diff(track.positions, axis=0)[near]
    told = 0.5 * (velocities[1:] + velocities[:-1])[near] * seconds
    window = _window(len(moved))
    return _summed(moved, window), _summed(told, window)


def _without_gaps(track: Track) -> Indices:
    """Return the samples with no gap to the next: what lies across, velocities do not tell."""
    lengths = np.diff(track.times)
    return np.flatnonzero(lengths <= _GAP * np.median(lengths))


def _window(count: int) -> int:
    """Return over how many of so many steps distances are compared."""
    return min(_WINDOW, max(count // 5, 1))


def _is_sure(track: Track, slope: float, share: float) -> bool:
    """Whether a slope that explains a share is not 1 but for chance.

    By Student's quantile and the standard error of a regression through 0, of as many pairs as
    there are windows beside each other.
    """
    count = len(_without_gaps(track))
    free = count / _window(count) - 1.0
    error = abs(slope) * np.sqrt(max(1.0 - share, 0.0) / share / free)
    return bool(abs(slope - 1.0) > error * stdtrit(free, 0.5 + 0.5 * _SURE))


def _check_together(track: Track, moved: Matrix, told: Matrix) -> None:
    """Refuse a factor that all axes have."""
    size, product = float(np.sum(told**2)), float(np.sum(told * moved))
    explained = product**2 / max(size * float(np.sum(moved**2)), 1e-300)
    if size <= 0.0 or explained < _LEAST_MOTION:
        return
    ratio = product / size
    if not 1.0 / _UNIT_RATIO < ratio < _UNIT_RATIO:
        raise _wrong_units(track, ratio, "")


def _check_alike(track: Track, slopes: Vector, shares: Vector) -> None:
    """Refuse a smaller factor that all axes have alike: a current or a gust is along some."""
    if slopes.size < 2 or shares.min() <= _CLEAR or slopes.min() <= 0.0:
        return
    ratio = float(np.exp(np.log(slopes).mean()))
    is_same = slopes.max() <= _ODD_RATIO * slopes.min()
    if is_same and max(ratio, 1.0 / ratio) > _CLEAR_RATIO:
        raise _wrong_units(track, ratio, "")


def _wrong_units(track: Track, ratio: float, along: str) -> FileFormatError:
    """Return the refusal of a factor."""
    return FileFormatError(
        f"{track.where}: moves {along}{ratio:.3g} times as far as its velocities say: are times in "
        "s, positions in m and velocities in m/s, along the same axes?"
    )


def _explained(moved: Matrix, told: Matrix) -> tuple[Matrix, Matrix]:
    """Return slopes of every axis's way by every velocity's, and what share each explains."""
    products = moved.T @ told
    sizes, spreads = np.sum(told**2, axis=0), np.sum(moved**2, axis=0)
    slopes = products / np.maximum(sizes, 1e-300)
    return slopes, products**2 / np.maximum(np.outer(spreads, sizes), 1e-300)


def _summed(rows: Matrix, window: int) -> Matrix:
    """Return sums of so many successive rows."""
    total = np.vstack([np.zeros(rows.shape[1]), np.cumsum(rows, axis=0)])
    return total[window:] - total[:-window]
