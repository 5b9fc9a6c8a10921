"""Bags and MCAP files as fleets record them: simulated clocks, restarts, splits, silent topics."""

from __future__ import annotations

import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from mcap.writer import Writer as PlainWriter
from ruamel.yaml import YAML

from radmpc.errors import FileFormatError
from radmpc.identification import Track
from radmpc.importing.logs.reading import read_logs
from simulator import Truth, fly

from .recordings import (
    ODOMETRY,
    POSE,
    START,
    STORE,
    TWIST,
    flown,
    of,
    pose,
    stamped,
    twist,
    written,
    written_poses,
)

Logged = tuple[str, str, float, object]


def restamped(messages: list[Logged], start: float) -> list[Logged]:
    """Stamp messages by a clock that began at some time, as simulators do."""
    for _, _, time, content in messages:
        stamp = content.header.stamp
        stamp.sec, stamp.nanosec = divmod(round(1e9 * (start + time)), 10**9)
    return messages


def poses(track: Track, name: str, silent: range = range(0)) -> list[Logged]:
    """Return a track as poses and twists, these not at some samples."""
    rows = enumerate(zip(track.times, track.positions, track.velocities, strict=True))
    return [
        one
        for k, (time, p, v) in rows
        for one in (
            (f"/{name}/pose", POSE, time, of(POSE, header=stamped(time), pose=pose(p))),
            (f"/{name}/twist", TWIST, time, of(TWIST, header=stamped(time), twist=twist(v))),
        )
        if k not in silent or one[1] == POSE
    ]


def mcap(path: Path, messages: list[Logged], *, is_repeated: bool = True) -> Path:
    """Write odometry as MCAP, whose summary repeats its channels or not."""
    with path.open("wb") as file:
        writer = PlainWriter(file, repeat_channels=is_repeated, repeat_schemas=is_repeated)
        writer.start("ros2", "")
        text, _ = STORE.generate_msgdef(ODOMETRY, ros_version=2)
        schema = writer.register_schema(ODOMETRY, "ros2msg", text.encode())
        channels: dict[str, int] = {}
        for topic, kind, time, content in messages:
            if topic not in channels:
                channels[topic] = writer.register_channel(topic, "cdr", schema)
            raw = bytes(STORE.serialize_cdr(content, kind))
            nanoseconds = int((START + time) * 1e9)
            writer.add_message(channels[topic], nanoseconds, raw, nanoseconds)
        writer.finish()
    return path


def test_a_simulated_clock_begins_at_zero(tmp_path: Path) -> None:
    [track] = fly(Truth(steps=20), 2)
    [read] = read_logs([written(tmp_path / "bag", restamped(flown(track), 0.0))]).tracks
    np.testing.assert_allclose(read.times, track.times, atol=1e-6)
    np.testing.assert_allclose(read.positions, track.positions)


def test_a_stamp_that_is_not_set_is_the_time_of_logging(tmp_path: Path) -> None:
    [track] = fly(Truth(steps=20), 2)
    messages = flown(track)
    messages[7][3].header.stamp.sec = messages[7][3].header.stamp.nanosec = 0
    [read] = read_logs([written(tmp_path / "bag", messages)]).tracks
    np.testing.assert_allclose(read.times - START, track.times, atol=1e-6)


def test_a_clock_that_starts_again_is_refused(tmp_path: Path) -> None:
    [track] = fly(Truth(steps=60), 2)
    again = [(topic, kind, time + 60.0, content) for topic, kind, time, content in flown(track)]
    first, second = restamped(flown(track), 100.0), flown(track)
    restamped(second, 103.0)
    runs = [
        (topic, kind, time, content)
        for (topic, kind, time, _), (*_, content) in zip(again, second, strict=True)
    ]
    folder = written(tmp_path / "bag", [*first, *runs])
    with pytest.raises(FileFormatError) as caught:
        read_logs([folder])
    assert str(caught.value) == (
        f"{folder}: /v1/odom: stamps run backwards at message 62: 103.0 s after 130.0 s; "
        "are these two runs in one?"
    )


def test_a_message_that_is_late_is_put_in_its_place(tmp_path: Path) -> None:
    [track] = fly(Truth(steps=60), 2)
    messages = flown(track)
    topic, kind, time, content = messages[5]
    messages[5] = (topic, kind, time + 20.1, content)
    [read] = read_logs([written(tmp_path / "bag", messages)]).tracks
    np.testing.assert_allclose(read.positions, track.positions)


def split(folder: Path, track: Track) -> Path:
    """Write a bag whose storage is split over two files."""
    messages = flown(track)
    parts = [written(folder / name, half) for name, half in
             (("a", messages[:30]), ("b", messages[30:]))]  # fmt: skip
    whole = folder / "run"
    whole.mkdir()
    described = YAML(typ="safe").load(parts[0] / "metadata.yaml")
    content = described["rosbag2_bagfile_information"]
    content["relative_file_paths"] = ["run_0.db3", "run_1.db3"]
    content["files"] = []
    for part, name in zip(parts, content["relative_file_paths"], strict=True):
        shutil.copy(next(part.glob("*.db3")), whole / name)
    YAML(typ="safe").dump(described, whole / "metadata.yaml")
    return whole


def test_the_files_of_a_bag_are_read_once(tmp_path: Path) -> None:
    [track] = fly(Truth(steps=60), 2)
    folder = split(tmp_path, track)
    files = [folder / "run_0.db3", folder / "run_1.db3"]
    found = read_logs(files)
    [read] = found.tracks
    np.testing.assert_allclose(read.positions, track.positions)
    assert found.warnings == (f"{files[1]}: is of the same bag as {files[0]}, and is read with it",)
    assert len(read_logs([folder, *files]).tracks) == 1


def test_an_mcap_file_beside_its_bag_is_read_once(tmp_path: Path) -> None:
    [track] = fly(Truth(steps=20), 2)
    folder = written(tmp_path / "bag", flown(track), "mcap")
    [file] = folder.glob("*.mcap")
    assert len(read_logs([file, folder]).tracks) == 1


def test_a_second_sensor_may_miss_a_sample(tmp_path: Path) -> None:
    [track] = fly(Truth(steps=40), 5)
    rows = enumerate(zip(track.times, track.positions, strict=True))
    gps = [
        ("/v1/gps", POSE, time, of(POSE, header=stamped(time), pose=pose(p + 0.5 + 0.01 * k)))
        for k, (time, p) in rows
        if k != 17
    ]
    [read] = read_logs([written(tmp_path / "bag", [*flown(track), *gps])]).tracks
    assert read.second_positions is not None
    assert np.flatnonzero(np.isnan(read.second_positions).any(axis=1)).tolist() == [17]


def test_velocities_are_not_made_up_while_their_topic_is_silent(tmp_path: Path) -> None:
    [track] = fly(Truth(steps=60), 3, "states")
    [read] = read_logs([written(tmp_path / "bag", poses(track, "v1", range(20, 40)))]).tracks
    assert read.velocities is not None
    is_there = np.isfinite(read.velocities).all(axis=1)
    assert np.flatnonzero(~is_there).tolist() == list(range(20, 40))
    np.testing.assert_allclose(read.velocities[is_there], track.velocities[is_there])


def test_velocities_of_a_slower_topic_are_interpolated(tmp_path: Path) -> None:
    [track] = fly(Truth(steps=60), 3, "states")
    messages = poses(track, "v1")
    slow = [one for k, one in enumerate(messages) if one[1] == POSE or k % 8 == 1]
    [read] = read_logs([written(tmp_path / "bag", slow)]).tracks
    assert np.isfinite(read.velocities).all()


def test_vehicles_below_a_common_namespace_are_told_apart(tmp_path: Path) -> None:
    tracks = fly(Truth(steps=60, vehicles=3), 3)
    messages = [one for track in tracks for one in poses(track, f"mocap/{track.name}")]
    found = read_logs([written(tmp_path / "bag", messages)])
    assert [track.name for track in found.tracks] == ["v1", "v2", "v3"]
    for read, track in zip(found.tracks, tracks, strict=True):
        np.testing.assert_allclose(read.positions, track.positions)
        np.testing.assert_allclose(read.velocities, track.velocities)
    assert found.warnings == (
        f"{tmp_path / 'bag'}: below mocap, v1/pose, v2/pose, v3/pose move apart: taken for "
        "vehicles of their own",
    )


def test_vehicles_below_two_namespaces_keep_both_parts_of_their_names(tmp_path: Path) -> None:
    tracks = fly(Truth(steps=60, vehicles=2), 3)
    messages = [one for track in tracks for one in poses(track, f"mocap/{track.name}")]
    found = read_logs([written(tmp_path / "bag", [*messages, *flown(tracks[0])])])
    assert [track.name for track in found.tracks] == ["mocap/v1", "v2", "v1"]


def test_sensors_of_one_vehicle_stay_together(tmp_path: Path) -> None:
    [track] = fly(Truth(steps=60), 3, "states")
    shifted = replace(track, positions=track.positions + np.array([3.0, -2.0]))
    messages = [*poses(track, "tug/gps"), *poses(shifted, "tug/lidar")]
    found = read_logs([written(tmp_path / "bag", messages)])
    [read] = found.tracks
    assert read.name == "tug"
    assert read.second_positions is not None


def test_a_bag_whose_places_are_all_references_says_so(tmp_path: Path) -> None:
    [track] = fly(Truth(steps=20), 2)
    messages = [("/v1/target/odom", *rest) for _, *rest in flown(track)]
    with pytest.raises(FileFormatError, match="only on topics of references: /v1/target/odom"):
        read_logs([written(tmp_path / "bag", messages)])


def test_an_mcap_file_whose_summary_has_no_channels_is_read(tmp_path: Path) -> None:
    [track] = fly(Truth(steps=20), 2)
    [read] = read_logs([mcap(tmp_path / "a.mcap", flown(track), is_repeated=False)]).tracks
    np.testing.assert_allclose(read.positions, track.positions)


@pytest.mark.parametrize("kept", [0.5, 1.1])
def test_an_mcap_file_that_was_cut_off_or_added_to_is_called_that(
    tmp_path: Path, kept: float
) -> None:
    [track] = fly(Truth(steps=20), 2)
    path = written_poses(tmp_path / "a.mcap", track)
    raw = path.read_bytes()
    path.write_bytes((raw + raw)[: int(kept * len(raw))])
    with pytest.raises(FileFormatError) as caught:
        read_logs([path])
    assert str(caught.value) == (
        f"{path}: does not end as MCAP does: the recording was cut off, or something was added; "
        "'mcap recover' repairs it"
    )


def test_csv_with_bare_carriage_returns_is_read(tmp_path: Path) -> None:
    path = tmp_path / "log.csv"
    path.write_bytes(b"time,x,y\r0,1,2\r1,2,3\r")
    [track] = read_logs([path]).tracks
    assert track.positions.tolist() == [[1.0, 2.0], [2.0, 3.0]]


def test_a_csv_that_its_library_cannot_read_is_one_line(tmp_path: Path) -> None:
    path = tmp_path / "log.csv"
    path.write_text("time,x,y\n0,1," + "2" * 200_000 + "\n", encoding="utf-8")
    with pytest.raises(
        FileFormatError,
        match=r"log\.csv: line 2: cannot be read as CSV: field larger than field limit",
    ):
        read_logs([path])
