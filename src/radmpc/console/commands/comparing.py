"""Planners side by side from the command line."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from rich.text import Text

from radmpc.console.output import note, show, show_json, width
from radmpc.console.picture import check_picture, drawing
from radmpc.console.reports.comparison_table import comparison_line, comparison_table
from radmpc.console.reports.progress import progress_line
from radmpc.console.running.guard import Code
from radmpc.console.running.interrupt import stop_on_interrupt
from radmpc.console.running.workers import workers
from radmpc.console.words import scenario_line
from radmpc.errors import ScenarioError
from radmpc.experiments.comparing import Comparison, compare
from radmpc.model.scenario import Scenario
from radmpc.planners.presets import parse_planner
from radmpc.records import dataclass

__all__ = ["CompareRequest", "check_compare", "run_compare"]


@dataclass(frozen=True, slots=True)
class CompareRequest:
    """What the command line asked for.

    Attributes
    ----------
    planners : tuple of str
        Names.
    seed : int
        Seed of every random choice.
    time_limit : float or None
        Seconds for each planner.
    samples : int
        Samples per plan.
    jobs : int
        Number of processes.
    dask : str or None
        Address of a Dask scheduler.
    figure : Path or None
        Where the picture goes.
    as_json : bool
        Whether stdout gets JSON rather than a table.
    """

    planners: tuple[str, ...]
    seed: int = 0
    time_limit: float | None = None
    samples: int = 100_000
    jobs: int = 1
    dask: str | None = None
    figure: Path | None = None
    as_json: bool = False


def check_compare(request: CompareRequest) -> None:
    """Refuse what would fail only after the planning is done.

    Raises
    ------
    ScenarioError
        If a planner is unknown, none is named or one is named twice.
    FileFormatError, OutputError
        If the picture cannot be written.
    """
    if not request.planners:
        raise ScenarioError("--planners must name at least one planner, got none")
    for name in request.planners:
        try:
            parse_planner(name)
        except ScenarioError as error:
            raise ScenarioError(f"--planners: {error}") from error
        if request.planners.count(name) > 1:
            raise ScenarioError(f"--planners names {name!r} twice")
    if request.dask is not None and request.jobs > 1:
        raise ScenarioError("--dask and --jobs exclude each other")
    check_picture(request.figure)


def run_compare(scenario: Scenario, request: CompareRequest) -> int:
    """Plan with every planner, report and write the picture.

    Parameters
    ----------
    scenario : Scenario
        The scenario to plan.
    request : CompareRequest
        What was typed.

    Returns
    -------
    int
        The exit code: 0 if any plan is certified within the bound.
    """
    found: list[Comparison] = []
    with (
        stop_on_interrupt() as is_stopped,
        workers(request.jobs, request.dask) as executor,
        progress_line() as progress,
    ):
        for one in compare(
            scenario,
            request.planners,
            rng=request.seed,
            time_limit=request.time_limit,
            samples=request.samples,
            executor=executor,
            progress=progress,
            stop=is_stopped,
        ):
            found.append(one)
            if len(request.planners) > 1:
                progress.keep(comparison_line(one))
        was_interrupted = is_stopped()
    if request.as_json:
        show_json({"scenario": scenario.name, "planners": [_as_json(one) for one in found]})
    else:
        show(Text(scenario_line(scenario), style="bold"), comparison_table(found, width()))
        _show_reasons(found)
    if request.figure is not None:
        # After the report: whoever interrupts the picture keeps the comparison.
        _write_panels(found, request.figure)
        if not request.as_json:
            show(f"picture written to {request.figure}")
    is_any_within = any(one.is_within for one in found)
    if was_interrupted:
        note(f"interrupted: {_left_out(request.planners[len(found) :])}")
    elif not is_any_within:
        note("no planner has a plan that is certified within the risk bound")
    return Code.OK if is_any_within else Code.NO


def _left_out(planners: Sequence[str]) -> str:
    """Return which planners an interruption has left out."""
    if not planners:
        return "every planner had begun"
    return f"planners that had not begun are left out: {', '.join(planners)}"


def _show_reasons(found: Sequence[Comparison]) -> None:
    """Say why planners have no plan."""
    for one in found:
        result = one.result
        reason = one.problem if result is None else result.explanation
        if reason and (result is None or result.plan is None):
            show(Text(f"{one.planner}: {reason}", style="red"))


def _as_json(one: Comparison) -> dict[str, object]:
    """Return plain values."""
    result, flown = one.result, one.simulation
    values: dict[str, object] = {"planner": one.planner, "problem": one.problem}
    if result is None:
        return values | {"status": "failed"}
    return values | {
        "status": result.status.value,
        "stopped_by": result.record.stopped_by,
        "explanation": result.explanation,
        "cost": result.cost,
        "lower_bound": result.lower_bound,
        "certified": None if result.certificate is None else result.certificate.certified,
        "is_within": one.is_within,
        "rate": None if flown is None else flown.rate,
        "rate_low": None if flown is None else flown.rate_low,
        "rate_high": None if flown is None else flown.rate_high,
        "samples": 0 if flown is None else flown.samples,
        "sets": [list(members) for members in result.sets],
        "seconds": dict(result.seconds),
    }


def _write_panels(found: Sequence[Comparison], path: Path) -> None:
    """Draw every planner's answer into one picture."""
    from radmpc.plotting import Panel, save_panels  # noqa: PLC0415 - matplotlib loads slowly

    panels = [Panel(one.planner, one.result.record) for one in found if one.result is not None]
    if panels:
        with drawing(path):
            save_panels(panels, path)
