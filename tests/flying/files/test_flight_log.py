"""Logs of a flight: messages in JSON that other tools read, and `identify`."""

from __future__ import annotations

import json
from io import BytesIO
from pathlib import Path

import numpy as np
import pytest
from mcap.reader import make_reader
from recorded_flights import beside_the_wall, drifting, staked_rows

import radmpc
from radmpc.identification import identify
from radmpc.importing.logs.reading import read_logs
from radmpc.io.flight.mcap_log import write_log
from radmpc.io.flight.record import FlightRecord, FlightSettings


def messages(content: bytes, topic: str) -> list[tuple[float, dict[str, object]]]:
    reader = make_reader(BytesIO(content))
    found = []
    for schema, channel, message in reader.iter_messages(topics=[topic]):
        assert (schema.encoding, channel.message_encoding) == ("jsonschema", "json")
        value = json.loads(message.data)
        known = json.loads(schema.data)["properties"]
        assert set(value) <= set(known)
        found.append((message.log_time * 1e-9, value))
    return found


def test_a_log_tells_states_controls_and_the_account() -> None:
    plan = beside_the_wall()
    rows = staked_rows(plan)
    content = write_log(FlightRecord(plan, FlightSettings(), tuple(rows)))
    states, ticks = messages(content, "/radmpc/v/state"), messages(content, "/radmpc/ticks")
    assert [time for time, _ in states] == [time for time, _ in ticks] == list(range(11))
    assert [value["position"] for _, value in states] == [row.states[0].tolist() for row in rows]
    assert [value["control"] for _, value in states[:-1]] == [
        row.controls[0].tolist() for row in rows[:-1]
    ]
    assert "control" not in states[-1][1]
    assert [value["bank"] for _, value in ticks] == [row.bank for row in rows]
    # A leg begins where the vehicle was measured.
    assert rows[1].leg is not None
    assert states[1][1]["reference"] == states[1][1]["position"]


def test_missions_follow_one_another_in_a_log() -> None:
    record = radmpc.begin_flight(drifting(2), FlightSettings(replan=None, missions=2))
    times = [time for time, _ in messages(write_log(record), "/radmpc/a/state")]
    assert times == [*range(7), *range(16, 23)]


@pytest.mark.slow
@pytest.mark.parametrize("dimension", [2, pytest.param(3, marks=pytest.mark.nightly)])
def test_the_noise_of_a_flight_is_identified_from_its_log(tmp_path: Path, dimension: int) -> None:
    plan = drifting(dimension)
    record = radmpc.begin_flight(plan, FlightSettings(replan=None, missions=40, seed=3))
    path = tmp_path / "flight.mcap"
    path.write_bytes(write_log(record))
    recording = read_logs([path])
    assert len(recording.tracks) == 40
    found = identify(recording.tracks, warnings=recording.warnings)
    assert (found.model.dt, found.model.dimension, found.evidence) == (1.0, dimension, "commands")
    assert found.warnings == ()
    [vehicle] = plan.scenario.vehicles
    truth = np.diag(vehicle.disturbance_covariance)
    covariance = found.pooled.covariance
    assert np.all(np.diag(covariance.low) <= truth)
    assert np.all(truth <= np.diag(covariance.high))


def test_without_states_there_is_nothing_to_identify(tmp_path: Path) -> None:
    path = tmp_path / "flight.mcap"
    path.write_bytes(write_log(FlightRecord(drifting(2), FlightSettings())))
    with pytest.raises(radmpc.FileFormatError):
        identify(read_logs([path]).tracks)
