"""Processes that plan independent sets."""

from __future__ import annotations

import multiprocessing
import signal
import threading
from collections.abc import Iterator
from concurrent.futures import Executor, ProcessPoolExecutor
from contextlib import contextmanager

__all__ = ["workers"]


@contextmanager
def workers(jobs: int, dask: str | None = None) -> Iterator[Executor | None]:
    """Provide an executor of processes or a cluster's, or none where one process is enough.

    Parameters
    ----------
    jobs : int
        Number of processes, >= 1.
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
    pool = ProcessPoolExecutor(jobs, mp_context=context)
    try:
        _start_ignoring_interrupts(pool, jobs)
        yield pool
    except BaseException:
        pool.shutdown(wait=False, cancel_futures=True)
        for process in multiprocessing.active_children():
            process.terminate()
        raise
    pool.shutdown(cancel_futures=True)


def _start_ignoring_interrupts(pool: ProcessPoolExecutor, jobs: int) -> None:
    """Start all workers with Ctrl-C ignored: terminals send it to them too, but the parent decides.

    They inherit the signal handler. An initializer would run too late for a Ctrl-C while they load.
    """
    if threading.current_thread() is not threading.main_thread():
        return
    previous = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        # None is idle before the last is started, so every task starts one.
        for _ in range(jobs):
            pool.submit(int)
    finally:
        signal.signal(signal.SIGINT, previous)
