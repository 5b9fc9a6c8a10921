from __future__ import annotations

import json
import re
import socket
import time
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from exported_plans import (
    FLIGHT,
    HARBOR,
    ORIGIN,
    assert_at,
    back,
    contents,
    means,
    plan_of,
    renamed,
    written,
)

from radmpc.io.export.mission import Stop, stops
from radmpc.model.plan import Plan

WAYPOINT, CHANGE_SPEED = 16, 178
MISSION, RELATIVE = 2, 3


def lines(content: bytes) -> list[list[str]]:
    """The items of a waypoint file, home first."""
    rows = content.decode("utf-8").splitlines()
    return [row.split("\t") for row in rows[1:] if not row.startswith("#")]


def assert_flies(items: list[Any], plan: Plan, name: str) -> None:
    """Fly MAVLink items at the speeds they set; compare places and times with the plan."""
    positions, dt = means(plan, name), plan.scenario.dt
    clock, speed, here = 0.0, None, None
    reached = []
    for item in items:
        if item.command == CHANGE_SPEED:
            assert item.param1 == 1.0
            speed = item.param2
            continue
        assert item.command == WAYPOINT
        assert item.frame == RELATIVE
        there = np.array([item.x, item.y, item.z + ORIGIN.height])
        (local,) = back(there[None])
        if here is not None:
            clock += float(np.linalg.norm(local - here)) / speed
        step = round(clock / dt)
        assert clock == pytest.approx(step * dt, abs=0.01)
        assert_at([there], positions[step : step + 1])
        reached.append(step)
        clock += item.param1
        here = local
    assert clock == pytest.approx(plan.scenario.horizon * dt, abs=0.01)
    assert reached[0] == 0


# --- the steps that become waypoints


def test_every_step_of_a_moving_vehicle_is_a_waypoint_with_the_speed_of_its_leg() -> None:
    chosen = stops(np.array([0.0, 2.0, 4.0]), np.array([[0.0, 0.0], [3.0, 4.0], [3.0, 6.0]]))
    assert chosen == (Stop(0, None, 0.0), Stop(1, 2.5, 0.0), Stop(2, 1.0, 0.0))


def test_a_stay_becomes_a_wait() -> None:
    positions = np.array([[0.0, 0.0], [0.0, 0.0], [1.0, 0.0], [1.0, 0.0], [1.0, 0.0]])
    chosen = stops(np.arange(5.0), positions)
    assert chosen == (Stop(0, None, 1.0), Stop(2, 1.0, 2.0))


def test_a_vehicle_that_never_moves_waits_all_the_time() -> None:
    assert stops(np.arange(4.0), np.zeros((4, 3))) == (Stop(0, None, 3.0),)


def test_fine_steps_are_joined_without_losing_time() -> None:
    times = 0.01 * np.arange(101)
    positions = np.column_stack([0.004 * np.arange(101), np.zeros(101)])
    chosen = stops(times, positions)
    assert all(stop.speed == pytest.approx(0.4) for stop in chosen[1:])
    duration = chosen[-1].wait
    for before, stop in pairwise(chosen):
        assert before.wait == 0.0
        duration += 0.004 * (stop.step - before.step) / (stop.speed or 1.0)
    assert duration == pytest.approx(1.0)


# --- ArduPilot's text


def test_waypoint_files_have_home_first_and_twelve_columns() -> None:
    for content in contents(plan_of(HARBOR), "waypoints").values():
        assert content.startswith(b"QGC WPL 110\n# ")
        rows = lines(content)
        assert all(len(row) == 12 for row in rows)
        assert [int(row[0]) for row in rows] == list(range(len(rows)))
        assert [row[1] for row in rows] == ["1"] + ["0"] * (len(rows) - 1)
        assert rows[0][2:4] == ["0", "16"]
        assert float(rows[0][10]) == ORIGIN.height
        kinds = [(int(row[2]), int(row[3])) for row in rows[1:]]
        # Before each leg its speed.
        legs = [(MISSION, CHANGE_SPEED), (RELATIVE, WAYPOINT)] * ((len(kinds) - 1) // 2)
        assert kinds == [(RELATIVE, WAYPOINT), *legs]


def test_waypoint_files_say_what_they_lose_and_what_altitudes_mean() -> None:
    text = contents(plan_of(HARBOR), "waypoints")["fleet.tug.waypoints"].decode()
    for expected in (
        "# plan of wide harbor, vehicle tug",
        "at most 0.04, risk bound 0.05",
        "# waypoints carry no time: the risk bound 0.05 holds only if all vehicles keep the",
        "above home (frame 3)",
        "latitude 54.1234, longitude 12.0987, 38.25 m above the WGS84 ellipsoid",
    ):
        assert expected in text


def test_a_name_cannot_smuggle_lines_into_a_waypoint_file() -> None:
    name = "x\u20281 0 3 16 0 0 0 0 1 1 1 1\u2029#"
    plan = plan_of(HARBOR)
    plain, *_ = contents(plan, "waypoints").values()
    evil, *_ = contents(renamed(plan, "tug", name), "waypoints").values()
    assert lines(evil) == lines(plain)


@pytest.mark.filterwarnings("ignore")  # of the library's own
@pytest.mark.parametrize("content", [HARBOR, FLIGHT], ids=["harbor", "flight"])
def test_pymavlink_loads_waypoint_files(content: dict[str, Any], tmp_path: Path) -> None:
    mavwp = pytest.importorskip("pymavlink.mavwp")
    plan = plan_of(content)
    files = written(plan, "waypoints", tmp_path)
    for vehicle, file in zip(plan.scenario.vehicles, files, strict=True):
        loader = mavwp.MAVWPLoader()
        assert loader.load(str(file)) == len(lines(file.read_bytes()))
        home, *items = loader.wpoints
        assert home.frame == 0
        assert_at([[home.x, home.y, home.z]], means(plan, vehicle.name)[:1, :2])
        assert_flies(items, plan, vehicle.name)


# --- QGroundControl's plans


def test_qgc_plans_have_what_qgroundcontrol_requires() -> None:
    files = contents(plan_of(HARBOR), "qgc")
    assert list(files) == ["fleet.tug.qgc", "fleet.pilot_7.qgc"]
    content = json.loads(files["fleet.tug.qgc"])
    assert content["fileType"] == "Plan"
    assert content["version"] == 1
    assert content["geoFence"] == {"circles": [], "polygons": [], "version": 2}
    assert content["rallyPoints"] == {"points": [], "version": 2}
    mission = content["mission"]
    assert mission["version"] == 2
    assert (mission["firmwareType"], mission["vehicleType"]) == (0, 0)
    assert mission["plannedHomePosition"][2] == ORIGIN.height
    for number, item in enumerate(mission["items"], start=1):
        assert item["type"] == "SimpleItem"
        assert item["doJumpId"] == number
        assert len(item["params"]) == 7
        if item["command"] == WAYPOINT:
            assert item["AltitudeMode"] == 1
            assert item["frame"] == RELATIVE
            assert item["Altitude"] == item["params"][6] == 0.0
            assert item["params"][3] is None


def test_qgc_plans_say_what_they_lose_and_what_altitudes_mean() -> None:
    note = json.loads(contents(plan_of(FLIGHT), "qgc")["fleet.qgc"])["radmpc"]
    assert re.search("0.01 holds only if the vehicle keeps the plan's timing", note["timing"])
    assert "above home" in note["altitude"]
    assert "WGS84" in note["origin"]
    assert note["times"] == [0.0, 2.5, 5.0, 7.5, 10.0, 12.5]


@pytest.mark.parametrize("altitude", [0.0, 15.5])
def test_a_plan_in_the_plane_keeps_one_altitude(altitude: float) -> None:
    for content in contents(plan_of(HARBOR), "qgc", altitude=altitude).values():
        items = json.loads(content)["mission"]["items"]
        assert {i["Altitude"] for i in items if i["command"] == WAYPOINT} == {altitude}


def test_a_plan_in_space_keeps_its_heights() -> None:
    plan = plan_of(FLIGHT)
    items = json.loads(contents(plan, "qgc")["fleet.qgc"])["mission"]["items"]
    heights = [item["Altitude"] for item in items if item["command"] == WAYPOINT]
    # Near the origin the earth is flat.
    assert heights == pytest.approx(means(plan, "scout")[:, 2].tolist(), abs=0.001)


# --- a mission server


class Autopilot:
    """MAVSDK twice in this process: a mission server, and a ground station that talks to it."""

    def __init__(self) -> None:
        """Connect the two over the loopback."""
        library = pytest.importorskip("mavsdk.mavsdk")
        kinds = pytest.importorskip("mavsdk.component_type").ComponentType
        raw = pytest.importorskip("mavsdk.plugins.mission_raw.mission_raw")
        serving = pytest.importorskip("mavsdk.plugins.mission_raw_server.mission_raw_server")
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
            probe.bind(("127.0.0.1", 0))
            port = probe.getsockname()[1]
        make = library.Configuration.create_with_component_type
        self.vehicle = library.Mavsdk(make(kinds.AUTOPILOT))
        self.station = library.Mavsdk(make(kinds.GROUND_STATION))
        self.vehicle.add_any_connection(f"udpin://127.0.0.1:{port}")
        self.server = serving.MissionRawServer(self.vehicle.server_component())
        self.received: list[Any] = []
        self.server.subscribe_incoming_mission(self._receive)
        self.station.add_any_connection(f"udpout://127.0.0.1:{port}")
        system = self.station.first_autopilot(20.0)
        assert system is not None
        self.missions = raw.MissionRaw(system)

    def _receive(self, _result: Any, mission: Any, *_rest: Any) -> None:
        """Note what the vehicle was given."""
        self.received.append(mission.mission_items)

    def close(self) -> None:
        """End both."""
        self.station.destroy()
        self.vehicle.destroy()


@pytest.fixture(scope="module")
def autopilot() -> Iterator[Autopilot]:
    """A vehicle that takes missions."""
    vehicle = Autopilot()
    yield vehicle
    vehicle.close()


class Degrees:
    """A mission item of MAVSDK with places in degrees."""

    def __init__(self, item: Any) -> None:
        """Keep the item's fields."""
        self.command, self.frame = item.command, item.frame
        self.param1, self.param2 = item.param1, item.param2
        self.x, self.y, self.z = item.x * 1e-7, item.y * 1e-7, item.z


def key(item: Any) -> tuple[Any, ...]:
    """What a mission item says; NaN is equal to NaN."""
    yaw = None if np.isnan(item.param4) else item.param4
    head = (item.seq, item.frame, item.command, item.autocontinue)
    return (*head, item.param1, item.param2, item.param3, yaw, item.x, item.y, item.z)


def assert_carried(autopilot: Autopilot, items: list[Any]) -> list[Any]:
    """Upload items, and return what comes down again and what the vehicle saw, both the same."""
    before = len(autopilot.received)
    autopilot.missions.upload_mission(items)
    down = autopilot.missions.download_mission()
    deadline = time.monotonic() + 5.0
    while len(autopilot.received) == before and time.monotonic() < deadline:
        time.sleep(0.01)
    assert [key(item) for item in down] == [key(item) for item in items]
    assert [key(item) for item in autopilot.received[-1]] == [key(item) for item in items]
    return down


@pytest.mark.slow
@pytest.mark.parametrize("content", [HARBOR, FLIGHT], ids=["harbor", "flight"])
def test_mavsdk_imports_qgc_plans_and_a_vehicle_takes_them(
    content: dict[str, Any], tmp_path: Path, autopilot: Autopilot
) -> None:
    plan = plan_of(content)
    for vehicle, file in zip(plan.scenario.vehicles, written(plan, "qgc", tmp_path), strict=True):
        imported = autopilot.missions.import_qgroundcontrol_mission(str(file))
        assert imported.geofence_items == imported.rally_items == []
        down = assert_carried(autopilot, imported.mission_items)
        assert_flies([Degrees(item) for item in down], plan, vehicle.name)


def test_mavsdk_imports_waypoint_files_with_their_comments(
    tmp_path: Path, autopilot: Autopilot
) -> None:
    plan = plan_of(HARBOR)
    for vehicle, file in zip(
        plan.scenario.vehicles, written(plan, "waypoints", tmp_path), strict=True
    ):
        imported = autopilot.missions.import_mission_planner_mission(str(file))
        home, *items = imported.mission_items
        assert home.frame == 0
        assert home.z == ORIGIN.height
        assert_flies([Degrees(item) for item in items], plan, vehicle.name)
