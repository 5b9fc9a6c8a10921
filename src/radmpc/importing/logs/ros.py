"""Tracks of ROS 2 messages: odometry, or poses and twists, by the topics' namespaces."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Any, NamedTuple

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

__all__ = ["TYPES", "Message", "tracks_of"]

_ODOMETRY, _POSE, _TWIST, _ACCEL = (
    "nav_msgs/msg/Odometry",
    "geometry_msgs/msg/PoseStamped",
    "geometry_msgs/msg/TwistStamped",
    "geometry_msgs/msg/AccelStamped",
)
TYPES = (_ODOMETRY, _POSE, _TWIST, _ACCEL)
"""Types of messages that are read."""

_REFERENCE = ("ref", "setpoint", "target", "desired", "goal", "cmd", "command")
"""Words in a topic's last parts that make it say where the vehicle is to be."""

_BETTER = 0.5
"""Factor [-] by which velocities must agree better with the positions in the world's frame than in
the vehicle's before the message's word for its frame is not believed."""


class Message(NamedTuple):
    """A message: its topic, type, time of logging [ns] and content, and no other."""

    topic: str
    type: str
    log_time: int
    content: Any


class _Series(NamedTuple):
    """A topic's messages: times, positions or values, velocities, quaternions, and the frame."""

    times: Vector
    values: Matrix
    speeds: Matrix | None
    turns: Matrix | None
    is_in_body: bool


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
        If there is neither odometry nor a pose.
    """
    topics: dict[tuple[str, str], list[Message]] = {}
    for message in messages:
        topics.setdefault((message.topic, message.type), []).append(message)
    vehicles: dict[str, dict[tuple[str, str], _Series]] = {}
    for (topic, kind), found in sorted(topics.items()):
        space, leaf = _split(topic)
        vehicles.setdefault(space, {})[leaf, kind] = _series(found, kind)
    warnings: list[str] = []
    tracks = []
    for space, series in vehicles.items():
        track = _track(path, space or path.stem, series, warnings)
        if track is not None:
            tracks.append(track)
    if not tracks:
        kinds = " or ".join((_ODOMETRY, _POSE))
        raise refusal(path, f"holds no message of type {kinds}")
    return Recording(tuple(tracks), tuple(warnings))


def _split(topic: str) -> tuple[str, str]:
    """Return a topic's namespace and the rest."""
    space, _, leaf = topic.strip("/").partition("/")
    return (space, leaf) if leaf else ("", space)


def _series(messages: list[Message], kind: str) -> _Series:
    """Return a topic's messages as arrays, in the order of their stamps."""
    times = np.array([_stamp(message) for message in messages])
    order = np.argsort(times, kind="stable")
    contents = [messages[i].content for i in order]
    speeds = turns = None
    is_in_body = False
    if kind == _ODOMETRY:
        poses = [content.pose.pose for content in contents]
        values = np.array([_three(pose.position) for pose in poses])
        turns = np.array([_four(pose.orientation) for pose in poses])
        speeds = np.array([_three(content.twist.twist.linear) for content in contents])
        first = contents[0]
        is_in_body = first.child_frame_id not in {"", first.header.frame_id}
    elif kind == _POSE:
        values = np.array([_three(content.pose.position) for content in contents])
        turns = np.array([_four(content.pose.orientation) for content in contents])
    elif kind == _TWIST:
        values = np.array([_three(content.twist.linear) for content in contents])
        is_in_body = "base" in contents[0].header.frame_id or "body" in contents[0].header.frame_id
    else:
        values = np.array([_three(content.accel.linear) for content in contents])
    return _Series(times[order], values, speeds, turns, is_in_body)


def _stamp(message: Message) -> float:
    """Return when a message was made, or logged if it does not say [s]."""
    stamp = message.content.header.stamp
    seconds = float(stamp.sec) + 1e-9 * float(stamp.nanosec)
    return seconds if seconds > 0.0 else 1e-9 * message.log_time


def _three(vector: Any) -> list[float]:
    """Return a vector's parts."""
    return [float(vector.x), float(vector.y), float(vector.z)]


def _four(turn: Any) -> list[float]:
    """Return a quaternion's parts, x, y, z, w."""
    return [float(turn.x), float(turn.y), float(turn.z), float(turn.w)]


def _is_reference(leaf: str) -> bool:
    """Whether a topic says where a vehicle is to be."""
    return any(word in leaf.lower() for word in _REFERENCE)


def _track(
    path: Path, name: str, series: dict[tuple[str, str], _Series], warnings: list[str]
) -> Track | None:
    """Return one vehicle of a bag, None where its place is not told."""
    by_kind: dict[str, list[tuple[str, _Series]]] = {kind: [] for kind in TYPES}
    wanted: dict[str, list[tuple[str, _Series]]] = {kind: [] for kind in TYPES}
    for (leaf, kind), one in series.items():
        (wanted if _is_reference(leaf) else by_kind)[kind].append((leaf, one))
    places = [*by_kind[_ODOMETRY], *by_kind[_POSE]]
    if not places:
        return None
    (leaf, main), *others = places
    where = f"{path}: vehicle {name!r}"
    speeds = _speeds(main, by_kind[_TWIST], where, warnings)
    second = None
    for other_leaf, other in others:
        matched = _matched(other, main.times) if second is None else None
        if matched is not None and np.ptp(matched - main.values, axis=0).max() > 0.0:
            second = matched
            warnings.append(f"{where}: {other_leaf} is taken for another sensor beside {leaf}")
        else:
            warnings.append(f"{where}: {other_leaf} is not used beside {leaf}")
    references = _references(wanted, main.times)
    accelerations = [*wanted[_ACCEL], *by_kind[_ACCEL]][:1]
    controls = [held(one.times, one.values, main.times) for _, one in accelerations]
    found = Track(
        name, str(path), clock_of(path, main.times), main.times, main.values,
        speeds, controls[0] if controls else None, references, second,
    )  # fmt: skip
    return flat(found)


def _speeds(
    main: _Series, twists: list[tuple[str, _Series]], where: str, warnings: list[str]
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


def _misfit(main: _Series, speeds: Matrix) -> float:
    """Return how far velocities are from what the positions do [m²]."""
    seconds = np.diff(main.times)[:, None]
    told = 0.5 * (speeds[1:] + speeds[:-1]) * seconds
    return float(np.nansum((np.diff(main.values, axis=0) - told) ** 2)) + 1e-12


def _matched(other: _Series, times: Vector) -> Matrix | None:
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


def _references(wanted: dict[str, list[tuple[str, _Series]]], times: Vector) -> Matrix | None:
    """Return where the vehicle was to be, and how fast if that was logged."""
    for kind in (_ODOMETRY, _POSE):
        for _, one in wanted[kind][:1]:
            speeds = one.speeds
            if speeds is not None and one.is_in_body and one.turns is not None:
                speeds = _rotated(one.turns, speeds)
            rows = one.values if speeds is None else np.hstack([one.values, speeds])
            return interpolated(one.times, rows, times)
    return None
