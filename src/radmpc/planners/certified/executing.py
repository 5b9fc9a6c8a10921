"""Searching many sets, here or on an executor; the answers are the same."""

from __future__ import annotations

import tempfile
import time
from collections.abc import Callable, Sequence
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, Executor, Future, wait
from dataclasses import dataclass
from pathlib import Path

from radmpc.model.scenario import Scenario
from radmpc.planners.certified.problem import Order, SetProblem, SetState, advance
from radmpc.program.build import whole_subjects
from radmpc.solvers.solution import Limits

__all__ = ["Job", "search_sets"]

_POLL_SECONDS = 0.1
_GRACE = 5.0
"""Seconds that workers may be late."""

_CHUNKS = 16
"""Parts that a round's sets are handed out in: few enough to pay their way, enough to share."""


@dataclass(frozen=True, slots=True, eq=False)
class Job:
    """One set to be searched; pickles.

    Attributes
    ----------
    members : tuple of int
        The vehicles.
    scenario : Scenario
        These vehicles alone, with what they may meet.
    state : SetState or None
        How far the search has come.
    order : Order
        What is asked.
    """

    members: tuple[int, ...]
    scenario: Scenario
    state: SetState | None
    order: Order


def search_sets(
    jobs: Sequence[Job],
    problem: Callable[[tuple[int, ...]], SetProblem],
    limits: Limits,
    executor: Executor | None,
    progress: Callable[[int, int], None],
) -> list[SetState]:
    """Search sets that have no vehicle in common.

    Parameters
    ----------
    jobs : sequence of Job
        The sets.
    problem : callable
        Returns a set's program, for those searched here.
    limits : Limits
        When to stop early.
    executor : Executor or None
        None searches here. What a worker that died took with it is searched here, too.
    progress : callable
        Told how many sets are done, of how many.

    Returns
    -------
    list of SetState
        In the order of the jobs.
    """
    if executor is None or len(jobs) < 2:
        found = []
        for job in jobs:
            found.append(advance(problem(job.members), job.scenario, job.state, job.order, limits))
            progress(len(found), len(jobs))
        return found
    size = -(-len(jobs) // _CHUNKS)
    chunks = [tuple(jobs[i : i + size]) for i in range(0, len(jobs), size)]
    states: list[SetState] = []
    for chunk, answer in zip(chunks, _elsewhere(chunks, limits, executor, progress), strict=True):
        states += search_sets(chunk, problem, limits, None, progress) if answer is None else answer
    return states


def _elsewhere(
    chunks: Sequence[tuple[Job, ...]],
    limits: Limits,
    executor: Executor,
    progress: Callable[[int, int], None],
) -> list[list[SetState] | None]:
    """Search chunks on an executor; None for those whose worker died.

    Only the wall clock means the same in another process, and a stop reaches the workers of this
    machine as a file that appears.
    """
    deadline = time.time() + limits.seconds_left
    futures: list[Future[list[SetState]] | None] = []
    with tempfile.TemporaryDirectory(prefix="radmpc-") as folder:
        flag = Path(folder) / "stop"
        for chunk in chunks:
            try:
                futures.append(executor.submit(_search_until, chunk, deadline, str(flag)))
            except BrokenExecutor:
                futures.append(None)
        waiting = {future for future in futures if future is not None}
        while waiting:
            _, waiting = wait(waiting, timeout=_POLL_SECONDS, return_when=FIRST_COMPLETED)
            progress(len(chunks) - len(waiting), len(chunks))
            if waiting and limits.is_stopped():
                flag.touch()
            if waiting and time.time() > deadline + _GRACE:
                # Nobody is left to answer: what is missing is searched here, as far as time allows.
                return [_answer(f) if f is not None and f.done() else None for f in futures]
    return [None if future is None else _answer(future) for future in futures]


def _answer(future: Future[list[SetState]]) -> list[SetState] | None:
    """Return a future's answer; None if its worker died."""
    try:
        return future.result()
    except BrokenExecutor:
        return None


def _search_until(jobs: Sequence[Job], deadline: float, flag: str) -> list[SetState]:
    """Search sets until a time of the wall clock, or until a file appears."""
    left = max(0.0, deadline - time.time())
    limits = Limits(time.monotonic() + left, lambda: Path(flag).exists())
    found = []
    for job in jobs:
        subjects = whole_subjects(job.scenario)
        everyone = tuple(range(len(subjects)))
        problem = SetProblem.of(job.scenario, everyone, subjects, job.order.unit)
        found.append(advance(problem, job.scenario, job.state, job.order, limits))
    return found
