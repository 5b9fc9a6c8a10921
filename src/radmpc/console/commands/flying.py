"""A plan flown from the command line: every tick on the disk, then a report."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from pathlib import Path

from radmpc.console.files import OutputError, check_output, check_separate, writing
from radmpc.console.loading import read_plan
from radmpc.console.output import note, show, show_json
from radmpc.console.picture import check_film, drawing
from radmpc.console.reports.flight import flight_json, flight_report
from radmpc.console.reports.progress import ProgressLine, progress_line
from radmpc.console.running.guard import Code
from radmpc.console.running.interrupt import stop_on_interrupt
from radmpc.errors import ArgumentError, FileFormatError, NoPlanError, RiskError, ScenarioError
from radmpc.flying.backends import backend_named
from radmpc.flying.recording.campaign import begin_flight, may_go_on, resume_flight
from radmpc.flying.recording.summary import FlightSummary, summary_of
from radmpc.io.flight.flight_file import is_flight, load_flight
from radmpc.io.flight.record import FlightRecord, FlightSettings
from radmpc.model.plan import Plan
from radmpc.planners.presets import parse_planner
from radmpc.records import dataclass
from radmpc.referee.claims.claims import shape_problems

__all__ = ["FlyRequest", "run_fly"]


@dataclass(frozen=True, slots=True)
class FlyRequest:
    """What the command line asked for; None is the default.

    Attributes
    ----------
    source : Path
        A plan; or a flight, to go on with.
    backend : str or None
        What it is flown with.
    replan : str or None
        What plans anew, or ``none``.
    missions : int or None
        How many times.
    deadline : float or None
        Seconds for each decision.
    seed : int or None
        Of all noise and of every plan.
    options : tuple of str
        ``KEY=VALUE`` for the backend.
    output, log, film : Path or None
        Where the flight, its log and its film go.
    as_json : bool
        Whether stdout gets JSON rather than the report.
    """

    source: Path
    backend: str | None = None
    replan: str | None = None
    missions: int | None = None
    deadline: float | None = None
    seed: int | None = None
    options: tuple[str, ...] = ()
    output: Path | None = None
    log: Path | None = None
    film: Path | None = None
    as_json: bool = False


def run_fly(request: FlyRequest) -> int:
    """Fly, report, and write what was asked for.

    Parameters
    ----------
    request : FlyRequest
        What was typed.

    Returns
    -------
    int
        The exit code: whether the collision rate is compatible with the bound.

    Raises
    ------
    ScenarioError, FileFormatError, OutputError
        If an option or a file cannot be used.
    NoPlanError
        If the plan cannot be flown: there is none, or it does not hold.
    """
    _check(request)
    goes_on = is_flight(request.source)
    if goes_on:
        _check_nothing_new(request)
    with (
        stop_on_interrupt("finishing this tick, what was flown is kept") as is_stopped,
        progress_line(keeps="what was flown", tell=note) as line,
    ):
        if goes_on:
            begun = load_flight(request.source)
            told = _Progress(line, begun)
            record = resume_flight(request.source, stop=is_stopped, progress=told)
        else:
            record = _begun(request, line, is_stopped)
        was_interrupted = is_stopped()
    summary = summary_of(record)
    if request.as_json:
        show_json(flight_json(record, summary))
    else:
        show(*flight_report(record, summary))
    _write(record, request)
    if was_interrupted and summary.missions < summary.asked:
        _tell_interrupted(request, record, summary)
        if not summary.missions:
            return Code.NO
    return _conclude(summary)


class _Progress:
    """Tells missions and steps on a line, also before the first tick, which may take long.

    How long the rest will take is told once a whole mission has been flown: its first steps take
    longest.
    """

    def __init__(self, line: ProgressLine, record: FlightRecord) -> None:
        self._line, self._record, self._left = line, record, ""
        under_way = [mission for mission in record.missions if not mission.is_over]
        self._next = flown = len(record.missions) - len(under_way)
        # Of a mission that goes on, it is not known how long it took.
        self._first, self._begun = flown + len(under_way), time.monotonic()
        if flown < record.settings.missions:
            self(flown, under_way[0].rows[-1].step if under_way else 0)

    def __call__(self, mission: int, step: int) -> None:
        """Tell a tick."""
        missions, steps = self._record.settings.missions, self._record.plan.scenario.horizon
        if mission > self._next:
            self._next = mission
            if mission == self._first:
                self._begun = time.monotonic()
            elif mission > self._first:
                each = (time.monotonic() - self._begun) / (mission - self._first)
                self._left = f"about {each * (missions - mission):.0f} s to go, "
        self._line(f"{self._left}mission {mission + 1}/{missions}, step", step, steps)


def _check(request: FlyRequest) -> None:
    """Refuse what would fail only after the flight."""
    check_output(request.output)
    check_output(request.log)
    if request.log is not None and request.log.suffix.lower() != ".mcap":
        raise FileFormatError(f"{request.log}: a log must end in .mcap")
    if request.log is not None:
        from radmpc.io.flight.mcap_log import check_library  # noqa: PLC0415 - few ask for a log

        check_library()
    check_film(request.film)
    check_separate(request.source, request.output, request.log, request.film)
    _check_names(request)
    if request.deadline is not None and math.isinf(request.deadline):
        raise ArgumentError(
            "--deadline must be finite, got inf; without it the planner's own limit holds"
        )
    if request.output is not None and is_flight(request.output):
        _check_over(request.output)


def _check_names(request: FlyRequest) -> None:
    """Refuse what nothing is called."""
    try:
        if request.backend is not None:
            backend_named(request.backend)
    except ArgumentError as error:
        raise ScenarioError(f"--with: {error}") from error
    try:
        if request.replan is not None and request.replan.strip() != "none":
            parse_planner(request.replan)
    except ScenarioError as error:
        raise ScenarioError(f"--replan: {error}; or none") from error


def _check_over(path: Path) -> None:
    """Refuse to write over a flight with which somebody may want to go on."""
    try:
        record = load_flight(path)
    except FileFormatError:
        return
    if sum(mission.is_over for mission in record.missions) < record.settings.missions:
        further = f"go on with 'radmpc fly {path}', or " if may_go_on(record) else ""
        raise OutputError(
            f"cannot write {path}: it holds a flight that is not over; {further}remove it"
        )


def _check_nothing_new(request: FlyRequest) -> None:
    """Refuse options that a flight under way has already."""
    given = {
        "--with": request.backend,
        "--replan": request.replan,
        "--missions": request.missions,
        "--deadline": request.deadline,
        "--seed": request.seed,
        "--option": request.options or None,
        "-o": request.output,
    }
    for name, value in given.items():
        if value is not None:
            raise ScenarioError(
                f"{name} cannot be given: {request.source} is a flight, which goes on as it began"
            )


def _begun(request: FlyRequest, line: ProgressLine, is_stopped: Callable[[], bool]) -> FlightRecord:
    """Fly a plan from its beginning."""
    plan = _flyable(request.source)
    replan = "certified" if request.replan is None else request.replan.strip()
    settings = FlightSettings(
        backend=request.backend or "model",
        replan=None if replan == "none" else replan,
        missions=request.missions or 1,
        seed=request.seed or 0,
        deadline=request.deadline,
        options=_options(request.options),
    )
    if settings.missions > 1 and settings.replan is not None and not request.as_json:
        steps = settings.missions * plan.scenario.horizon
        note(f"{replan} plans anew at {steps} steps; --replan none flies the plan as it is, sooner")
    told = _Progress(line, FlightRecord(plan, settings))
    try:
        return begin_flight(plan, settings, request.output, stop=is_stopped, progress=told)
    except RiskError as error:
        raise NoPlanError(f"{request.source}: cannot be flown: {error}") from error
    except ScenarioError as error:
        raise ScenarioError(f"{request.source}: {error}") from error


def _flyable(source: Path) -> Plan:
    """Return a plan whose controls fit its scenario."""
    plan = read_plan(source)
    if not plan.trajectories:
        why = plan.explanation or plan.status.sentence
        raise NoPlanError(f"{source}: cannot be flown: no plan: {why}")
    problems = shape_problems(plan)
    if problems:
        raise NoPlanError(f"{source}: cannot be flown: {problems[0]}")
    return plan


def _options(typed: tuple[str, ...]) -> dict[str, str]:
    """Return options by their names."""
    found: dict[str, str] = {}
    for word in typed:
        name, equals, value = (part.strip() for part in word.partition("="))
        if not (equals and name.isidentifier() and value) or name in found:
            raise ScenarioError(f"--option must be KEY=VALUE, every key once, got {word!r}")
        found[name] = value
    return found


def _write(record: FlightRecord, request: FlyRequest) -> None:
    """Write log and film; report each file once it is written."""
    written = [("flight", request.output)]
    if request.log is not None:
        from radmpc.io.flight.mcap_log import write_log  # noqa: PLC0415 - few ask for a log
        from radmpc.system.atomic import write_bytes  # noqa: PLC0415 - few ask for a log

        with writing(request.log):
            write_bytes(request.log, write_log(record))
        written.append(("log", request.log))
    if request.film is not None and record.rows:
        from radmpc.plotting import save_flight_film  # noqa: PLC0415 - matplotlib loads slowly

        with drawing(request.film):
            save_flight_film(record, request.film)
        written.append(("film", request.film))
    lines = [f"{name} written to {path}" for name, path in written if path is not None]
    if lines and not request.as_json:
        show("", *lines)


def _tell_interrupted(request: FlyRequest, record: FlightRecord, summary: FlightSummary) -> None:
    """Say on stderr how far a flight got, and how it goes on if it can."""
    over = f"{summary.missions} of {summary.asked} missions are over"
    path = request.source if is_flight(request.source) else request.output
    if path is None:
        further = ""
    elif may_go_on(record):
        further = f"; go on with 'radmpc fly {path}'"
    else:
        further = f"; {record.settings.backend} cannot go on in the middle of a mission"
    note(f"interrupted: {over}{further}")


def _conclude(summary: FlightSummary) -> Code:
    """Say on stderr what speaks against the flight, and return the exit code."""
    if summary.contradiction is not None:
        note(summary.contradiction)
        return Code.NO
    return Code.OK
