"""Flight files of the hunt: read back, verified, cut short, gone on with, and changed."""

from __future__ import annotations

import hashlib
import json
from dataclasses import fields
from pathlib import Path

import numpy as np

import radmpc
from hunting.catch import Notes
from radmpc.flying.recording.campaign import begin_flight, resume_flight
from radmpc.flying.recording.verifying import flight_problems
from radmpc.io.flight.flight_file import load_flight
from radmpc.io.flight.record import FlightRecord, FlightSettings
from radmpc.model.plan import Plan

__all__ = ["check_files"]

_REPEATED = (None, None, "dlp", "ira")
"""What plans anew in flights that are flown again: no time limit cuts these off."""

_MOST_PLANNED = 3
"""Vehicles up to which that does not take long [-]."""

_MUCH = 1e-3
"""Change of a number from which on it has to be found out, absolute and relative [-]."""

_CERTAIN = ("value", "wealth", "tail", "bank", "controls")
"""Numbers of a row that follow from all others."""


def check_files(plan: Plan, folder: Path, rng: np.random.Generator, notes: Notes) -> int:
    """Fly a plan into a file, and look at what can be done with it.

    Parameters
    ----------
    plan : Plan
        What is flown.
    folder : Path
        For files.
    rng : Generator
        Decides everything.
    notes : Notes
        Gets what is wrong.

    Returns
    -------
    int
        Missions that were flown.
    """
    path = folder / "whole.flight.jsonl"
    replan = _REPEATED[int(rng.integers(len(_REPEATED)))]
    if plan.scenario.num_vehicles > _MOST_PLANNED:
        replan = None
    settings = FlightSettings(replan=replan, missions=2, seed=int(rng.integers(1000)))
    whole = begin_flight(plan, settings, path)
    read = load_flight(path)
    if plain(read) != plain(whole) or read.changed:
        notes.add("file", f"{replan}: what was read is not what was flown")
    for problem in flight_problems(read):
        notes.add("file", f"{replan}: {problem}")
    text = path.read_bytes()
    for _ in range(3):
        _check_cut(whole, text, folder / "cut.flight.jsonl", rng, notes)
    for _ in range(6):
        _check_changed(text, folder / "changed.flight.jsonl", rng, notes)
    for _ in range(6):
        _check_forged(text, folder / "forged.flight.jsonl", rng, notes)
    return len(whole.missions)


def plain(record: FlightRecord) -> list[object]:
    """Return the rows of a record as plain data, without what decisions took."""
    return [_plain(row, ()) for row in record.rows]


def _plain(value: object, left_out: tuple[str, ...]) -> object:
    """Return a value with arrays as bytes."""
    if isinstance(value, np.ndarray):
        return value.tobytes()
    if isinstance(value, tuple):
        return [_plain(item, left_out) for item in value]
    if hasattr(value, "__dataclass_fields__"):
        names = [f.name for f in fields(value) if f.name != "seconds"]  # type: ignore[arg-type] # a dataclass
        return {name: _plain(getattr(value, name), left_out) for name in names}
    return value


def _check_cut(
    whole: FlightRecord, text: bytes, path: Path, rng: np.random.Generator, notes: Notes
) -> None:
    """Cut a file short, look at it, and go on with it."""
    at = int(rng.integers(1, len(text)))
    if rng.random() < 0.5:
        ends = [i + 1 for i, byte in enumerate(text) if byte == ord("\n")]
        at = int(rng.choice(ends))
    path.write_bytes(text[:at])
    try:
        record = load_flight(path)
    except radmpc.FileFormatError as error:
        if at > text.index(b"\n"):
            notes.add("cut", f"a header that is whole was not read: {error}")
        return
    if plain(record) != plain(whole)[: len(record.rows)]:
        notes.add("cut", "the rows that are left are not those that were written")
    for problem in flight_problems(record):
        notes.add("cut", f"cut at {at}: {problem}")
    for problem in _resumed_problems(path, whole):
        notes.add("resume", f"cut at {at}, {len(record.rows)} rows: {problem}")


def _resumed_problems(path: Path, whole: FlightRecord) -> list[str]:
    """Return how a flight that went on differs from one that was not interrupted."""
    found = []
    went_on = resume_flight(path)
    pairs = zip(plain(went_on), plain(whole), strict=False)
    if len(went_on.rows) != len(whole.rows):
        found.append(f"{len(went_on.rows)} rows, not {len(whole.rows)}")
    for number, (one, other) in enumerate(pairs):
        assert isinstance(one, dict)
        assert isinstance(other, dict)
        if one != other:
            keys = [key for key in one if one[key] != other[key]]
            pairs_of = {k: (one[k], other[k]) for k in keys if k in {"wealth", "reason", "tail"}}
            found.append(f"row {number} differs in {keys}: {pairs_of}")
            break
    again = load_flight(path)
    if plain(again) != plain(went_on) or again.changed:
        found.append("the file holds something else")
    return found + list(flight_problems(again))


def _check_changed(text: bytes, path: Path, rng: np.random.Generator, notes: Notes) -> None:
    """Change a digit anywhere, or a byte: that has to be found out."""
    changed = bytearray(text)
    digits = [i for i, byte in enumerate(text) if chr(byte).isdigit()]
    at = int(rng.choice(digits)) if rng.random() < 0.7 else int(rng.integers(len(text)))
    fresh = ord("0") + int(rng.integers(10)) if at in digits else int(rng.integers(256))
    if changed[at] == fresh:
        return
    changed[at] = fresh
    path.write_bytes(bytes(changed))
    try:
        problems = flight_problems(load_flight(path))
    except radmpc.RadmpcError as error:
        if "\n" in str(error):
            notes.add("changed", f"byte {at}: an error of several lines: {error}")
        return
    # The last line's end was cut off with what followed.
    if not problems and not (fresh == ord("\n") or at == len(text) - 1):
        notes.add("changed", f"byte {at} of {len(text)}: {chr(text[at])!r} to {chr(fresh)!r} holds")


def _check_forged(text: bytes, path: Path, rng: np.random.Generator, notes: Notes) -> None:
    """Change a number of a row and sign the file anew: what follows from others is found out."""
    lines = text.decode().splitlines()
    number = int(rng.integers(1, len(lines)))
    row = json.loads(lines[number])
    key = str(rng.choice([k for k in row if k not in {"digest", "mission"}]))
    much = float(rng.choice([_MUCH, 0.1, 1e6, -1.0]))
    told, is_large = _shifted(row[key], much, rng)
    if told is None:
        return
    row[key] = told
    lines[number] = json.dumps(row, ensure_ascii=False)
    path.write_text("\n".join(_signed(lines)) + "\n", encoding="utf-8")
    try:
        problems = flight_problems(load_flight(path))
    except radmpc.RadmpcError as error:
        if "\n" in str(error):
            notes.add("forged", f"line {number + 1}, {key}: an error of several lines: {error}")
        return
    if not problems and key in _CERTAIN and is_large:
        notes.add("forged", f"line {number + 1}: another {key} by {much} holds")


def _shifted(value: object, much: float, rng: np.random.Generator) -> tuple[object, bool]:
    """Return a value with one of its numbers changed, and whether by much; None without numbers."""
    if isinstance(value, bool):
        return None, False
    if isinstance(value, int):
        return value + (1 if much > 0.0 else -1), True
    if isinstance(value, float):
        return value + much * max(abs(value), 1.0), True
    if not isinstance(value, dict | list) or not value:
        return None, False
    keys = list(value) if isinstance(value, dict) else list(range(len(value)))
    key = keys[int(rng.integers(len(keys)))]
    inner, is_large = _shifted(value[key], much, rng)
    if inner is None:
        return None, False
    made = dict(value) if isinstance(value, dict) else list(value)
    made[key] = inner
    return made, is_large


def _signed(lines: list[str]) -> list[str]:
    """Return lines with digests that fit."""
    digest, made = "", []
    for text in lines:
        content = json.loads(text)
        content.pop("digest", None)
        body = json.dumps(content, ensure_ascii=False)[:-1]
        digest = hashlib.sha256(f"{digest}\n{body}".encode()).hexdigest()[:16]
        made.append(f'{body}, "digest": "{digest}"}}')
    return made
