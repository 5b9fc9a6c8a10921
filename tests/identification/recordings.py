"""Recordings of simulated flights, written by other people's software."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from mcap_ros2.writer import Writer as McapWriter
from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore

from radmpc.identification import Track

START = 1_760_000_000
"""Stamp of the first message [s since 1970]."""

STORE = get_typestore(Stores.ROS2_HUMBLE)
ODOMETRY, POSE, TWIST, ACCEL = (
    "nav_msgs/msg/Odometry",
    "geometry_msgs/msg/PoseStamped",
    "geometry_msgs/msg/TwistStamped",
    "geometry_msgs/msg/AccelStamped",
)


def of(kind: str, **parts: object) -> object:
    """Return a message."""
    return STORE.types[kind](**parts)


def vector(numbers: Sequence[float], kind: str = "Vector3") -> object:
    x, y, z = (*map(float, numbers), 0.0, 0.0)[:3]
    return of(f"geometry_msgs/msg/{kind}", x=x, y=y, z=z)


def stamped(time: float, frame: str = "map") -> object:
    stamp = of("builtin_interfaces/msg/Time", sec=START + int(time), nanosec=round(time % 1 * 1e9))
    return of("std_msgs/msg/Header", stamp=stamp, frame_id=frame)


def pose(position: Sequence[float], yaw: float = 0.0) -> object:
    turn = of("geometry_msgs/msg/Quaternion", x=0.0, y=0.0, z=np.sin(yaw / 2), w=np.cos(yaw / 2))
    return of("geometry_msgs/msg/Pose", position=vector(position, "Point"), orientation=turn)


def twist(velocity: Sequence[float]) -> object:
    return of("geometry_msgs/msg/Twist", linear=vector(velocity), angular=vector([0.0]))


def odometry(time: float, position: np.ndarray, velocity: np.ndarray, yaw: float,
             child: str = "base_link") -> object:  # fmt: skip
    """Return odometry with the velocity in the frame of the vehicle, as its definition asks."""
    back = np.array([[np.cos(yaw), np.sin(yaw)], [-np.sin(yaw), np.cos(yaw)]])
    inside = back @ velocity if child == "base_link" else velocity
    zeros = np.zeros(36)
    return of(
        ODOMETRY,
        header=stamped(time),
        child_frame_id=child,
        pose=of("geometry_msgs/msg/PoseWithCovariance", pose=pose(position, yaw), covariance=zeros),
        twist=of("geometry_msgs/msg/TwistWithCovariance", twist=twist(inside), covariance=zeros),
    )


def accelerations(track: Track) -> list[tuple[str, str, float, object]]:
    """Return the commands of a flight as messages: topic, type, time, content."""
    return [
        (f"/{track.name}/cmd_accel", ACCEL, time, of(
            ACCEL, header=stamped(time),
            accel=of("geometry_msgs/msg/Accel", linear=vector(u), angular=vector([0.0])),
        ))
        for time, u in zip(track.times, track.controls, strict=True)
    ]  # fmt: skip


def flown(track: Track, child: str = "base_link") -> list[tuple[str, str, float, object]]:
    """Return the odometry of a flight that turns as it goes."""
    return [
        (f"/{track.name}/odom", ODOMETRY, time, odometry(time, p, v, 0.3 * time, child))
        for time, p, v in zip(track.times, track.positions, track.velocities, strict=True)
    ]


def written(
    folder: Path, messages: Sequence[tuple[str, str, float, object]], storage: str = "sqlite3"
) -> Path:
    """Write a bag, messages by the time they were logged."""
    plugin = {"sqlite3": StoragePlugin.SQLITE3, "mcap": StoragePlugin.MCAP}[storage]
    with Writer(folder, version=9, storage_plugin=plugin) as bag:
        connections = {}
        for topic, kind, time, content in sorted(messages, key=lambda one: one[2]):
            if topic not in connections:
                connections[topic] = bag.add_connection(topic, kind, typestore=STORE)
            raw = STORE.serialize_cdr(content, kind)
            bag.write(connections[topic], int((START + time) * 1e9), raw)
    return folder


def written_poses(path: Path, track: Track) -> Path:
    """Write poses and twists as MCAP by its own library."""
    with path.open("wb") as file:
        writer = McapWriter(file)
        schemas = {}
        for kind in (POSE, TWIST):
            definition, _ = STORE.generate_msgdef(kind, ros_version=2)
            schemas[kind] = writer.register_msgdef(kind, definition)
        for time, p, v in zip(track.times, track.positions, track.velocities, strict=True):
            nanoseconds = int((START + time) * 1e9)
            header = {
                "stamp": {"sec": START + int(time), "nanosec": round(time % 1 * 1e9)},
                "frame_id": "map",
            }
            place = {"x": float(p[0]), "y": float(p[1]), "z": 0.0}
            turn = {"x": 0.0, "y": 0.0, "z": 0.0, "w": 1.0}
            speed = {"x": float(v[0]), "y": float(v[1]), "z": 0.0}
            still = {"x": 0.0, "y": 0.0, "z": 0.0}
            writer.write_message(
                "/pose", schemas[POSE],
                {"header": header, "pose": {"position": place, "orientation": turn}}, nanoseconds,
            )  # fmt: skip
            writer.write_message(
                "/twist", schemas[TWIST],
                {"header": header, "twist": {"linear": speed, "angular": still}}, nanoseconds,
            )  # fmt: skip
        writer.finish()
    return path
