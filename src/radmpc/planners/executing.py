"""Work handed to an executor: deadlines, stops and dead workers, the same for every planner."""

from __future__ import annotations

import tempfile
import time
from collections.abc import Callable, Sequence
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, Executor, Future, wait
from pathlib import Path
from typing import TypeVar

from radmpc.solvers.solution import Limits

__all__ = ["run_elsewhere"]

_POLL_SECONDS = 0.1
"""How often progress is told and a stop passed on [s]."""

_GRACE = 5.0
"""Time that workers may be late [s]."""

Task = TypeVar("Task")
Answer = TypeVar("Answer")


def run_elsewhere(
    work: Callable[[Task, Limits], Answer],
    tasks: Sequence[Task],
    limits: Limits,
    executor: Executor,
    progress: Callable[[int, int], None],
) -> list[Answer | None]:
    """Run tasks on an executor.

    Only the wall clock means the same in another process, and a queued task must not restart it.
    A stop reaches the workers of this machine as a file that appears.

    Parameters
    ----------
    work : callable
        What to do with a task until a limit; a function of a module, tasks and answers pickle.
    tasks : sequence
        The tasks.
    limits : Limits
        When to stop early.
    executor : Executor
        Where they run.
    progress : callable
        Told how many tasks are done, of how many.

    Returns
    -------
    list
        Answers in the order of the tasks; None for those whose worker died or never answered.
    """
    deadline = time.time() + limits.seconds_left
    futures: list[Future[Answer] | None] = []
    with tempfile.TemporaryDirectory(prefix="radmpc-") as folder:
        flag = Path(folder) / "stop"
        for task in tasks:
            try:
                futures.append(executor.submit(_until, work, task, deadline, str(flag)))
            except BrokenExecutor:
                futures.append(None)
        waiting = {future for future in futures if future is not None}
        while waiting:
            _, waiting = wait(waiting, timeout=_POLL_SECONDS, return_when=FIRST_COMPLETED)
            progress(len(tasks) - len(waiting), len(tasks))
            if waiting and limits.is_stopped():
                flag.touch()
            if waiting and time.time() > deadline + _GRACE:
                return [_answer(f) if f is not None and f.done() else None for f in futures]
    return [None if future is None else _answer(future) for future in futures]


def _answer(future: Future[Answer]) -> Answer | None:
    """Return a future's answer; None if its worker died."""
    try:
        return future.result()
    except BrokenExecutor:
        return None


def _until(
    work: Callable[[Task, Limits], Answer], task: Task, deadline: float, flag: str
) -> Answer:
    """Do a task until a time of the wall clock, or until a file appears."""
    left = max(0.0, deadline - time.time())
    return work(task, Limits(time.monotonic() + left, lambda: Path(flag).exists()))
