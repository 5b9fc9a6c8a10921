"""A flight recomputed from its file alone, as one record and as a report."""

from __future__ import annotations

from pathlib import Path

from rich.text import Text

from radmpc.console.output import note, show, show_json
from radmpc.console.reports.flight import flight_json, flight_rows
from radmpc.console.reports.report import facts
from radmpc.console.running.guard import Code
from radmpc.console.words import first_of, scenario_line
from radmpc.errors import RadmpcError
from radmpc.flying.recording.summary import summary_of
from radmpc.flying.recording.verifying import flight_problems
from radmpc.io.flight.flight_file import load_flight

__all__ = ["run_verify_flight"]


def run_verify_flight(path: Path, *, as_json: bool) -> int:
    """Book a flight again and report.

    Parameters
    ----------
    path : Path
        The flight.
    as_json : bool
        Whether stdout gets JSON rather than the report.

    Returns
    -------
    int
        The exit code: whether all that the file states follows from what was measured and flown,
        and the collision rate does not speak against the bound.

    Raises
    ------
    FileFormatError
        If the file is no flight.
    """
    record = load_flight(path)
    problems = flight_problems(record)
    try:
        summary = summary_of(record)
    except RadmpcError as error:
        problems = (*problems, f"the plan cannot be flown: {error}")
        _show_rejected(problems, as_json=as_json)
        return _judged(path, problems)
    if summary.contradiction is not None:
        problems += (summary.contradiction,)
    holds = not problems
    if as_json:
        content = flight_json(record, summary) | {"holds": holds, "problems": list(problems)}
        show_json(content)
        return _judged(path, problems)
    rows = flight_rows(record, summary)
    ticks = f"recomputed, {summary.ticks} ticks"
    rows["account"] = ticks if holds else Text("\n".join(problems), style="red")
    word = Text("holds", "bold green") if holds else Text("does not hold", "bold red")
    title = Text(scenario_line(record.plan.scenario), style="bold")
    show(title, facts(rows | {"the flight": word}))
    return _judged(path, problems)


def _judged(path: Path, problems: tuple[str, ...]) -> Code:
    """Say on stderr what speaks against a flight, and return the exit code."""
    if not problems:
        return Code.OK
    note(f"{path}: the flight does not hold: {first_of(tuple(dict.fromkeys(problems)))}")
    return Code.NO


def _show_rejected(problems: tuple[str, ...], *, as_json: bool) -> None:
    """Report a flight that cannot even be summed up."""
    if as_json:
        show_json({"holds": False, "problems": list(problems)})
    else:
        told = Text("\n".join(dict.fromkeys(problems)), style="red")
        show(facts({"problems": told, "the flight": Text("does not hold", "bold red")}))
