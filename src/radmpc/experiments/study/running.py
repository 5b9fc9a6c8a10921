"""Doing what is left of a study, one durable row at a time."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from concurrent.futures import FIRST_COMPLETED, Executor, Future, wait

from radmpc.experiments.study.design import Study
from radmpc.experiments.study.journal import Journal, read_rows
from radmpc.experiments.study.trial import Row, Task, run_task
from radmpc.records import dataclass
from radmpc.solvers.solution import never

__all__ = ["Progress", "run_study"]

_POLL_SECONDS = 0.2
"""Time between two looks for ended runs [s]: what an interrupt may wait."""

_AHEAD = 2
"""Tasks handed out beyond those being worked on."""

Progress = Callable[[int, int, Task | None], None]
"""Called with the number of tasks done, of tasks in all, and the last one."""


@dataclass(slots=True)
class _Budgets:
    """What is left of each method's seconds."""

    left: dict[str, float]

    @classmethod
    def of(cls, study: Study, rows: Iterable[Row]) -> _Budgets:
        """Return the study's budgets less what known rows took."""
        budgets = cls({method.name: method.budget for method in study.available})
        for row in rows:
            budgets.spend(row)
        return budgets

    def spend(self, row: Row) -> None:
        """Take a row's seconds off its method's budget."""
        if row.method in self.left:
            self.left[row.method] -= row.seconds

    def allows(self, task: Task) -> bool:
        """Whether a further task of its method may begin."""
        return self.left.get(task.method, 0.0) > 0.0


def run_study(
    study: Study,
    journal: Journal,
    *,
    executor: Executor | None = None,
    workers: int = 1,
    progress: Progress | None = None,
    stop: Callable[[], bool] | None = None,
) -> None:
    """Run every task that has no row yet.

    Parameters
    ----------
    study : Study
        What to do.
    journal : Journal
        Where rows go, each as soon as its task ends.
    executor : Executor or None
        Where tasks run; None runs them here, one after the other.
    workers : int
        How many the executor runs at once.
    progress : callable or None
        Called after every task.
    stop : callable or None
        Asked often. Once it returns True no task begins, and what is cut short leaves no row.
    """
    is_stopped = never if stop is None else stop
    tasks = study.tasks()
    keys = {task.key for task in tasks}
    known = [row for row in read_rows(journal.path) if row.key in keys]
    budgets = _Budgets.of(study, known)
    done = {row.key for row in known}
    left = [task for task in tasks if task.key not in done]
    tell = progress or (lambda count, total, task: None)
    tell(len(tasks) - len(left), len(tasks), None)

    def keep(row: Row) -> None:
        journal.append(row)
        budgets.spend(row)

    run = _run_here if executor is None else _run_elsewhere(executor, workers)
    count = len(tasks) - len(left)
    for task, row in run(left, budgets.allows, is_stopped):
        if row is not None:
            keep(row)
        count += 1
        tell(count, len(tasks), task)


Run = Callable[
    [list[Task], Callable[[Task], bool], Callable[[], bool]], Iterable[tuple[Task, Row | None]]
]


def _run_here(
    tasks: list[Task], allows: Callable[[Task], bool], is_stopped: Callable[[], bool]
) -> Iterable[tuple[Task, Row | None]]:
    """Run tasks one after the other; those beyond their budget have no row."""
    for task in tasks:
        row = run_task(task, is_stopped) if allows(task) and not is_stopped() else None
        if is_stopped():
            return
        yield task, row


def _run_elsewhere(executor: Executor, workers: int) -> Run:
    """Return what runs tasks on an executor, few ahead, so that budgets hold."""

    def run(
        tasks: list[Task], allows: Callable[[Task], bool], is_stopped: Callable[[], bool]
    ) -> Iterable[tuple[Task, Row | None]]:
        waiting: dict[Future[Row], Task] = {}
        rest = iter(tasks)
        has_more = True
        while (has_more or waiting) and not is_stopped():
            while has_more and len(waiting) < workers + _AHEAD:
                task = next(rest, None)
                if task is None:
                    has_more = False
                elif allows(task):
                    waiting[executor.submit(run_task, task)] = task
                else:
                    yield task, None
            ended, _ = wait(waiting, timeout=_POLL_SECONDS, return_when=FIRST_COMPLETED)
            for future in ended:
                yield waiting.pop(future), future.result()
        for future in waiting:
            future.cancel()

    return run
