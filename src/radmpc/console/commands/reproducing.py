"""The paper's study from the command line: run what is left, then write the report."""

from __future__ import annotations

import errno
import os
from collections.abc import Collection, Iterator
from contextlib import contextmanager
from pathlib import Path

from rich.console import Console
from rich.progress import (
    BarColumn,
    MofNCompleteColumn,
    Progress,
    TextColumn,
    TimeElapsedColumn,
    TimeRemainingColumn,
)

from radmpc.console.files import OutputError, writing
from radmpc.console.output import note, show
from radmpc.console.picture import drawing
from radmpc.console.running.guard import Code
from radmpc.console.running.interrupt import stop_on_interrupt
from radmpc.console.running.workers import workers
from radmpc.errors import FileFormatError, ScenarioError
from radmpc.experiments.study.design import Study, full_study, quick_study
from radmpc.experiments.study.journal import Journal, read_rows
from radmpc.experiments.study.running import Progress as Told
from radmpc.experiments.study.running import run_study
from radmpc.experiments.study.trial import Task
from radmpc.records import dataclass
from radmpc.wording import count_text

__all__ = ["StudyRequest", "run_reproduction"]

_CAP, _BUDGET, _SEEDS = 60.0, 600.0, 50

_DASK_WORKERS = 16
"""Tasks handed to a cluster at once, which says itself how many it works on."""


@dataclass(frozen=True, slots=True)
class StudyRequest:
    """What the command line asked for.

    Attributes
    ----------
    out : Path
        Folder of rows, report and figures.
    is_quick : bool
        Whether a small sample is enough.
    jobs : int
        Number of processes.
    dask : str or None
        Address of a Dask scheduler.
    cap, budget : float or None
        Seconds per problem, and for each mixed-integer reference; None is the study's.
    seeds : int or None
        Problems of each size; None is the study's.
    methods : tuple of str
        Methods to run; empty is all.
    is_report_only : bool
        Whether nothing is run.
    """

    out: Path
    is_quick: bool = False
    jobs: int = 1
    dask: str | None = None
    cap: float | None = None
    budget: float | None = None
    seeds: int | None = None
    methods: tuple[str, ...] = ()
    is_report_only: bool = False


def run_reproduction(request: StudyRequest) -> int:
    """Run what has no row yet, then write tables and figures.

    Returns
    -------
    int
        The exit code: 1 if it was interrupted.
    """
    study = _study(request)
    chosen = study.only(request.methods) if request.methods else study
    path = request.out / "rows.jsonl"
    _check_folder(path, request)
    was_interrupted = False
    if not request.is_report_only:
        was_interrupted = _run(chosen, path, request)
    rows = read_rows(path)
    if request.is_report_only:
        _check_cap(study.cap, {row.cap for row in rows}, path)
    from radmpc.experiments.study.report import (  # noqa: PLC0415 - pictures load slowly
        write_report,
    )

    with drawing(request.out):
        written = write_report(study, rows, request.out)
    methods = chosen.recorded({row.method for row in rows}).methods
    for skipped in (m for m in methods if not m.is_available):
        show(f"left out: {skipped.name} (package {skipped.package} is not installed)")
    show(f"{count_text(len(rows), 'row')} in {path}", *(f"written: {file}" for file in written))
    if was_interrupted:
        note(f"interrupted; the same command goes on with the other runs, rows are kept in {path}")
        return Code.NO
    return Code.OK


def _check_folder(path: Path, request: StudyRequest) -> None:
    """Make the folder of a run; refuse a report on rows that are not there."""
    if request.out.exists() and not request.out.is_dir():
        raise OutputError(f"cannot write {request.out}: {os.strerror(errno.ENOTDIR)}")
    if request.is_report_only and not path.exists():
        raise FileFormatError(
            f"{path}: {os.strerror(errno.ENOENT)}; --report-only needs the rows of a run"
        )
    with writing(request.out):
        request.out.mkdir(parents=True, exist_ok=True)


def _check_cap(cap: float, found: Collection[float], path: Path) -> None:
    """Refuse a report that no row counts in: tables without numbers would replace those there."""
    if found and cap not in found:
        caps = " or ".join(f"{one:g}" for one in sorted(found))
        raise FileFormatError(
            f"{path}: must have rows of a cap of {cap:g} s, got those of {caps} s: state that cap"
        )


def _study(request: StudyRequest) -> Study:
    """Return the study asked for."""
    if request.dask is not None and request.jobs > 1:
        raise ScenarioError("--dask and --jobs exclude each other")
    if request.is_quick:
        if (request.cap, request.budget, request.seeds) != (None, None, None):
            raise ScenarioError("--quick has its own cap, budget and seeds")
        study = quick_study()
    else:
        study = full_study(
            cap=_CAP if request.cap is None else request.cap,
            budget=_BUDGET if request.budget is None else request.budget,
            seeds=_SEEDS if request.seeds is None else request.seeds,
        )
    names = [method.name for method in study.methods]
    for name in request.methods:
        if name not in names:
            raise ScenarioError(f"--method must be among {'; '.join(names)}; got {name!r}")
    return study


def _run(study: Study, path: Path, request: StudyRequest) -> bool:
    """Run the study; return whether it was interrupted."""
    with (
        writing(path),
        Journal.opened(path) as journal,
        stop_on_interrupt() as is_stopped,
        workers(request.jobs, request.dask) as executor,
        _bar() as progress,
    ):
        count = _DASK_WORKERS if request.dask is not None else request.jobs
        run_study(
            study,
            journal,
            executor=executor,
            workers=count,
            progress=progress,
            stop=is_stopped,
        )
        return is_stopped()


@contextmanager
def _bar() -> Iterator[Told]:
    """Show a bar with the time left on stderr, if somebody can see it."""
    console = Console(stderr=True)
    if not console.is_terminal:
        yield lambda done, total, task: None
        return
    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        TimeElapsedColumn(),
        TextColumn("left"),
        TimeRemainingColumn(),
    )
    with Progress(*columns, console=console, speed_estimate_period=600.0) as bar:
        line = bar.add_task("runs", total=None)

        def tell(done: int, total: int, task: Task | None) -> None:
            text = "runs" if task is None else f"{task.method}, N = {task.vehicles}"
            bar.update(line, completed=done, total=total, description=text)

        yield tell
