"""Planners side by side from the command line."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from rich.table import Table
from rich.text import Text

from radmpc.console.files import writing
from radmpc.console.guard import Code
from radmpc.console.interrupt import stop_on_interrupt
from radmpc.console.output import note, show, show_json
from radmpc.console.picture import check_picture
from radmpc.console.progress import progress_line
from radmpc.console.words import scenario_line
from radmpc.console.workers import workers
from radmpc.errors import ScenarioError
from radmpc.experiments.comparing import Comparison, compare
from radmpc.model.scenario import Scenario
from radmpc.planners.presets import parse_planner

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
        Flights per plan.
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
        parse_planner(name)
        if request.planners.count(name) > 1:
            raise ScenarioError(f"--planners names {name!r} twice")
    if request.dask is not None and request.jobs > 1:
        raise ScenarioError("--dask and --jobs exclude each other")
    check_picture(request.figure)


def run_compare(scenario: Scenario, request: CompareRequest) -> int:
    """Plan with every planner, write the picture and report.

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
        found.extend(
            compare(
                scenario,
                request.planners,
                rng=request.seed,
                time_limit=request.time_limit,
                samples=request.samples,
                executor=executor,
                progress=progress,
                stop=is_stopped,
            )
        )
        was_interrupted = is_stopped()
    if request.figure is not None:
        _write_panels(found, request.figure)
    if request.as_json:
        show_json({"scenario": scenario.name, "planners": [_as_json(one) for one in found]})
    else:
        show(Text(scenario_line(scenario), style="bold"), comparison_table(found))
        _show_reasons(found)
        if request.figure is not None:
            show(f"picture written to {request.figure}")
    if was_interrupted:
        note("interrupted: planners that had not begun are left out")
    return Code.OK if any(one.is_within for one in found) else Code.NO


def comparison_table(found: Sequence[Comparison]) -> Table:
    """Return a line per planner: status, cost, certificate, simulation, sets and seconds."""
    table = Table(box=None, pad_edge=False, padding=(0, 2, 0, 0))
    table.add_column("planner", no_wrap=True)
    table.add_column("status", no_wrap=True)
    for column in ("cost", "above least", "certificate", "collide (95 %)", "sets", "largest"):
        table.add_column(column, no_wrap=True, justify="right")
    table.add_column("seconds", no_wrap=True, justify="right")
    costs = [one.result.cost for one in found if one.is_within and one.result is not None]
    least = min((cost for cost in costs if cost is not None), default=None)
    for one in found:
        table.add_row(*_cells(one, least))
    return table


def _cells(one: Comparison, least: float | None) -> list[Text | str]:
    """Return one line of the table; what is not within the bound is red."""
    result, flown = one.result, one.simulation
    if result is None:
        return [one.planner, Text("failed", style="red")]
    seconds = f"{result.seconds['total']:.2f}"
    if result.plan is None or result.cost is None or result.certificate is None:
        status = Text(result.status.value, style="red")
        return [one.planner, status, "–", "–", "–", "–", "–", "–", seconds]
    style = "green" if one.is_within else "red"
    certified = result.certificate.certified
    sizes = [len(members) for members in result.sets]
    above = "–" if not least else f"{100.0 * (result.cost / least - 1.0):+.2f} %"
    return [
        one.planner,
        result.status.value,
        f"{result.cost:.4g}",
        above,
        Text(f"{certified:.4g}" if certified <= 1.0 else "1", style=style),
        "–" if flown is None else f"{flown.rate:.4g} ({flown.rate_low:.2g}–{flown.rate_high:.2g})",
        str(len(sizes)),
        str(max(sizes)),
        seconds,
    ]


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
        with writing(path):
            save_panels(panels, path)
