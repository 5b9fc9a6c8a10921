from __future__ import annotations

import json
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from exported_plans import FLIGHT, HARBOR, contents, means, plan_of, renamed, written

from radmpc.errors import FileFormatError
from radmpc.io.export import ros2
from radmpc.io.export.ros2_definitions import MARKERS, MARKERS_DEFINITION, PATH, PATH_DEFINITION

OBSTACLES = "/radmpc/obstacles"


@pytest.fixture(autouse=True)
def library(request: pytest.FixtureRequest) -> None:
    """Skip what needs the optional library where it is missing."""
    if request.node.name != test_without_the_library_one_line_says_what_to_install.__name__:
        pytest.importorskip("mcap_ros2")


def point(message: Any) -> tuple[float, float, float]:
    """The coordinates of a point."""
    return (message.x, message.y, message.z)


def assert_path(message: Any, positions: np.ndarray, dt: float, height: float) -> None:
    """Compare a path with a vehicle's means."""
    assert message.header.frame_id == "map"
    expected = positions
    if positions.shape[1] == 2:
        expected = np.column_stack([positions, np.full(len(positions), height)])
    found = [point(pose.pose.position) for pose in message.poses]
    assert np.abs(np.array(found) - expected).max() < 1e-9
    for step, pose in enumerate(message.poses):
        assert pose.header.frame_id == "map"
        stamp = pose.header.stamp
        assert stamp.sec + 1e-9 * stamp.nanosec == pytest.approx(step * dt, abs=1e-9)
        turn = pose.pose.orientation
        assert (turn.x, turn.y, turn.z, turn.w) == (0.0, 0.0, 0.0, 1.0)


@pytest.mark.parametrize("content", [HARBOR, FLIGHT], ids=["harbor", "flight"])
def test_the_ros2_reader_of_mcap_finds_every_path(content: dict[str, Any]) -> None:
    reading = pytest.importorskip("mcap_ros2.reader")
    plan = plan_of(content)
    data = contents(plan, "mcap", **({"altitude": 2.5} if content is HARBOR else {}))["fleet.mcap"]
    paths = {
        message.channel.topic: (message.log_time_ns, message.ros_msg)
        for message in reading.read_ros2_messages(BytesIO(data))
        if message.schema.name == PATH
    }
    topics = {"tug": "tug", "pilot 7": "pilot_7", "scout": "scout"}
    assert len(paths) == plan.scenario.num_vehicles
    for vehicle in plan.scenario.vehicles:
        time, message = paths[f"/radmpc/{topics[vehicle.name]}/path"]
        assert time == 0
        assert_path(message, means(plan, vehicle.name), plan.scenario.dt, 2.5)


@pytest.mark.parametrize("content", [HARBOR, FLIGHT], ids=["harbor", "flight"])
def test_rosbags_reads_paths_and_markers(content: dict[str, Any], tmp_path: Path) -> None:
    highlevel = pytest.importorskip("rosbags.highlevel")
    plan = plan_of(content)
    (file,) = written(plan, "mcap", tmp_path)
    paths, markers = [], []
    with highlevel.AnyReader([file]) as reader:
        for connection, time, raw in reader.messages():
            message = reader.deserialize(raw, connection.msgtype)
            if connection.topic == OBSTACLES:
                markers.append((time, message.markers))
            else:
                paths.append(message)
    for vehicle, message in zip(plan.scenario.vehicles, paths, strict=True):
        assert_path(message, means(plan, vehicle.name), plan.scenario.dt, 0.0)
    steps = plan.scenario.horizon + 1 if content is HARBOR else 1
    assert [time for time, _ in markers] == [
        round(step * plan.scenario.dt * 1e9) for step in range(steps)
    ]
    for _, group in markers:
        assert [marker.text for marker in group] == [o.name for o in plan.scenario.obstacles]
        assert [marker.id for marker in group] == list(range(len(group)))
        assert all(marker.header.frame_id == "map" for marker in group)
        assert all(marker.type == 11 for marker in group)


def test_markers_cover_the_obstacles(tmp_path: Path) -> None:
    reading = pytest.importorskip("mcap_ros2.reader")
    data = contents(plan_of(HARBOR), "mcap")["fleet.mcap"]
    first = next(
        m.ros_msg for m in reading.read_ros2_messages(BytesIO(data)) if m.channel.topic == OBSTACLES
    )
    areas = []
    for marker in first.markers:
        corners = np.array([point(p) for p in marker.points]).reshape(-1, 3, 3)
        sides = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        assert (sides[:, 2] > 0.0).all()
        areas.append(0.5 * sides[:, 2].sum())
    assert areas == pytest.approx([900 * 300 + 600 * 300, 200 * 400, 0.5 * 90 * 100])


def test_markers_in_space_enclose_the_obstacles() -> None:
    reading = pytest.importorskip("mcap_ros2.reader")
    data = contents(plan_of(FLIGHT), "mcap")["fleet.mcap"]
    (message,) = [
        m.ros_msg for m in reading.read_ros2_messages(BytesIO(data)) if m.channel.topic == OBSTACLES
    ]
    volumes = []
    for marker in message.markers:
        a, b, c = np.array([point(p) for p in marker.points]).reshape(-1, 3, 3).transpose(1, 0, 2)
        # Positive only if all triangles are seen counter-clockwise from outside.
        volumes.append(float(np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6.0))
    assert volumes == pytest.approx([40 * 50 * 80, 10 * 10 * 60 / 6.0])


def test_metadata_say_what_is_certified_and_whose_topics_are_whose() -> None:
    reading = pytest.importorskip("mcap.reader")
    data = contents(plan_of(HARBOR), "mcap")["fleet.mcap"]
    (record,) = reading.make_reader(BytesIO(data)).iter_metadata()
    assert record.name == "radmpc"
    assert "at most 0.04, risk bound 0.05" in record.metadata["risk"]
    assert "east" in record.metadata["frame"]
    assert "latitude 54.1234" in record.metadata["origin"]
    topics = json.loads(record.metadata["vehicles"])
    assert topics == {"tug": "/radmpc/tug/path", "pilot 7": "/radmpc/pilot_7/path"}


def test_no_place_on_earth_is_needed() -> None:
    reading = pytest.importorskip("mcap.reader")
    data = contents(plan_of(HARBOR), "mcap", origin=None)["fleet.mcap"]
    (record,) = reading.make_reader(BytesIO(data)).iter_metadata()
    assert "origin" not in record.metadata


def test_topics_are_valid_and_distinct_whatever_the_names() -> None:
    reading = pytest.importorskip("mcap.reader")
    plan = renamed(renamed(plan_of(HARBOR), "tug", "7__ä"), "pilot 7", "7-\u00fc")
    summary = reading.make_reader(BytesIO(contents(plan, "mcap")["fleet.mcap"])).get_summary()
    assert {channel.topic for channel in summary.channels.values()} == {
        "/radmpc/vehicle_7/path",
        "/radmpc/vehicle_7_2/path",
        OBSTACLES,
    }


def test_the_definitions_are_those_of_current_ros() -> None:
    typesys = pytest.importorskip("rosbags.typesys")
    for name, text in ((PATH, PATH_DEFINITION), (MARKERS, MARKERS_DEFINITION)):
        own = typesys.get_typestore(typesys.Stores.EMPTY)
        own.register(typesys.get_types_from_msg(text, name))
        for store in (typesys.Stores.ROS2_HUMBLE, typesys.Stores.ROS2_JAZZY):
            assert own.hash_rihs01(name) == typesys.get_typestore(store).hash_rihs01(name)


def test_without_the_library_one_line_says_what_to_install(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def missing(name: str) -> None:
        raise ModuleNotFoundError(name)

    monkeypatch.setattr(ros2, "import_module", missing)
    with pytest.raises(FileFormatError) as caught:
        contents(plan_of(HARBOR), "mcap")
    assert str(caught.value) == "format 'mcap' needs: pip install 'radmpc[mcap]'"
