"""Processes that plan independent sets."""

from __future__ import annotations

import multiprocessing
import signal
from collections.abc import Iterator
from concurrent.futures import Executor, ProcessPoolExecutor
from contextlib import contextmanager

__all__ = ["workers"]


@contextmanager
def workers(jobs: int) -> Iterator[Executor | None]:
    """Provide an executor of processes, or none where one process is enough.

    Parameters
    ----------
    jobs : int
        Number of processes, >= 1.

    Yields
    ------
    Executor or None
        None for one job: planning then runs in this process.
    """
    if jobs == 1:
        yield None
        return
    # Not fork: it copies a process that has threads, and is not the same on all systems.
    context = multiprocessing.get_context("spawn")
    pool = ProcessPoolExecutor(jobs, mp_context=context, initializer=_leave_interrupts_alone)
    try:
        yield pool
    except BaseException:
        pool.shutdown(wait=False, cancel_futures=True)
        for process in multiprocessing.active_children():
            process.terminate()
        raise
    pool.shutdown(cancel_futures=True)


def _leave_interrupts_alone() -> None:
    """Let the parent alone decide what Ctrl-C means: terminals send it to all processes."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
