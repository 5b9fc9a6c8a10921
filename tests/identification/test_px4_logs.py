"""Logs of PX4 with quirks, written byte by byte as its format describes."""

from __future__ import annotations

import struct
from pathlib import Path

import numpy as np
import pytest

from radmpc.errors import FileFormatError
from radmpc.importing.logs.reading import read_logs

pytest.importorskip("pyulog")

STATES, SETPOINTS = "vehicle_local_position", "vehicle_local_position_setpoint"
FORMATS = {
    STATES: "uint64_t timestamp;float x;float y;float z;float vx;float vy;float vz;",
    SETPOINTS: "uint64_t timestamp;float x;float y;float z;float[3] acceleration;",
}
TIMES = 1.0 + 0.1 * np.arange(200)
PLACES = np.column_stack([np.sin(TIMES), np.cos(2.0 * TIMES), 0.1 * TIMES])


def message(kind: str, content: bytes) -> bytes:
    return struct.pack("<HB", len(content), ord(kind)) + content


def head(*subscribed: tuple[str, int, int], appended: int = 0) -> bytes:
    """Return a log's header, its formats, and which instance of what has which number."""
    flags = bytes(8) + bytes([appended > 0]) + bytes(7) + struct.pack("<QQQ", appended, 0, 0)
    formats = [message("F", f"{name}:{fields}".encode()) for name, fields in FORMATS.items()]
    added = [
        message("A", struct.pack("<BH", instance, number) + name.encode())
        for name, instance, number in subscribed
    ]
    start = b"ULog\x01\x12\x35\x01" + struct.pack("<Q", 0)
    return start + message("B", flags) + b"".join([*formats, *added])


def sample(number: int, time: float, east_north_up: np.ndarray) -> bytes:
    """Return a state or a setpoint: north, east, down, and three numbers more."""
    east, north, up = east_north_up
    numbers = (north, east, -up, 1.0, 2.0, -3.0)
    return message("D", struct.pack("<HQ6f", number, round(1e6 * time), *numbers))


def states(number: int = 0, shift: float = 0.0) -> list[bytes]:
    rows = zip(TIMES, PLACES, strict=True)
    return [sample(number, time, place + shift) for time, place in rows]


def written(folder: Path, *parts: bytes) -> Path:
    path = folder / "flight.ulg"
    path.write_bytes(b"".join(parts))
    return path


def test_the_first_instance_counts_whatever_comes_first_in_the_file(tmp_path: Path) -> None:
    both = [one for pair in zip(states(1, 5.0), states(0), strict=True) for one in pair]
    for order in ((1, 0), (0, 1)):
        subscribed = [(STATES, instance, instance) for instance in order]
        [read] = read_logs([written(tmp_path, head(*subscribed), *both)]).tracks
        np.testing.assert_allclose(read.positions, PLACES, atol=1e-6)
        np.testing.assert_allclose(read.times, TIMES)


def test_data_appended_after_a_crash_do_no_harm(tmp_path: Path) -> None:
    body = b"".join(states())
    length = len(head((STATES, 0, 0), appended=1)) + len(body)
    text = b"char[3] abc"
    more = message("I", bytes([len(text)]) + text + b"xyz")
    [read] = read_logs([
        written(tmp_path, head((STATES, 0, 0), appended=length), body, more)
    ]).tracks  # fmt: skip
    np.testing.assert_allclose(read.positions, PLACES, atol=1e-6)


def test_a_dropout_is_told(tmp_path: Path) -> None:
    body = states()
    body[50:54] = [message("O", struct.pack("<H", 400))]
    found = read_logs([written(tmp_path, head((STATES, 0, 0)), *body)])
    assert len(found.tracks[0].times) == 196
    assert found.warnings[0].endswith(": 1 dropout of the log, 0.4 s in all")


def test_a_part_that_cannot_be_read_is_told(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    body = states()
    body[100] = bytes(3) + body[100][3:]
    path = written(tmp_path, head((STATES, 0, 0)), *body)
    found = read_logs([path])
    count = len(found.tracks[0].times)
    assert 100 <= count < 200
    [warning] = found.warnings
    assert f": a part of the log is corrupt: {count} samples from 1 s to " in warning
    assert capsys.readouterr().out == ""


@pytest.mark.parametrize("cut", [1, 20, len(sample(0, 1.0, PLACES[0])) - 1])
def test_a_log_that_ends_within_a_message_is_told(tmp_path: Path, cut: int) -> None:
    path = written(tmp_path, head((STATES, 0, 0)), *states())
    path.write_bytes(path.read_bytes()[:-cut])
    found = read_logs([path])
    assert len(found.tracks[0].times) == 199
    assert found.warnings == (
        f"{path}: ends within a message: the log was cut off: "
        "199 samples from 1 s to 20.8 s are read",
    )


def test_a_whole_log_is_not_called_cut_off(tmp_path: Path) -> None:
    assert read_logs([written(tmp_path, head((STATES, 0, 0)), *states())]).warnings == ()


def test_a_cut_is_told_of_data_appended_after_a_crash_alone(tmp_path: Path) -> None:
    # The crash itself cuts off the message before.
    body = b"".join(states())[:-5]
    length = len(head((STATES, 0, 0), appended=1)) + len(body)
    text = b"char[3] abc"
    more = message("I", bytes([len(text)]) + text + b"xyz")
    path = written(tmp_path, head((STATES, 0, 0), appended=length), body, more)
    assert read_logs([path]).warnings == ()
    path.write_bytes(path.read_bytes()[:-1])
    [warning] = read_logs([path]).warnings
    assert ": ends within a message: the log was cut off: " in warning


def test_commands_and_references_are_not_made_up_while_there_are_none(tmp_path: Path) -> None:
    # By hand from 6 s to 11 s, and from 16 s on.
    is_flown = [not 50 <= k < 100 and k < 150 for k in range(200)]
    setpoints = [sample(1, time + 0.001, place) for time, place in zip(TIMES, PLACES, strict=True)]
    body = [
        one
        for state, setpoint, is_there in zip(states(), setpoints, is_flown, strict=True)
        for one in ((state, setpoint) if is_there else (state,))
    ]
    subscribed = ((STATES, 0, 0), (SETPOINTS, 0, 1))
    [read] = read_logs([written(tmp_path, head(*subscribed), *body)]).tracks
    for part in (read.controls, read.references):
        assert part is not None
        is_there = np.isfinite(part).all(axis=1)
        assert not is_there[51:100].any()
        assert not is_there[156:].any()
        assert is_there[1:50].all()
        assert is_there[101:150].all()


def test_a_log_without_positions_is_refused(tmp_path: Path) -> None:
    with pytest.raises(FileFormatError, match="holds no vehicle_local_position"):
        read_logs([written(tmp_path, head((STATES, 0, 0)))])
