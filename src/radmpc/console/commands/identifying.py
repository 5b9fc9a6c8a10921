"""Noise and feedback from logs."""

from __future__ import annotations

from datetime import UTC, datetime
from pathlib import Path

from rich.text import Text

from radmpc.console.files import check_output, check_separate, file_of, writing
from radmpc.console.options import named_options
from radmpc.console.output import show, show_json
from radmpc.console.picture import check_picture, drawing
from radmpc.console.reports.noise import noise_report
from radmpc.console.reports.noise_values import identification_json
from radmpc.console.running.guard import Code
from radmpc.errors import FileFormatError, ScenarioError
from radmpc.identification import Identification, identify
from radmpc.importing.logs.applying import noise_text, with_noise
from radmpc.importing.logs.csv_log import MissingColumnError
from radmpc.importing.logs.reading import read_logs
from radmpc.importing.logs.recording import Recording
from radmpc.io.native.scenario_file import load_scenario, save_scenario
from radmpc.model.scenario import Scenario
from radmpc.records import dataclass
from radmpc.system.atomic import write_text

__all__ = ["IdentifyRequest", "parse_columns", "run_identify"]


@dataclass(frozen=True, slots=True)
class IdentifyRequest:
    """What the command line asked for.

    Attributes
    ----------
    logs : tuple of Path
        Files and folders of logs.
    output : Path or None
        Where the noise goes, or with a scenario the new one.
    scenario : Path or None
        The scenario that gets the noise.
    dt : float or None
        Step [s]; None is the scenario's, or the logs' own.
    columns : str or None
        Names of columns, as typed.
    plot : Path or None
        Where the picture of the residuals goes.
    as_json : bool
        Whether stdout gets JSON rather than a table.
    """

    logs: tuple[Path, ...]
    output: Path | None = None
    scenario: Path | None = None
    dt: float | None = None
    columns: str | None = None
    plot: Path | None = None
    as_json: bool = False


def run_identify(request: IdentifyRequest) -> int:
    """Identify, report, and write what was asked for.

    Parameters
    ----------
    request : IdentifyRequest
        What was typed.

    Returns
    -------
    int
        The exit code.

    Raises
    ------
    ScenarioError
        If an option is out of range, or the scenario does not go with the logs.
    FileFormatError, OutputError
        If a log cannot be used, or something not be written.
    """
    _check(request)
    scenario = None if request.scenario is None else load_scenario(request.scenario)
    found = _identified(request, scenario)
    day = datetime.now(tz=UTC).strftime("%Y-%m-%d")
    changed = None if scenario is None else with_noise(scenario, found, day)
    if request.as_json:
        show_json(identification_json(found))
    else:
        show(*noise_report(found))
        for warning in () if changed is None else changed[1]:
            show(Text(f"warning: {warning}", style="yellow"))
    if request.output is not None:
        with writing(request.output):
            if changed is None:
                write_text(request.output, noise_text(found, day))
            else:
                save_scenario(changed[0], request.output)
        _tell(request, f"{'noise' if changed is None else 'scenario'} written to {request.output}")
    if request.plot is not None:
        _draw(found, request.plot)
        _tell(request, f"picture written to {request.plot}")
    return Code.OK


def _check(request: IdentifyRequest) -> None:
    """Refuse what would fail only after the work is done."""
    if request.scenario is not None and request.output is None:
        raise ScenarioError("--scenario needs -o: the scenario with the noise is written there")
    check_output(request.output)
    check_picture(request.plot)
    check_separate(request.scenario, request.output, request.plot)
    for i, path in enumerate(request.logs):
        check_separate(path, request.output, request.plot)
        if file_of(path) in {file_of(other) for other in request.logs[:i]}:
            raise FileFormatError(f"{path}: is named twice, and would count twice")
    output = request.output
    if output is not None and request.scenario is None and output.suffix not in {".yaml", ".yml"}:
        raise FileFormatError(f"{output}: noise is written as .yaml")


def _identified(request: IdentifyRequest, scenario: Scenario | None) -> Identification:
    """Return what the logs tell at the scenario's step."""
    with named_options("columns", "dt"):
        recording = _read(request)
        if scenario is not None and request.dt not in {None, scenario.dt}:
            raise ScenarioError(
                f"is {request.dt:g} s, and the scenario's is {scenario.dt:g} s", ("dt",)
            )
        return identify(
            recording.tracks,
            dt=request.dt if scenario is None else scenario.dt,
            dimension=None if scenario is None else scenario.dimension,
            warnings=recording.warnings,
        )


def _read(request: IdentifyRequest) -> Recording:
    """Return what the logs hold; a missing column is told with the option that names it."""
    try:
        return read_logs(request.logs, parse_columns(request.columns))
    except MissingColumnError as error:
        typed = ",".join(f"{key}={called}" for key, called in error.names.items())
        text = str(error).replace(error.cure, f"use --columns {typed}")
        raise FileFormatError(text) from error


def parse_columns(typed: str | None) -> dict[str, str]:
    """Return names of columns by what they hold.

    Parameters
    ----------
    typed : str or None
        ``time=t,x=east``; None is nothing.

    Raises
    ------
    ScenarioError
        If it is spelled another way.
    """
    found: dict[str, str] = {}
    for part in () if typed is None else typed.split(","):
        name, equals, column = (word.strip() for word in part.partition("="))
        if not (equals and name and column) or name in found:
            raise ScenarioError(
                f"must be like time=t,x=east, every name once, got {typed!r}", ("columns",)
            )
        found[name] = column
    return found


def _tell(request: IdentifyRequest, line: str) -> None:
    """Say what was written, unless stdout is for JSON."""
    if not request.as_json:
        show(line)


def _draw(found: Identification, path: Path) -> None:
    """Draw the residuals into a file."""
    from radmpc.plotting.residuals import plot_residuals  # noqa: PLC0415 - matplotlib loads slowly
    from radmpc.plotting.save import save_axes  # noqa: PLC0415 - matplotlib loads slowly

    with drawing(path):
        save_axes(plot_residuals(found)[0], path)
