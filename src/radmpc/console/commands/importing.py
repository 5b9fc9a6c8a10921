"""Another group's problem turned into a scenario's file."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from radmpc import importing
from radmpc.console.files import check_output, check_separate, writing
from radmpc.console.options import named_options
from radmpc.console.output import show
from radmpc.console.reports.report import facts
from radmpc.console.running.guard import Code
from radmpc.console.words import scenario_line
from radmpc.io.native.scenario_file import save_scenario
from radmpc.model.scenario import Scenario
from radmpc.planners.presolve import grouped, sure_reasons
from radmpc.program.build import condensed_models

__all__ = ["run_import"]


def run_import(sources: Sequence[Path], output: Path, options: Mapping[str, Any]) -> int:
    """Import a problem, write it, and print what had to be chosen.

    Parameters
    ----------
    sources : sequence of Path
        The problem; several are charts of one.
    output : Path
        Where the scenario goes.
    options : mapping
        Fields of `ImportOptions`, as typed.

    Returns
    -------
    int
        The exit code.

    Raises
    ------
    ScenarioError
        If an option is out of range.
    FileFormatError, OutputError
        If the problem cannot be read, or the scenario not be written.
    """
    check_output(output)
    for source in sources:
        check_separate(source, output)
    with named_options(*options):
        chosen = importing.ImportOptions(**options)
    imported = importing.import_scenario(sources, chosen)
    with writing(output):
        save_scenario(imported.scenario, output)
    show(scenario_line(imported.scenario))
    show(facts({name: str(value) for name, value in imported.choices.items()}))
    for warning in imported.warnings:
        show(f"warning: {warning}")
    for reason in _no_plan(imported.scenario):
        show(f"no plan: {reason}")
    show(f"scenario written to {output}")
    return Code.OK


def _no_plan(scenario: Scenario) -> list[str]:
    """Return what rules out any plan at first sight, as `radmpc check` does."""
    reasons = sure_reasons(scenario, condensed_models(scenario))
    return [text for _, text in grouped(scenario, reasons)]
