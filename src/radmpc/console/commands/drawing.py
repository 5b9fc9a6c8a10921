"""Pictures and films of files that are there already."""

from __future__ import annotations

from pathlib import Path

from radmpc.console.completing import VIEWS
from radmpc.console.files import check_output, check_separate
from radmpc.console.output import note, show
from radmpc.console.picture import check_film, drawing, write_film
from radmpc.console.running.guard import Code
from radmpc.console.words import first_of
from radmpc.errors import ArgumentError, FileFormatError, ScenarioError
from radmpc.io.flight.flight_file import is_flight, load_flight
from radmpc.io.native.plan_file import load_plan
from radmpc.io.native.scenario_file import load_scenario
from radmpc.io.ranges import PLAN_FORMAT
from radmpc.io.text.document import read_document
from radmpc.io.text.files import one_line
from radmpc.model.plan import Plan
from radmpc.model.scenario import Scenario
from radmpc.referee.claims.claims import shape_problems
from radmpc.referee.claims.statements import ledger_problems

__all__ = ["run_draw"]

_FILMS = (".gif", ".mp4")


def run_draw(source: Path, view: str | None, output: Path) -> int:
    """Draw a scenario, a plan or a flight from its file.

    Parameters
    ----------
    source : Path
        Scenario, plan or flight.
    view : str or None
        One of `VIEWS`; None is the plan, or the scenario.
    output : Path
        Picture or film, by its ending.

    Returns
    -------
    int
        The exit code.

    Raises
    ------
    ScenarioError
        If there is no such view, or not of a scenario, or not as a film.
    FileFormatError
        If a file's format is unknown, or a plan does not fit its own scenario.
    OutputError
        If the picture cannot be written.
    """
    is_film = output.suffix.lower() in _FILMS
    if view is not None and view not in VIEWS:
        raise ScenarioError(f"--view must be one of {', '.join(VIEWS)}, got {view!r}")
    if is_film and view not in {None, "plan"}:
        raise ScenarioError(f"--view {view} cannot be a film: use .png, .pdf or .svg")
    if is_film:
        check_film(output)
    else:
        _check_picture(output)
    check_separate(source, output)
    if is_flight(source):
        return _draw_flight(source, view, output, is_film=is_film)
    value = _load(source)
    if isinstance(value, Scenario) and (is_film or view is not None):
        raise FileFormatError(f"{source}: is a scenario, and only a plan has films and views")
    if isinstance(value, Plan):
        _check_drawable(value, source)
    if isinstance(value, Plan) and is_film:
        write_film(value, output)
    else:
        _draw(value, view or "plan", output)
    show(f"{'film' if is_film else 'picture'} written to {output}")
    return Code.OK


def _check_drawable(plan: Plan, source: Path) -> None:
    """Refuse a plan whose arrays or ledger do not fit its scenario; others are drawn as they are.

    What has no trajectories is drawn as its scenario.
    """
    problems = shape_problems(plan) if plan.trajectories else []
    problems += ledger_problems(plan)
    if problems:
        raise FileFormatError(one_line(f"{source}: cannot be drawn: {first_of(problems)}"))


def _draw_flight(source: Path, view: str | None, output: Path, *, is_film: bool) -> Code:
    """Draw a flight, or film it."""
    from radmpc.plotting import save_flight, save_flight_film  # noqa: PLC0415 - loads slowly

    if view is not None:
        raise ScenarioError(f"--view is for plans, and {source} is a flight")
    record = load_flight(source)
    problems = shape_problems(record.plan)
    if problems:
        raise FileFormatError(f"{source}:1: plan: {problems[0]}")
    try:
        with drawing(output):
            (save_flight_film if is_film else save_flight)(record, output)
    except ArgumentError as error:
        raise FileFormatError(f"{source}: cannot be drawn: {error}") from error
    if record.doubts:
        held = f"'radmpc verify {source}' says what does not hold"
        note(f"warning: {source}: {record.doubts}; {held}")
    show(f"{'film' if is_film else 'picture'} written to {output}")
    return Code.OK


def _check_picture(path: Path) -> None:
    """Refuse a picture that could not be written."""
    from radmpc.plotting import FIGURE_SUFFIXES  # noqa: PLC0415 - matplotlib loads slowly

    if path.suffix.lower() not in FIGURE_SUFFIXES:
        known = ", ".join((*FIGURE_SUFFIXES, *_FILMS))
        raise FileFormatError(f"{path}: a picture or film must end in {known}")
    check_output(path)


def _load(source: Path) -> Scenario | Plan:
    """Return what a file holds."""
    content = read_document(source).value
    is_plan = isinstance(content, dict) and content.get("format") == PLAN_FORMAT
    return load_plan(source) if is_plan else load_scenario(source)


def _draw(value: Scenario | Plan, view: str, output: Path) -> None:
    """Draw one view into a file."""
    from radmpc import plotting  # noqa: PLC0415 - matplotlib loads slowly

    with drawing(output):
        if isinstance(value, Scenario):
            plotting.save_axes(plotting.plot_scenario(value), output)
        elif view == "plan":
            plotting.save_figure(value, output)
        elif view == "ledger":
            plotting.save_ledger(value, output)
        else:
            draw = {
                "couplings": plotting.plot_couplings,
                "distances": plotting.plot_distances,
                "risk": plotting.plot_risk,
            }[view]
            plotting.save_axes(draw(value), output)
