"""One planning run from the command line: plan, write, report."""

from __future__ import annotations

from pathlib import Path

from radmpc.console.choosing import planner_with
from radmpc.console.files import check_output, check_separate, writing
from radmpc.console.output import note, show, show_json
from radmpc.console.picture import (
    check_film,
    check_picture,
    write_film,
    write_ledger,
    write_picture,
)
from radmpc.console.reports.progress import progress_line
from radmpc.console.reports.report import plan_report
from radmpc.console.reports.stages import stage_notes
from radmpc.console.running.guard import Code
from radmpc.console.running.interrupt import stop_on_interrupt
from radmpc.console.running.workers import workers
from radmpc.errors import RadmpcError, ScenarioError
from radmpc.io.native.encoding import encode_scenario
from radmpc.io.native.plan_file import encode_plan, load_plan, save_plan
from radmpc.model.ledger import bound_texts
from radmpc.model.plan import Plan, Status
from radmpc.model.scenario import Scenario
from radmpc.planners.planner import Planner
from radmpc.planning import plan, seconds_allowed
from radmpc.records import dataclass
from radmpc.result import Result

__all__ = ["Request", "check_request", "run_plan"]


@dataclass(frozen=True, slots=True)
class Request:
    """What the command line asked for.

    Attributes
    ----------
    planner : str
        A planner's name.
    seed : int
        Seed of every random choice.
    time_limit : float or None
        Seconds; None leaves it to the planner: 60 for `certified`, no limit for others.
    jobs : int
        Number of processes.
    dask : str or None
        Address of a Dask scheduler.
    source : Path or None
        The scenario's file, which no output may replace.
    gap : float or None
        Relative gap that ends the search; None is the planner's own.
    is_verbose : bool
        Whether stages are told on stderr.
    output, figure, ledger, animation : Path or None
        Where the plan, its picture, that of its risk and its film go; None writes none.
    as_json : bool
        Whether stdout gets JSON rather than the report.
    """

    planner: str
    seed: int
    time_limit: float | None = None
    jobs: int = 1
    output: Path | None = None
    figure: Path | None = None
    as_json: bool = False
    ledger: Path | None = None
    dask: str | None = None
    is_verbose: bool = False
    animation: Path | None = None
    source: Path | None = None
    gap: float | None = None

    @property
    def record(self) -> Planner:
        """The planner's choices, the gap among them.

        Raises
        ------
        ScenarioError
            If there is no such planner, or the gap is none.
        """
        return planner_with(self.planner, self.gap)


def check_request(request: Request) -> None:
    """Refuse what would fail only after the planning is done.

    Raises
    ------
    ScenarioError
        If there is no such planner, or no such gap.
    FileFormatError
        If the picture's format is unknown.
    OutputError
        If an output cannot be written.
    """
    _ = request.record
    if request.dask is not None and request.jobs > 1:
        raise ScenarioError("--dask and --jobs exclude each other")
    check_output(request.output)
    check_picture(request.figure)
    check_picture(request.ledger)
    check_film(request.animation)
    outputs = (request.output, request.figure, request.ledger, request.animation)
    check_separate(request.source, *outputs)


def run_plan(scenario: Scenario, request: Request) -> int:
    """Plan a scenario, write what was asked for and report.

    Parameters
    ----------
    scenario : Scenario
        The scenario to plan.
    request : Request
        What was typed.

    Returns
    -------
    int
        The exit code.
    """
    planner = request.record
    with (
        stop_on_interrupt() as is_stopped,
        workers(request.jobs, request.dask) as executor,
        stage_notes(request.is_verbose),
        progress_line(
            is_shown=not request.is_verbose,
            is_planning=True,
            seconds=seconds_allowed(planner, request.time_limit),
        ) as progress,
    ):
        result = plan(
            scenario,
            planner,
            rng=request.seed,
            time_limit=request.time_limit,
            executor=executor,
            progress=progress,
            stop=is_stopped,
            found=progress.found,
        )
        was_interrupted = is_stopped()
    kept = request.output is not None and _is_to_keep(request.output, result.record)
    if request.output is not None and not kept:
        with writing(request.output):
            save_plan(result.record, request.output)
    if request.as_json:
        show_json(encode_plan(result.record, with_vehicles=False))
    else:
        report = plan_report(
            result.record,
            request.planner.strip(),
            len(result.events),
            bounds_risk=planner.bounds_risk,
        )
        what = "plan" if result.record.trajectories else "result"
        show(*report, *(_kept(request.output) if kept else _written(what, request.output)))
    # Films take longer than many a plan: whoever interrupts one has read the report.
    _draw(result.record, request)
    return _conclude(result, was_interrupted, not request.as_json)


def _is_to_keep(path: Path, record: Plan) -> bool:
    """Whether a file holds a plan of this scenario, and a run that was cut short found none.

    That no plan exists is an answer, and replaces it.
    """
    if record.status is not Status.LIMIT or record.trajectories or not path.is_file():
        return False
    try:
        known = load_plan(path)
    except RadmpcError:
        return False
    is_same = encode_scenario(known.scenario) == encode_scenario(record.scenario)
    return bool(known.trajectories) and is_same


def _kept(path: Path | None) -> list[str]:
    """Return an empty line and one about a file that stays as it is."""
    return ["", f"{path} kept: it holds a plan of this scenario, and this run found none"]


def _draw(record: Plan, request: Request) -> None:
    """Write the pictures and the film that were asked for; report each file once it is written."""
    is_first = request.output is None
    for name, path, write in (
        ("picture", request.figure, write_picture),
        ("risk ledger", request.ledger, write_ledger),
        ("film", request.animation, write_film),
    ):
        if path is None:
            continue
        write(record, path)
        if not request.as_json:
            show(*_written(name, path)[0 if is_first else 1 :])
        is_first = False


def _written(name: str, path: Path | None) -> list[str]:
    """Return an empty line and one about a file; nothing without a file."""
    return [] if path is None else ["", f"{name} written to {path}"]


def _no_plan(record: Plan, is_reported: bool) -> str:
    """Return that there is no plan, and why unless the report has just said so."""
    if not record.explanation:
        return record.status_sentence
    if is_reported:
        return f"no plan ({record.status.value}): the report says why"
    return f"no plan: {record.explanation}"


def _conclude(result: Result, was_interrupted: bool, is_reported: bool) -> Code:
    """Say on stderr what stands against using the plan, and return the exit code."""
    record = result.record
    if result.plan is None and was_interrupted:
        note("interrupted before any plan was found")
        return Code.NO
    if result.plan is None:
        note(_no_plan(record, is_reported))
        return Code.NO
    if not result.is_certified:
        certified, bound = record.risk.certified, record.risk.bound
        problems = () if result.certificate is None else result.certificate.problems
        if certified is not None and certified > bound:
            risk, limit = bound_texts(certified, bound)
            note(f"the certificate {risk} exceeds the risk bound {limit}")
        else:
            note(f"the plan is not certified: {'; '.join(problems) or 'no certificate'}")
        return Code.NO
    return Code.OK
