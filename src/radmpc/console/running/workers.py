"""Processes that plan independent sets."""

from __future__ import annotations

import multiprocessing
import sys
from collections.abc import Iterator
from concurrent.futures import Executor, ProcessPoolExecutor
from contextlib import contextmanager

from radmpc.system.interrupts import interrupts_deferred
from radmpc.system.processors import num_processors

__all__ = ["workers"]

_FEWEST = 2
"""Processes that may be had on any machine."""

_MOST_ON_WINDOWS = 61
"""Processes that a pool can wait for there."""


@contextmanager
def workers(jobs: int, dask: str | None = None) -> Iterator[Executor | None]:
    """Provide an executor of processes or a cluster's, or none where one process is enough.

    Parameters
    ----------
    jobs : int
        Number of processes, >= 1; no more start than processors, or two, can run.
    dask : str or None
        Address of a Dask scheduler, to plan there instead.

    Yields
    ------
    Executor or None
        None for one job: planning then runs in this process.
    """
    if dask is not None:
        from radmpc.console.running.cluster import cluster  # noqa: PLC0415 - few ask for one

        with cluster(dask) as executor:
            yield executor
        return
    if jobs == 1:
        yield None
        return
    # Not fork: it copies a process that has threads, and is not the same on all systems.
    context = multiprocessing.get_context("spawn")
    started = min(jobs, max(num_processors(), _FEWEST))
    if sys.platform == "win32":
        started = min(started, _MOST_ON_WINDOWS)
    pool = ProcessPoolExecutor(started, mp_context=context)
    try:
        with interrupts_deferred():
            # None is idle before the last is started, so every task starts one. An initializer
            # would run too late for a Ctrl-C while they load.
            for _ in range(started):
                pool.submit(int)
        yield pool
    except BaseException:
        pool.shutdown(wait=False, cancel_futures=True)
        for process in multiprocessing.active_children():
            process.terminate()
        raise
    pool.shutdown(cancel_futures=True)
