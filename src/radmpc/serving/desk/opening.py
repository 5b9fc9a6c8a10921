"""Files as documents: a scenario, the scenario of a plan or a flight, a chart."""

from __future__ import annotations

import os
from pathlib import Path

from radmpc.errors import FileFormatError, ScenarioError
from radmpc.io.flight.flight_file import is_flight
from radmpc.io.native.encoding import encode_scenario
from radmpc.io.native.plain import plain_mapping
from radmpc.io.native.plan_file import decode_plan
from radmpc.io.ranges import PLAN_FORMAT, SCENARIO_FORMAT
from radmpc.io.text.document import read_document
from radmpc.model.plan import Plan
from radmpc.records import dataclass, field
from radmpc.serving.documents.text import Original
from radmpc.serving.failures import refused
from radmpc.serving.folder import CHARTS, FLIGHTS
from radmpc.serving.protocol import Content, TickView

__all__ = ["Opened", "is_chart", "read_file"]

_MOST_BYTES = 64 * 2**20
"""Size of a file that is opened [bytes]: plans of large fleets have ten megabytes."""


@dataclass(frozen=True, slots=True, eq=False)
class Opened:
    """What a file holds.

    Attributes
    ----------
    content : mapping
        The document.
    origin : Original or None
        Its text, where it is to be kept.
    is_scenario : bool
        Whether it may be saved there again.
    plan : Plan or None
        The plan in it.
    ticks : list of TickView or None
        The flight in it, its first mission.
    note : str
        What is to be known of that flight.
    """

    content: Content
    origin: Original | None = None
    is_scenario: bool = False
    plan: Plan | None = None
    ticks: list[TickView] | None = field(default=None)
    note: str = ""


def is_chart(name: str) -> bool:
    """Whether a file is read by an import, by its ending."""
    return name.lower().endswith(CHARTS)


def read_file(path: Path, name: str) -> Opened:
    """Return what a file holds, as far as it is ours.

    Parameters
    ----------
    path : Path
        Where it is.
    name : str
        As the page calls it, for messages: no place outside the folder is told.

    Raises
    ------
    CallError
        With one line that names file, line, field, value and what is allowed; of a scenario with
        wrong values, none: they can be put right on the page, unless JSON cannot tell them.
    """
    try:
        if path.stat().st_size > _MOST_BYTES:
            raise refused(f"{name}: must be at most {_MOST_BYTES // 2**20} MiB")
        # A flight is one by its first line, as for the commands: plans end in .json, too.
        if path.suffix.lower() in FLIGHTS or is_flight(path):
            return _flight(path)
        return _document(path, name)
    except (FileFormatError, ScenarioError) as error:
        raise refused(_without_place(str(error), path, name)) from error
    except OSError as error:
        raise refused(f"{name}: {error.strerror or type(error).__name__}") from error


def _without_place(text: str, path: Path, name: str) -> str:
    """Return a message with the file named as the page does."""
    return text.replace(os.fspath(path), name)


def _document(path: Path, name: str) -> Opened:
    """Return a scenario or a plan."""
    document = read_document(path)
    value = document.value
    if not isinstance(value, dict):
        raise refused(f"{name}: must be a mapping with a format")
    kind = value.get("format")
    if kind == PLAN_FORMAT:
        try:
            plan = decode_plan(value)
        except ScenarioError as error:
            raise document.failure(error) from error
        return Opened(encode_scenario(plan.scenario), plan=plan)
    if kind != SCENARIO_FORMAT:
        raise refused(f"{name}: format must be {SCENARIO_FORMAT} or {PLAN_FORMAT}", ["format"])
    try:
        # What no page can be told cannot be put right there, either.
        value = plain_mapping(value, ())
    except ScenarioError as error:
        raise document.failure(error) from error
    is_yaml = path.suffix.lower() != ".json"
    return Opened(value, Original(document.text) if is_yaml else None, is_scenario=True)


def _flight(path: Path) -> Opened:
    """Return a flight: its first mission as ticks."""
    from radmpc.io.flight.flight_file import load_flight  # noqa: PLC0415 - few are opened
    from radmpc.serving.views.flight import tick_view  # noqa: PLC0415 - few flights are opened

    record = load_flight(path)
    scenario = record.plan.scenario
    missions = record.missions
    rows = missions[0].rows if missions else ()
    ticks = [tick_view(row, scenario, scenario.risk_bound) for row in rows]
    which = f", the first of {len(missions)} missions" if len(missions) > 1 else ""
    note = "; ".join(filter(None, (f"read from its file{which}", record.doubts)))
    return Opened(encode_scenario(scenario), plan=record.plan, ticks=ticks, note=note)
