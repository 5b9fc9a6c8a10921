"""Logs in the formats of other software, written by that software."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest

from radmpc.errors import ArgumentTypeError, FileFormatError, ScenarioError
from radmpc.identification import Track, identify
from radmpc.importing.logs.reading import read_logs
from simulator import Truth, as_csv, fly

from .recordings import (
    ODOMETRY,
    POSE,
    START,
    accelerations,
    flown,
    odometry,
    of,
    pose,
    stamped,
    written,
    written_poses,
)

PX4 = Path(__file__).parent.parent / "data" / "logs" / "px4.ulg"
"""The positions and setpoints of a flight in PX4's own simulator, from pyulog's tests."""

HEAD = "time,vehicle,x,y,vx,vy\n"


def csv(folder: Path, text: str, name: str = "log.csv") -> Path:
    path = folder / name
    path.write_text(text, encoding="utf-8")
    return path


def assert_same(read: Track, track: Track, start: float = 0.0, close: float = 1e-6) -> None:
    """Compare what was read with what was written."""
    assert read.parts() == track.parts()
    np.testing.assert_allclose(read.times - start, track.times, atol=1e-6)
    for name in track.parts():
        np.testing.assert_allclose(getattr(read, name), getattr(track, name), atol=close)


@pytest.mark.parametrize("log", ["commands", "references", "both", "states"])
def test_csv_is_read_as_it_was_written(tmp_path: Path, log: str) -> None:
    tracks = fly(Truth(steps=20, vehicles=2), 1, log)
    found = read_logs([csv(tmp_path, as_csv(tracks))])
    assert [track.name for track in found.tracks] == ["v1", "v2"]
    for read, track in zip(found.tracks, tracks, strict=True):
        assert_same(read, track)


def test_csv_in_space_is_read(tmp_path: Path) -> None:
    tracks = fly(Truth(steps=20, dimension=3), 1)
    [read] = read_logs([csv(tmp_path, as_csv(tracks))]).tracks
    assert_same(read, tracks[0])


def test_columns_may_be_called_anything(tmp_path: Path) -> None:
    path = csv(tmp_path, "t;east;north;mode\n0;1;2;3\n1;2;4;3\n", "tug.csv")
    found = read_logs([path], {"time": "t", "x": "east", "y": "north"})
    [track] = found.tracks
    assert track.name == "tug"
    assert track.positions.tolist() == [[1.0, 2.0], [2.0, 4.0]]
    assert found.warnings == (f"{path}: columns ignored: mode",)


def test_cells_that_say_nothing_are_no_numbers(tmp_path: Path) -> None:
    [track] = read_logs([csv(tmp_path, f"{HEAD}0,a,1,2,,nan\n\n1,a,2,NA,0,0\n")]).tracks
    assert np.isnan(track.velocities[0]).all()
    assert np.isnan(track.positions[1, 1])


@pytest.mark.parametrize(
    "text",
    [
        "\n\r\n" + f"{HEAD}0,a,1,2,3,4\n\n1,a,2,3,4,5\n",
        HEAD.upper() + "0,a,1,2,3,4\n1,a,2,3,4,5\n",
        f"{HEAD.strip()},\n0,a,1,2,3,4,\n1,a,2,3,4,5,\n",
    ],
    ids=["blank lines", "capitals", "delimiters at the ends"],
)
def test_csv_may_look_a_little_different(tmp_path: Path, text: str) -> None:
    found = read_logs([csv(tmp_path, text)])
    assert found.warnings == ()
    [track] = found.tracks
    assert track.velocities.tolist() == [[3.0, 4.0], [4.0, 5.0]]


def test_lines_are_counted_as_the_file_has_them(tmp_path: Path) -> None:
    with pytest.raises(FileFormatError, match="line 4: x must be a number"):
        read_logs([csv(tmp_path, f"\n\n{HEAD}0,a,one,2,3,4\n")])


def test_a_column_stands_for_one_thing(tmp_path: Path) -> None:
    path = csv(tmp_path, "t,east\n0,1\n")
    message = "columns: must name every column once, got 'east' for x and for y"
    with pytest.raises(ScenarioError, match=message):
        read_logs([path], {"time": "t", "x": "east", "y": "east"})
    with pytest.raises(ScenarioError, match="got 'y' for x and for y"):
        read_logs([csv(tmp_path, "time,y\n0,1\n")], {"x": "y"})


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "is empty"),
        (HEAD, "has a header and no row"),
        ("time,vehicle,x\n0,a,1\n", "has no column 'y' for y"),
        (
            "t,east,y\n0,1,2\n",
            "has no column 'time' for time: name it by columns={'time': NAME, 'x': NAME}; there",
        ),
        ("time,x,y,x\n0,1,2,3\n", "has two columns 'x'"),
        ("time,x,y,vx\n0,1,2,3\n", "has vx, but no column 'vy'"),
        ("time,x,y,vy\n0,1,2,3\n", "has vy, but not vx"),
        ("time,x,y,vx,vy,vz\n0,1,2,3,4,5\n", "has a column 'vz', but no column 'z'"),
        (f"{HEAD}0,a,1,2,3\n", "line 2: has 5 cells, the header 6"),
        (f"{HEAD}0,a,1,2,3,4\n1,a,1,two,3,4\n", "line 3: y must be a number, got 'two'"),
        (f"{HEAD}0,a,1,2,3,4\n1,,1,2,3,4\n", "line 3: has no name of a vehicle"),
        (
            "0.0,a,1,2\n0.5,a,1,2\n",
            "begins with numbers: its first line must name columns: time, x, y",
        ),
    ],
)
def test_a_broken_csv_is_one_line(tmp_path: Path, text: str, message: str) -> None:
    path = csv(tmp_path, text)
    with pytest.raises(FileFormatError) as caught:
        read_logs([path])
    assert str(caught.value).startswith(f"{path}: ")
    assert message in str(caught.value)
    assert "\n" not in str(caught.value)


def test_columns_that_are_not_known_are_refused(tmp_path: Path) -> None:
    path = csv(tmp_path, f"{HEAD}0,a,1,2,3,4\n")
    with pytest.raises(ScenarioError, match="columns: must name some of time, vehicle, x"):
        read_logs([path], {"speed": "v"})
    with pytest.raises(FileFormatError, match="has no column 'when' for time"):
        read_logs([path], {"time": "when"})
    with pytest.raises(ScenarioError, match="columns: is for CSV, and no log is"):
        read_logs([PX4], {"time": "t"})


@pytest.mark.parametrize("name", ["log.mcap", "log.ulg", "bag", "log.db3", "log.csv"])
def test_a_log_that_is_not_there_is_one_line(tmp_path: Path, name: str) -> None:
    if name == "log.ulg":
        pytest.importorskip("pyulog")
    if name == "bag":
        (tmp_path / name).mkdir()
    with pytest.raises(FileFormatError, match=r"No such file|no metadata\.yaml") as caught:
        read_logs([tmp_path / name])
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("name", ["log.mcap", "log.ulg"])
def test_rubbish_is_refused_in_one_line(tmp_path: Path, name: str) -> None:
    if name == "log.ulg":
        pytest.importorskip("pyulog")
    with pytest.raises(FileFormatError, match="cannot be read as") as caught:
        read_logs([csv(tmp_path, "rubbish " * 20, name)])
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("name", ["log.bag", "log.xlsx", "log"])
def test_other_formats_are_refused(tmp_path: Path, name: str) -> None:
    with pytest.raises(FileFormatError, match=r"ROS 1 bag|must end in \.csv"):
        read_logs([csv(tmp_path, "x", name)])


def test_a_log_is_a_path() -> None:
    with pytest.raises(ArgumentTypeError):
        read_logs([3])


@pytest.mark.parametrize("storage", ["sqlite3", "mcap"])
def test_bags_of_either_storage_are_read(tmp_path: Path, storage: str) -> None:
    tracks = fly(Truth(steps=60, vehicles=2), 2)
    messages = [one for track in tracks for one in (*flown(track), *accelerations(track))]
    found = read_logs([written(tmp_path / "bag", messages, storage)])
    assert [track.name for track in found.tracks] == ["v1", "v2"]
    assert found.warnings == ()
    for read, track in zip(found.tracks, tracks, strict=True):
        assert_same(read, track, START)
        assert read.clock == "since 1970"


def test_a_file_of_a_bag_stands_for_it(tmp_path: Path) -> None:
    [track] = fly(Truth(steps=20), 2)
    folder = written(tmp_path / "bag", [*flown(track), *accelerations(track)])
    [read] = read_logs([next(folder.glob("*.db3"))]).tracks
    assert_same(read, track, START)


def test_the_mcap_file_of_a_bag_is_read_by_itself(tmp_path: Path) -> None:
    [track] = fly(Truth(steps=20), 2)
    folder = written(tmp_path / "bag", [*flown(track), *accelerations(track)], "mcap")
    [read] = read_logs([next(folder.glob("*.mcap"))]).tracks
    assert_same(read, track, START)


def test_poses_and_twists_in_mcap_are_brought_together(tmp_path: Path) -> None:
    [track] = fly(Truth(steps=30), 3, "states")
    [read] = read_logs([written_poses(tmp_path / "tug.mcap", track)]).tracks
    assert read.name == "tug"
    assert_same(read, track, START)


def test_velocities_in_the_wrong_frame_are_noticed(tmp_path: Path) -> None:
    [track] = fly(Truth(steps=300, scale=0.01), 4)
    messages = [
        (topic, kind, time, odometry(time, p, v, 0.3 * time, "map"))
        for (topic, kind, time, _), p, v in zip(
            flown(track), track.positions, track.velocities, strict=True
        )
    ]
    for _, _, _, content in messages:
        # They say that they are the vehicle's, and are the world's.
        content.child_frame_id = "base_link"
    found = read_logs([written(tmp_path / "bag", [*messages, *accelerations(track)])])
    assert any("only if read in the world's frame" in line for line in found.warnings)
    assert_same(found.tracks[0], track, START)


def test_a_second_pose_is_another_sensor_and_a_setpoint_a_reference(tmp_path: Path) -> None:
    [track] = fly(Truth(steps=40), 5, "both")
    rows = zip(track.times, track.positions, track.references, strict=True)
    poses = [
        (topic, POSE, time, of(POSE, header=stamped(time), pose=pose(place)))
        for time, p, r in rows
        for topic, place in (("/v1/gps", p + 0.5), ("/v1/setpoint/pose", r[:2]))
    ]
    found = read_logs([written(tmp_path / "bag", [*flown(track), *poses])])
    [read] = found.tracks
    np.testing.assert_allclose(read.second_positions, track.positions + 0.5)
    np.testing.assert_allclose(read.references, track.references[:, :2], atol=1e-6)
    assert found.warnings == (
        f"{tmp_path / 'bag'}: vehicle 'v1': gps is taken for another sensor beside odom",
    )


def test_messages_out_of_order_are_sorted_by_their_stamps(tmp_path: Path) -> None:
    [track] = fly(Truth(steps=20), 6, "states")
    messages = flown(track)
    late = [(topic, kind, 20.0 - time, content) for topic, kind, time, content in messages]
    [read] = read_logs([written(tmp_path / "bag", late)]).tracks
    assert_same(read, track, START)


def test_a_bag_without_positions_is_refused(tmp_path: Path) -> None:
    [track] = fly(Truth(steps=5), 7)
    folder = written(tmp_path / "bag", accelerations(track))
    with pytest.raises(FileFormatError, match=f"holds no message of type {ODOMETRY} or {POSE}"):
        read_logs([folder])


def test_a_library_that_is_missing_is_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "pyulog", None)
    with pytest.raises(FileFormatError, match=r"needs pyulog: pip install 'radmpc\[logs\]'"):
        read_logs([csv(tmp_path, "x", "log.ulg")])


def test_a_flight_of_px4_is_read_with_its_commands() -> None:
    pytest.importorskip("pyulog")
    found = read_logs([PX4])
    [track] = found.tracks
    assert track.name == "px4"
    assert track.parts() == ("positions", "velocities", "controls", "references")
    assert len(track.times) == 313
    # The vehicle climbs to two meters: down is negative in the log.
    assert np.nanmax(track.positions[:, 2]) == pytest.approx(2.16, abs=0.01)
    # East is the log's y.
    assert np.nanmax(track.positions[:, 0]) < 0.04
    assert any("of the estimator" in line and "undone" in line for line in found.warnings)
    # On the ground PX4 asks for 100 m/s² down.
    assert np.nanmax(np.abs(track.controls)) < 50.0
    identified = identify(found.tracks, dt=0.1)
    assert identified.evidence == "commands"
    assert identified.pooled.num_steps > 100
