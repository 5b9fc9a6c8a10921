"""MCAP with ROS 2 messages: a path per vehicle, obstacles as markers."""

from __future__ import annotations

import json
from importlib import import_module
from io import BytesIO
from typing import Any

import numpy as np

from radmpc.arrays import Matrix
from radmpc.errors import FileFormatError
from radmpc.io.export.job import Job
from radmpc.io.export.names import distinct, topic_part
from radmpc.io.export.outlines import triangles
from radmpc.io.export.ros2_definitions import (
    MARKERS,
    MARKERS_DEFINITION,
    PATH,
    PATH_DEFINITION,
)
from radmpc.io.export.statements import origin_sentence, risk_sentence, title
from radmpc.io.export.tracks import TimedPath, check_duration
from radmpc.model.obstacle import Obstacle

__all__ = ["FRAME", "OBSTACLE_TOPIC", "path_topics", "write_mcap"]

FRAME = "map"
OBSTACLE_TOPIC = "/radmpc/obstacles"

_LONGEST = 2.0**31 - 1.0
"""Longest mission [s]: a stamp's seconds are an int32."""

_TRIANGLES, _LINES, _BALLS = 11, 5, 7

_WALL_WIDTH = 0.05
"""Width that lines without one are drawn with [m]."""

_GRAY = {"r": 0.5, "g": 0.5, "b": 0.5, "a": 0.8}
_NO_TURN = {"x": 0.0, "y": 0.0, "z": 0.0, "w": 1.0}

Message = dict[str, Any]


def write_mcap(job: Job) -> bytes:
    """Return a plan as an MCAP recording.

    Parameters
    ----------
    job : Job
        The plan; where it has a place on earth, the metadata say it.

    Returns
    -------
    bytes
        Not compressed, so that they do not depend on a library's version. Time 0 is the start of
        the mission.

    Raises
    ------
    FileFormatError
        If the libraries are missing.
    ScenarioError
        If the mission lasts longer than stamps have seconds.
    """
    check_duration(job.plan, _LONGEST, "ROS 2 stamps")
    writer, buffer = _writer()
    paths = writer.register_msgdef(PATH, PATH_DEFINITION)
    markers = writer.register_msgdef(MARKERS, MARKERS_DEFINITION)
    topics = path_topics(job)
    for track in job.tracks:
        writer.write_message(topics[track.name], paths, _path(track, job.altitude), log_time=0)
    obstacles = job.plan.scenario.obstacles
    is_moving = any(obstacle.is_moving for obstacle in obstacles)
    for step in range(job.plan.scenario.horizon + 1 if is_moving else bool(obstacles)):
        time = step * job.plan.scenario.dt
        message = {"markers": _markers(job, step)}
        writer.write_message(OBSTACLE_TOPIC, markers, message, log_time=_nanoseconds(time))
    writer.add_metadata("radmpc", _metadata(job, topics))
    writer.finish()
    return buffer.getvalue()


def path_topics(job: Job) -> dict[str, str]:
    """Return the topic of every vehicle's path."""
    parts = distinct([track.name for track in job.tracks], topic_part)
    return {name: f"/radmpc/{part}/path" for name, part in parts.items()}


def _writer() -> tuple[Any, BytesIO]:
    """Return a writer of MCAP and what it writes into."""
    try:
        # Not by `import`: the libraries are optional, for the type checker too.
        writing = import_module("mcap_ros2.writer")
        container = import_module("mcap.writer")
    except ImportError as error:
        raise FileFormatError("format 'mcap' needs: pip install 'radmpc[mcap]'") from error
    buffer = BytesIO()
    return writing.Writer(buffer, compression=container.CompressionType.NONE), buffer


def _metadata(job: Job, topics: dict[str, str]) -> dict[str, str]:
    """Return what a reader must know."""
    content = {
        "title": title(job.plan),
        "risk": risk_sentence(job.plan, job.is_certified),
        "time": "stamps count from the start of the mission",
        "frame": f"{FRAME}: x east, y north, z up, in meters",
        "vehicles": json.dumps(topics),
    }
    if job.placement is not None:
        content["origin"] = origin_sentence(job.placement)
    if job.note is not None:
        content["steps"] = job.note
    return content


def _path(track: TimedPath, altitude: float) -> Message:
    """Return a track as a path; poses are not turned: a plan has no headings."""
    poses = [
        {"header": _header(time), "pose": {"position": point, "orientation": _NO_TURN}}
        for time, point in zip(
            track.times.tolist(), _points(track.positions, altitude), strict=True
        )
    ]
    return {"header": _header(0.0), "poses": poses}


def _markers(job: Job, step: int) -> list[Message]:
    """Return the obstacles at a step."""
    return [
        _marker(number, obstacle, step, job)
        for number, obstacle in enumerate(job.plan.scenario.obstacles)
    ]


def _marker(number: int, obstacle: Obstacle, step: int, job: Job) -> Message:
    """Return an obstacle as triangles; a wall or wire as lines, a post as a ball."""
    pieces = obstacle.at(step)
    corners = [triangles(piece) for piece in pieces]
    kind, width = _TRIANGLES, 1.0
    if not any(len(found) for found in corners):
        corners = [piece.vertices for piece in pieces]
        kind = _BALLS if len(corners[0]) == 1 else _LINES
        width = _WALL_WIDTH
    return {
        "header": _header(step * job.plan.scenario.dt),
        "ns": "obstacles",
        "id": number,
        "type": kind,
        "action": 0,
        "pose": {"position": {"x": 0.0, "y": 0.0, "z": 0.0}, "orientation": _NO_TURN},
        "scale": {"x": width, "y": width, "z": width},
        "color": _GRAY,
        "lifetime": {"sec": 0, "nanosec": 0},
        "frame_locked": False,
        "points": _points(np.concatenate(corners), job.altitude),
        "colors": [],
        "texture_resource": "",
        "texture": {"header": _header(0.0), "format": "", "data": b""},
        "uv_coordinates": [],
        "text": obstacle.name,
        "mesh_resource": "",
        "mesh_file": {"filename": "", "data": b""},
        "mesh_use_embedded_materials": False,
    }


def _header(time: float) -> Message:
    """Return a header at a time [s]."""
    seconds, rest = divmod(_nanoseconds(time), 1_000_000_000)
    return {"stamp": {"sec": seconds, "nanosec": rest}, "frame_id": FRAME}


def _nanoseconds(time: float) -> int:
    """Return a time [s] in whole nanoseconds."""
    return round(time * 1e9)


def _points(points: Matrix, altitude: float) -> list[Message]:
    """Return points as messages, those of a plane at a height."""
    if points.shape[1] == 2:
        points = np.column_stack([points, np.full(len(points), altitude)])
    return [{"x": x, "y": y, "z": z} for x, y, z in points.tolist()]
