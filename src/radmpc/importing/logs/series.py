"""Topics of ROS 2 as arrays, in the order of their messages' stamps."""

from __future__ import annotations

from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from radmpc.arrays import Matrix, Vector
from radmpc.importing.logs.recording import EPOCH, refusal

__all__ = ["ACCEL", "ODOMETRY", "POSE", "TWIST", "TYPES", "Message", "Series", "series_of"]

ODOMETRY, POSE, TWIST, ACCEL = (
    "nav_msgs/msg/Odometry",
    "geometry_msgs/msg/PoseStamped",
    "geometry_msgs/msg/TwistStamped",
    "geometry_msgs/msg/AccelStamped",
)
TYPES = (ODOMETRY, POSE, TWIST, ACCEL)
"""Types of messages that are read."""

_LATE = 10
"""Median periods [-] that a stamp must go back, and messages that must follow before the clock is
where it was: then it was set back. A single message may be late."""


class Message(NamedTuple):
    """A message: its topic, type, time of logging [ns] and content, and no other."""

    topic: str
    type: str
    log_time: int
    content: Any


class Series(NamedTuple):
    """A topic's messages: times, positions or values, velocities, quaternions, and the frame."""

    times: Vector
    values: Matrix
    speeds: Matrix | None
    turns: Matrix | None
    is_in_body: bool


def series_of(path: Path, messages: list[Message]) -> Series:
    """Return a topic's messages as arrays, in the order of their stamps.

    Parameters
    ----------
    path : Path
        The bag.
    messages : list of Message
        Of one topic and type, as they were logged; at least one.

    Raises
    ------
    FileFormatError
        If its clock starts again.
    """
    kind, times = messages[0].type, _stamps(messages)
    _check_clock(path, messages[0].topic, times)
    order = np.argsort(times, kind="stable")
    contents = [messages[i].content for i in order]
    speeds = turns = None
    is_in_body = False
    if kind == ODOMETRY:
        poses = [content.pose.pose for content in contents]
        values = np.array([_three(pose.position) for pose in poses])
        turns = np.array([_four(pose.orientation) for pose in poses])
        speeds = np.array([_three(content.twist.twist.linear) for content in contents])
        first = contents[0]
        is_in_body = first.child_frame_id not in {"", first.header.frame_id}
    elif kind == POSE:
        values = np.array([_three(content.pose.position) for content in contents])
        turns = np.array([_four(content.pose.orientation) for content in contents])
    elif kind == TWIST:
        values = np.array([_three(content.twist.linear) for content in contents])
        is_in_body = "base" in contents[0].header.frame_id or "body" in contents[0].header.frame_id
    else:
        values = np.array([_three(content.accel.linear) for content in contents])
    return Series(times[order], values, speeds, turns, is_in_body)


def _stamps(messages: list[Message]) -> Vector:
    """Return when messages were made, or logged if they do not say [s]."""
    headers = [message.content.header.stamp for message in messages]
    stamps = np.array([float(one.sec) + 1e-9 * float(one.nanosec) for one in headers])
    is_told = stamps > 0.0
    # The clock of a simulator begins at zero, where those of the world never are.
    if is_told.any() and stamps[is_told].min() < EPOCH:
        return stamps
    logged = np.array([1e-9 * message.log_time for message in messages])
    return np.where(is_told, stamps, logged)


def _check_clock(path: Path, topic: str, times: Vector) -> None:
    """Refuse stamps that go far back and on from there: sorted, two runs would be mixed."""
    if len(times) <= _LATE:
        return
    steps = np.diff(times)
    latest = np.maximum.accumulate(times)
    for k in np.flatnonzero(steps < -_LATE * np.median(np.abs(steps))):
        following = times[k + 1 : k + 1 + _LATE]
        if len(following) == _LATE and following.max() < latest[k]:
            raise refusal(
                path,
                f"{topic}: stamps run backwards at message {k + 2}: {_text(times[k + 1])} s after "
                f"{_text(times[k])} s; are these two runs in one?",
            )


def _text(time: float) -> str:
    """Return a time in as few digits as tell it from all others."""
    return repr(float(time))


def _three(vector: Any) -> list[float]:
    """Return a vector's parts."""
    return [float(vector.x), float(vector.y), float(vector.z)]


def _four(turn: Any) -> list[float]:
    """Return a quaternion's parts, x, y, z, w."""
    return [float(turn.x), float(turn.y), float(turn.z), float(turn.w)]
