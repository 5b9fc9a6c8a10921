"""Tracks of ROS 2 messages: odometry, or poses and twists, by the topics' namespaces."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

import numpy as np

from radmpc.arrays import Matrix, Vector
from radmpc.identification.track import Track
from radmpc.importing.logs.recording import (
    Recording,
    clock_of,
    flat,
    held,
    interpolated,
    refusal,
)
from radmpc.importing.logs.series import (
    ACCEL,
    ODOMETRY,
    POSE,
    TWIST,
    TYPES,
    Message,
    Series,
    series_of,
)
from radmpc.importing.logs.topics import is_reference, vehicles_of

__all__ = ["tracks_of"]

_BETTER = 0.5
"""Factor [-] by which velocities must agree better with the positions in the world's frame than in
the vehicle's before the message's word for its frame is not believed."""


def tracks_of(path: Path, messages: Iterable[Message]) -> Recording:
    """Return the vehicles of a bag.

    Parameters
    ----------
    path : Path
        The bag.
    messages : iterable of Message
        Of the types in `TYPES`.

    Raises
    ------
    FileFormatError
        If there is neither odometry nor a pose, or a clock starts again.
    """
    topics: dict[tuple[str, str], list[Message]] = {}
    for message in messages:
        topics.setdefault((message.topic, message.type), []).append(message)
    found = {key: series_of(path, topics[key]) for key in sorted(topics)}
    warnings: list[str] = []
    tracks = []
    for space, series in vehicles_of(path, found, warnings).items():
        track = _track(path, space or path.stem, series, warnings)
        if track is not None:
            tracks.append(track)
    if not tracks:
        kinds = " or ".join((ODOMETRY, POSE))
        places = ", ".join(topic for topic, kind in found if kind in {ODOMETRY, POSE})
        if places:
            raise refusal(path, f"holds {kinds} only on topics of references: {places}")
        raise refusal(path, f"holds no message of type {kinds}")
    return Recording(tuple(tracks), tuple(warnings))


def _track(
    path: Path, name: str, series: dict[tuple[str, str], Series], warnings: list[str]
) -> Track | None:
    """Return one vehicle of a bag, None where its place is not told."""
    by_kind: dict[str, list[tuple[str, Series]]] = {kind: [] for kind in TYPES}
    wanted: dict[str, list[tuple[str, Series]]] = {kind: [] for kind in TYPES}
    for (leaf, kind), one in series.items():
        (wanted if is_reference(leaf) else by_kind)[kind].append((leaf, one))
    places = [*by_kind[ODOMETRY], *by_kind[POSE]]
    if not places:
        return None
    (leaf, main), *others = places
    where = f"{path}: vehicle {name!r}"
    speeds = _speeds(main, by_kind[TWIST], where, warnings)
    second = None
    for other_leaf, other in others:
        matched = _matched(other, main.times) if second is None else None
        if matched is not None and _differs(matched, main.values):
            second = matched
            warnings.append(f"{where}: {other_leaf} is taken for another sensor beside {leaf}")
        else:
            warnings.append(f"{where}: {other_leaf} is not used beside {leaf}")
    references = _references(wanted, main.times)
    accelerations = [*wanted[ACCEL], *by_kind[ACCEL]][:1]
    controls = [held(one.times, one.values, main.times) for _, one in accelerations]
    found = Track(
        name, str(path), clock_of(path, main.times), main.times, main.values,
        speeds, controls[0] if controls else None, references, second,
    )  # fmt: skip
    return flat(found)


def _differs(matched: Matrix, values: Matrix) -> bool:
    """Whether another sensor's positions are more than shifted ones."""
    apart = matched - values
    apart = apart[np.isfinite(apart).all(axis=1)]
    return bool(apart.size) and bool(np.ptp(apart, axis=0).max() > 0.0)


def _speeds(
    main: Series, twists: list[tuple[str, Series]], where: str, warnings: list[str]
) -> Matrix | None:
    """Return velocities in the world's frame."""
    speeds, is_in_body = main.speeds, main.is_in_body
    if speeds is None and twists:
        _, twist = twists[0]
        speeds, is_in_body = interpolated(twist.times, twist.values, main.times), twist.is_in_body
    if speeds is None or main.turns is None:
        return speeds
    turned = _rotated(main.turns, speeds)
    believed, other = (turned, speeds) if is_in_body else (speeds, turned)
    if _misfit(main, other) < _BETTER * _misfit(main, believed):
        frame = "the world's frame" if is_in_body else "the vehicle's frame"
        warnings.append(f"{where}: velocities agree with the positions only if read in {frame}")
        return other
    return believed


def _rotated(turns: Matrix, vectors: Matrix) -> Matrix:
    """Return vectors turned by quaternions; those of length 0 turn nothing."""
    lengths = np.linalg.norm(turns, axis=1, keepdims=True)
    is_turn = lengths[:, 0] > 1e-6
    unit = np.where(is_turn[:, None], turns / np.maximum(lengths, 1e-6), [0.0, 0.0, 0.0, 1.0])
    axis, angle = unit[:, :3], unit[:, 3:]
    across = 2.0 * np.cross(axis, vectors)
    return np.asarray(vectors + angle * across + np.cross(axis, across))


def _misfit(main: Series, speeds: Matrix) -> float:
    """Return how far velocities are from what the positions do [m²]."""
    seconds = np.diff(main.times)[:, None]
    told = 0.5 * (speeds[1:] + speeds[:-1]) * seconds
    return float(np.nansum((np.diff(main.values, axis=0) - told) ** 2)) + 1e-12


def _matched(other: Series, times: Vector) -> Matrix | None:
    """Return another sensor's positions if it measures at the same times."""
    if len(times) < 2:
        return None
    period = float(np.median(np.diff(times)))
    place = np.clip(np.searchsorted(other.times, times), 1, max(len(other.times) - 1, 1))
    if len(other.times) < 2:
        return None
    nearer = times - other.times[place - 1] <= other.times[place] - times
    place = place - nearer
    is_near = np.abs(other.times[place] - times) <= 0.1 * period
    if is_near.mean() < 0.9:
        return None
    found = np.array(other.values[place])
    found[~is_near] = np.nan
    return found


def _references(wanted: dict[str, list[tuple[str, Series]]], times: Vector) -> Matrix | None:
    """Return where the vehicle was to be, and how fast if that was logged."""
    for kind in (ODOMETRY, POSE):
        for _, one in wanted[kind][:1]:
            speeds = one.speeds
            if speeds is not None and one.is_in_body and one.turns is not None:
                speeds = _rotated(one.turns, speeds)
            rows = one.values if speeds is None else np.hstack([one.values, speeds])
            return interpolated(one.times, rows, times)
    return None
