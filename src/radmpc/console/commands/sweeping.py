"""A sweep from the command line: plan what is left, one row for each, a table and a curve."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from contextlib import closing, contextmanager
from pathlib import Path

from radmpc.arguments import is_number
from radmpc.console.choosing import planner_with
from radmpc.console.files import check_output, check_separate, writing
from radmpc.console.output import note, show, show_json
from radmpc.console.picture import check_picture, drawing
from radmpc.console.reports.progress import progress_line
from radmpc.console.reports.sweep_table import sweep_report
from radmpc.console.running.guard import Code
from radmpc.console.running.interrupt import stop_on_interrupt
from radmpc.console.running.workers import workers
from radmpc.errors import ScenarioError
from radmpc.experiments.sweep_table import SweepRow, SweepTable, scenario_digest, sweep_row
from radmpc.experiments.sweeping import Values, sweep, sweep_scenarios
from radmpc.model.scenario import Scenario
from radmpc.planners.planner import Planner
from radmpc.records import dataclass
from radmpc.wording import count_text

__all__ = ["SweepRequest", "run_sweep"]


@dataclass(frozen=True, slots=True)
class SweepRequest:
    """What the command line asked for.

    Attributes
    ----------
    source : Path
        The scenario's file.
    over : mapping of str to sequence
        Values by key.
    planner : str
        A planner's name.
    seed : int
        Seed of every random choice.
    time_limit : float or None
        Seconds for each scenario; None leaves it to the planner.
    gap : float or None
        Relative gap that ends each search; None is the planner's own.
    jobs : int
        Number of processes.
    output : Path or None
        Table of rows, CSV; scenarios in it are not planned again.
    figure : Path or None
        Where the curves go.
    as_json : bool
        Whether stdout gets JSON rather than a table.
    """

    source: Path
    over: Mapping[str, Sequence[object]]
    planner: str
    seed: int = 0
    time_limit: float | None = None
    gap: float | None = None
    jobs: int = 1
    output: Path | None = None
    figure: Path | None = None
    as_json: bool = False

    @property
    def record(self) -> Planner:
        """The planner's choices.

        Raises
        ------
        ScenarioError
            If there is no such planner, or the gap is none.
        """
        return planner_with(self.planner, self.gap)


def run_sweep(request: SweepRequest) -> int:
    """Plan every combination of values that is not in the table yet, and report on all.

    Parameters
    ----------
    request : SweepRequest
        What was typed.

    Returns
    -------
    int
        The exit code: 0 if every scenario has a plan certified within its bound.
    """
    planner = request.record
    check_output(request.output)
    check_picture(request.figure)
    check_separate(request.source, request.output, request.figure)
    scenarios = sweep_scenarios(request.source, request.over)
    with _table(request) as table:
        rows = {} if table is None else _known(table, scenarios)
        was_interrupted = _plan_missing(request, planner, scenarios, rows, table)
    found = [rows[values] for values in scenarios if values in rows]
    _report(request, found)
    if was_interrupted:
        goes_on = "" if table is None else "; the same command goes on"
        note(f"interrupted after {len(found)} of {len(scenarios)} scenarios{goes_on}")
        return Code.NO
    lacking = sum(not row.within for row in found)
    if not lacking:
        return Code.OK
    whose = f"{lacking} of {count_text(len(found), 'scenario')}"
    note(f"no plan that is certified within the risk bound for {whose}")
    return Code.NO


def _plan_missing(
    request: SweepRequest,
    planner: Planner,
    scenarios: Mapping[Values, Scenario],
    rows: dict[Values, SweepRow],
    table: SweepTable | None,
) -> bool:
    """Plan what has no row yet, and add its rows; return whether Ctrl-C ended it."""
    with (
        stop_on_interrupt() as is_stopped,
        workers(request.jobs, None) as executor,
        progress_line() as progress,
    ):
        for point in sweep(
            scenarios,
            planner,
            rng=request.seed,
            time_limit=request.time_limit,
            done=rows,
            executor=executor,
            progress=progress,
            stop=is_stopped,
        ):
            rows[point.values] = sweep_row(point)
            if table is not None and request.output is not None:
                with writing(request.output):
                    table.append(rows[point.values])
        return is_stopped()


@contextmanager
def _table(request: SweepRequest) -> Iterator[SweepTable | None]:
    """Open the table that rows are kept in, for this process alone."""
    if request.output is None:
        yield None
        return
    question = [request.planner.strip(), f"seed={request.seed}"]
    if request.time_limit is not None:
        question.append(f"time_limit={request.time_limit:g}")
    if request.gap is not None:
        question.append(f"gap={request.gap:g}")
    with writing(request.output):
        table = SweepTable(request.output, tuple(request.over), question)
    with closing(table):
        yield table


def _known(table: SweepTable, scenarios: Mapping[Values, Scenario]) -> dict[Values, SweepRow]:
    """Return the rows that are of these scenarios, by their values.

    Raises
    ------
    ScenarioError
        If a row is of another scenario at the same values.
    """
    rows = {row.values: row for row in table.rows}
    for values, scenario in scenarios.items():
        row = rows.get(values)
        if row is not None and row.scenario != scenario_digest(scenario):
            raise ScenarioError(
                f"{table.path}: its row at {', '.join(values)} is of another scenario than the "
                "file holds now: choose another table"
            )
    return rows


def _report(request: SweepRequest, rows: Sequence[SweepRow]) -> None:
    """Tell what was found, and draw it."""
    axes = tuple(request.over)
    if request.as_json:
        show_json({"over": list(axes), "rows": [_as_json(axes, row) for row in rows]})
    elif rows:
        show(*sweep_report(axes, rows))
    if not rows:
        return
    if request.figure is not None:
        _draw(axes, rows, request.figure)
    written = (("table", request.output), ("picture", request.figure))
    lines = [f"{name} written to {path}" for name, path in written if path is not None]
    if lines and not request.as_json:
        show("", *lines)


def _draw(axes: Sequence[str], rows: Sequence[SweepRow], path: Path) -> None:
    """Draw costs over the first key, a curve for each combination of the others."""
    from radmpc.plotting import CostPoint, plot_costs, save_axes  # noqa: PLC0415 - loads slowly

    def point(row: SweepRow) -> CostPoint:
        value = json.loads(row.values[0])
        rest = zip(axes[1:], row.values[1:], strict=True)
        return CostPoint(
            float(value) if is_number(value) else row.values[0].strip('"'),
            ", ".join(f"{key} {word}" for key, word in rest),
            row.cost,
            row.lower_bound,
            row.within,
        )

    with drawing(path):
        save_axes(plot_costs(axes[0], [point(row) for row in rows]), path)


def _as_json(axes: Sequence[str], row: SweepRow) -> dict[str, object]:
    """Return plain values."""
    return {
        **{key: json.loads(word) for key, word in zip(axes, row.values, strict=True)},
        "status": row.status,
        "cost": row.cost,
        "lower_bound": row.lower_bound,
        "certified": row.certified,
        "is_within": row.within,
        "seconds": row.seconds,
        "problem": row.problem,
    }
