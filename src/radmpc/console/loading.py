"""Scenarios and plans read from files, and what to run where a file holds something else."""

from __future__ import annotations

import shlex
from collections.abc import Mapping
from pathlib import Path

from radmpc.errors import FileFormatError
from radmpc.io.native.plan_file import NotPlannedError, load_plan
from radmpc.io.native.scenario_file import load_scenario
from radmpc.io.text.files import one_line
from radmpc.model.plan import Plan
from radmpc.model.scenario import Scenario

__all__ = ["read_plan", "read_scenario"]


def read_plan(path: Path) -> Plan:
    """Return the plan in a file.

    Raises
    ------
    FileFormatError
        As in `load_plan`; for a scenario it names the command that plans it, and a flight is named.
    """
    try:
        return load_plan(path)
    except NotPlannedError as error:
        made = path.with_name(f"{path.name.split('.')[0] or 'fleet'}.plan.json")
        command = f"radmpc plan {shlex.quote(str(path))} -o {shlex.quote(str(made))}"
        raise FileFormatError(f"{error}: {command}") from error
    except FileFormatError as error:
        _refuse_flight(path, "a plan: give the plan that was flown", error)
        raise


def read_scenario(path: Path, changes: Mapping[str, object] | None = None) -> Scenario:
    """Return the scenario in a file.

    Parameters
    ----------
    path : Path
        The file.
    changes : mapping of str to object, optional
        Values that stand in place of the file's, as in `load_scenario`.

    Raises
    ------
    FileFormatError, ScenarioError
        As in `load_scenario`; a flight is named.
    """
    try:
        return load_scenario(path, changes)
    except FileFormatError as error:
        _refuse_flight(path, "a scenario: give the scenario that was planned", error)
        raise


def _refuse_flight(path: Path, wanted: str, error: FileFormatError) -> None:
    """Say of a flight that it is one."""
    from radmpc.io.flight.flight_file import is_flight  # noqa: PLC0415 - most files are none

    if is_flight(path):
        raise FileFormatError(one_line(f"{path}: is a flight, not {wanted}")) from error
