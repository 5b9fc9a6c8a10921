"""Plans read from files, and what to run where a file holds none."""

from __future__ import annotations

import shlex
from pathlib import Path

from radmpc.errors import FileFormatError
from radmpc.io.native.plan_file import NotPlannedError, load_plan
from radmpc.io.text.files import one_line
from radmpc.model.plan import Plan

__all__ = ["read_plan"]


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
        from radmpc.io.flight.flight_file import is_flight  # noqa: PLC0415 - most files are plans

        if is_flight(path):
            text = f"{path}: is a flight, not a plan: give the plan that was flown"
            raise FileFormatError(one_line(text)) from error
        raise
