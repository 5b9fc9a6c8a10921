"""A flight as MCAP: JSON messages with their schemas, which Foxglove shows and `identify` reads."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from importlib import import_module
from io import BytesIO
from typing import Any

import numpy as np

from radmpc.arrays import Vector
from radmpc.errors import FileFormatError
from radmpc.io.export.names import distinct, topic_part
from radmpc.io.flight.following import followed
from radmpc.io.flight.record import FlightRecord, TickRow
from radmpc.model.vehicle import Vehicle

__all__ = ["STATE_SCHEMA", "check_library", "write_log"]

STATE_SCHEMA = "radmpc.VehicleState"
"""Name of the schema of messages that tell where a vehicle was."""

_TICK_SCHEMA = "radmpc.Tick"

_BETWEEN = 10
"""Steps of silence between two missions in the log's time."""

_NUMBER = {"type": "number"}
_NUMBERS = {"type": "array", "items": _NUMBER}
_TIME = {
    "type": "object",
    "properties": {"sec": {"type": "integer"}, "nsec": {"type": "integer"}},
}
_STATE = {
    "timestamp": _TIME,
    "vehicle": {"type": "string"},
    "mission": {"type": "integer"},
    "step": {"type": "integer"},
    "position": {**_NUMBERS, "description": "measured [m]"},
    "velocity": {**_NUMBERS, "description": "measured [m/s]"},
    "control": {**_NUMBERS, "description": "held until the next step [m/s²]"},
    "reference": {**_NUMBERS, "description": "where the leg in the air expects the state [m, m/s]"},
}
_TICK = {
    "timestamp": _TIME,
    "mission": {"type": "integer"},
    "step": {"type": "integer"},
    "choice": {"type": "string", "enum": ["tail", "candidate"]},
    "reason": {"type": "string"},
    "risk_bound": _NUMBER,
    "value": {"type": ["number", "null"]},
    "price": {"type": ["number", "null"]},
    "wealth": _NUMBER,
    "tail": _NUMBER,
    "bank": _NUMBER,
    "seconds": _NUMBER,
    "alarms": {"type": "array", "items": {"type": "string"}},
    "contacts": {"type": "array", "items": {"type": "string"}},
}

Message = dict[str, object]


def write_log(record: FlightRecord) -> bytes:
    """Return a flight as an MCAP recording.

    Parameters
    ----------
    record : FlightRecord
        What was flown; nothing that was not measured is in it.

    Returns
    -------
    bytes
        Not compressed, so that they do not depend on a library's version. Time 0 is the start of
        the first mission; ten steps lie between two.

    Raises
    ------
    FileFormatError
        If the library is missing.
    """
    library = check_library()
    buffer = BytesIO()
    writer = library.Writer(buffer, compression=library.CompressionType.NONE)
    writer.start(profile="", library="radmpc")
    scenario = record.plan.scenario
    names = [vehicle.name for vehicle in scenario.vehicles]
    parts = distinct(names, topic_part)
    states, ticks = _schema(writer, STATE_SCHEMA, _STATE), _schema(writer, _TICK_SCHEMA, _TICK)
    topics = {name: _channel(writer, f"/radmpc/{parts[name]}/state", states) for name in names}
    account = _channel(writer, "/radmpc/ticks", ticks)
    for mission in record.missions:
        begin = mission.number * (scenario.horizon + _BETWEEN)
        for known in followed(record, mission):
            row = known.row
            time = round((begin + row.step) * scenario.dt * 1e9)
            _add(writer, account, _tick(row, scenario.risk_bound), time)
            for name, message in _states(record, row, known.expected):
                _add(writer, topics[name], message, time)
    settings = record.settings
    about = {"scenario": scenario.name, "with": settings.backend, "dt": f"{scenario.dt:g}"}
    writer.add_metadata("radmpc", {**about, "time": "counts from the start of the first mission"})
    writer.finish()
    return buffer.getvalue()


def check_library() -> Any:
    """Return the library that writes MCAP.

    Raises
    ------
    FileFormatError
        If it is missing.
    """
    try:
        # Not by `import`: the library is optional, for the type checker too.
        return import_module("mcap.writer")
    except ImportError as error:
        raise FileFormatError("a log needs mcap: pip install 'radmpc[mcap]'") from error


def _schema(writer: Any, name: str, properties: Mapping[str, object]) -> int:
    """Register a schema."""
    content = {"type": "object", "title": name, "properties": properties}
    number: int = writer.register_schema(
        name=name, encoding="jsonschema", data=json.dumps(content).encode()
    )
    return number


def _channel(writer: Any, topic: str, schema: int) -> int:
    """Register a topic."""
    number: int = writer.register_channel(topic=topic, message_encoding="json", schema_id=schema)
    return number


def _add(writer: Any, channel: int, message: Message, time: int) -> None:
    """Write a message at a time [ns]."""
    seconds, rest = divmod(time, 10**9)
    content = {"timestamp": {"sec": seconds, "nsec": rest}, **message}
    data = json.dumps(content, ensure_ascii=False, allow_nan=False).encode()
    writer.add_message(channel_id=channel, log_time=time, publish_time=time, data=data)


def _tick(row: TickRow, risk_bound: float) -> Message:
    """Return a decision."""
    told = [
        f"{t.vehicle} out of range of {t.other}" if t.cause == "range"
        else f"{t.vehicle} hit {t.other}" if t.other
        else f"{t.vehicle} left"
        for t in row.contacts
    ]  # fmt: skip
    return {
        "mission": row.mission,
        "step": row.step,
        "choice": row.choice,
        "reason": row.reason,
        "risk_bound": risk_bound,
        "value": row.value,
        "price": row.price,
        "wealth": row.wealth,
        "tail": row.tail,
        "bank": row.bank,
        "seconds": row.seconds,
        "alarms": list(row.alarms),
        "contacts": told,
    }


def _states(
    record: FlightRecord, row: TickRow, expected: tuple[Vector, ...]
) -> Iterator[tuple[str, Message]]:
    """Return what was measured of every vehicle, nothing where nothing was."""
    for i, state in enumerate(row.states or ()):
        vehicle = record.plan.scenario.vehicles[i]
        message: Message = {
            "vehicle": vehicle.name,
            "mission": row.mission,
            "step": row.step,
            "position": _of(vehicle, state),
            "reference": _of(vehicle, expected[i]) + _of(vehicle, expected[i], speed=True),
        }
        if vehicle.system.velocity is not None:
            message["velocity"] = _of(vehicle, state, speed=True)
        if row.controls:
            message["control"] = row.controls[i].tolist()
        yield vehicle.name, message


def _of(vehicle: Vehicle, state: Vector, *, speed: bool = False) -> list[float]:
    """Return the position in a state, or the velocity; nothing where it has none."""
    indices = vehicle.system.velocity if speed else vehicle.system.position
    return [] if indices is None else np.asarray(state)[list(indices)].tolist()
