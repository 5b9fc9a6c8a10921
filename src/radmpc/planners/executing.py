"""Work handed to an executor: deadlines, stops and dead workers, the same for every planner."""

from __future__ import annotations

import tempfile
import time
from collections.abc import Callable, Generator, Iterable, Sequence
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, Executor, Future, wait
from functools import partial
from pathlib import Path
from typing import Any, Self, TypeVar

from radmpc.solvers.solution import Limits

__all__ = ["in_order", "run_elsewhere"]

_POLL_SECONDS = 0.1
"""How often progress is told, a stop passed on and looked for [s]: to ask for a file at every node
was a tenth of what workers did."""

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
    meanwhile: Callable[[], None] | None = None,
) -> list[Answer | None]:
    """Run tasks on an executor, and here what no worker of its pool has begun, the last first.

    Parameters
    ----------
    work : callable
        What to do with a task until a limit; a function of a module, tasks and answers pickle.
    tasks : sequence
        The tasks; best those first that take longest.
    limits : Limits
        When to stop early.
    executor : Executor
        Where they run.
    progress : callable
        Called with the number of tasks done, and of all.
    meanwhile : callable or None
        What is done here first, once all are handed out.

    Returns
    -------
    list
        Answers in the order of the tasks; None for those whose worker died or never answered.
    """
    with _Elsewhere(work, limits, executor) as elsewhere:
        futures = elsewhere.submit(tasks)
        if meanwhile is not None:
            meanwhile()
        here: dict[int, Answer] = {}
        # Futures of others, as of a cluster, let themselves be canceled while their work runs.
        from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor  # noqa: PLC0415 - few have workers

        is_told_what_began = isinstance(executor, ProcessPoolExecutor | ThreadPoolExecutor)
        for number in reversed(range(len(tasks) if is_told_what_began else 0)):
            future = futures[number]
            if limits.reached or future is None or not future.cancel():
                break
            here[number] = work(tasks[number], limits)
            progress(len(here) + sum(one.done() for one in futures[:number] if one), len(tasks))
        waiting = {future for future in futures if future is not None and not future.done()}
        while waiting and not elsewhere.is_late:
            waiting = elsewhere.wait(waiting)
            progress(len(tasks) - len(waiting), len(tasks))
        return [
            here[number] if number in here else _answer(future)
            for number, future in enumerate(futures)
        ]


def in_order(
    work: Callable[[Task, Limits], Answer],
    tasks: Iterable[Task],
    limits: Limits,
    executor: Executor,
) -> Generator[Answer | None, None, None]:
    """Run tasks on an executor and yield their answers in order, each as soon as it is there.

    Parameters
    ----------
    work, limits, executor
        As in `run_elsewhere`.
    tasks : iterable
        The tasks, each handed out once it is made.

    Yields
    ------
    Answer or None
        None for a task whose worker died or never answered. Once the generator is closed, what
        has not begun never does, and what is under way is stopped and forgotten.
    """
    with _Elsewhere(work, limits, executor) as elsewhere:
        for future in elsewhere.submit(tasks):
            waiting = set() if future is None else {future}
            while waiting and not elsewhere.is_late:
                waiting = elsewhere.wait(waiting)
            yield _answer(future)


class _Elsewhere:
    """Work on an executor until a limit; leaving stops what is under way.

    Only the wall clock means the same in another process, and a queued task must not restart it.
    A stop reaches the workers of this machine as a file that appears.
    """

    def __init__(
        self, work: Callable[[Task, Limits], Answer], limits: Limits, executor: Executor
    ) -> None:
        self._work, self._limits, self._executor = work, limits, executor
        self._deadline = time.time() + limits.seconds_left
        self._futures: set[Future[Any]] = set()

    def __enter__(self) -> Self:
        self._folder = tempfile.TemporaryDirectory(prefix="radmpc-")
        self._flag = Path(self._folder.name) / "stop"
        return self

    def __exit__(self, *_: object) -> None:
        left = {future for future in self._futures if not (future.done() or future.cancel())}
        if left:
            # The file has to stay until everybody has seen it.
            self._flag.touch()
            wait(left, timeout=_GRACE)
        self._folder.cleanup()

    @property
    def is_late(self) -> bool:
        """Whether the deadline is past by more than the grace: no task is waited for any more."""
        return time.time() > self._deadline + _GRACE

    def submit(self, tasks: Iterable[Any]) -> list[Future[Any] | None]:
        """Hand tasks out; None for those that no worker takes."""
        futures: list[Future[Any] | None] = []
        for task in tasks:
            work = partial(_until, self._work, task, self._deadline, str(self._flag))
            try:
                futures.append(self._executor.submit(work))
            except BrokenExecutor:
                futures.append(None)
        self._futures = {future for future in futures if future is not None}
        return futures

    def wait(self, waiting: set[Future[Any]]) -> set[Future[Any]]:
        """Wait until one is done, for a moment at most; return the others, and pass a stop on."""
        _, waiting = wait(waiting, timeout=_POLL_SECONDS, return_when=FIRST_COMPLETED)
        if waiting and self._limits.is_stopped():
            self._flag.touch()
        return waiting


def _answer(future: Future[Answer] | None) -> Answer | None:
    """Return a future's answer; None if its worker died, or has not answered."""
    if future is None or not future.done():
        return None
    try:
        return future.result()
    except BrokenExecutor:
        return None


def _until(
    work: Callable[[Task, Limits], Answer], task: Task, deadline: float, flag: str
) -> Answer:
    """Do a task until a time of the wall clock, or until a file appears."""
    left = max(0.0, deadline - time.time())
    return work(task, Limits(time.monotonic() + left, _Appearance(Path(flag)).has_come))


class _Appearance:
    """Whether a file is there, looked for now and then: searches ask at every node."""

    def __init__(self, path: Path) -> None:
        self._path, self._looked = path, -_POLL_SECONDS
        self._is_there = False

    def has_come(self) -> bool:
        """Tell whether it was there when it was looked for last."""
        now = time.monotonic()
        if now >= self._looked + _POLL_SECONDS:
            self._looked, self._is_there = now, self._path.exists()
        return self._is_there
