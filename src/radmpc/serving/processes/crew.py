"""All workers of a server: one in reserve that has loaded everything, and an end for all."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from typing import Any

from radmpc.serving.failures import CallError
from radmpc.serving.processes.worker import Listener, Worker

__all__ = ["Crew"]

_MOST_BUSY = 12
"""Jobs at once [-]: what takes longer than a moment runs here, and each takes a processor."""

_MOST_RESERVE = 2
"""Idle workers that are kept [-]: one for the next search, one for what takes a moment."""

_MOST_JOBS = 20
"""Jobs after which a worker is replaced: what libraries keep in memory goes with it [-]."""


class Crew:
    """Gives a worker to each job, and has the next one ready."""

    def __init__(self) -> None:
        self._reserve: list[Worker] = []
        self._busy: set[Worker] = set()
        self._is_over = False

    @property
    def pids(self) -> list[int]:
        """Numbers of all processes in the system."""
        return [w.pid for w in (*self._reserve, *self._busy) if w.pid is not None]

    def prepare(self) -> None:
        """Have a worker in reserve, that loads before it is needed."""
        self._reserve = [worker for worker in self._reserve if worker.is_alive]
        if not self._reserve and not self._is_over:
            self._reserve.append(Worker())

    @asynccontextmanager
    async def worker(self) -> AsyncIterator[Worker]:
        """Provide a worker for one job.

        Raises
        ------
        CallError
            If too many are busy.
        """
        if self._is_over or len(self._busy) >= _MOST_BUSY:
            raise CallError("limit", f"{_MOST_BUSY} jobs are under way: wait, or stop one")
        self.prepare()
        worker = self._reserve.pop()
        self._busy.add(worker)
        asyncio.get_running_loop().call_later(0.5, self.prepare)
        is_fine = False
        try:
            yield worker
            is_fine = True
        finally:
            self._busy.discard(worker)
            is_young = worker.jobs < _MOST_JOBS and not self._is_over
            if is_fine and is_young and len(self._reserve) < _MOST_RESERVE and worker.is_alive:
                self._reserve.append(worker)
            else:
                worker.kill()

    async def run(
        self, job: str, *args: object, seconds: float, listener: Listener | None = None
    ) -> Any:
        """Have a job done that takes a moment; a worker that takes longer is killed.

        Parameters
        ----------
        job : str
            One of the workers' `JOBS`.
        *args : object
            What it takes.
        seconds : float
            When to give up [s].
        listener : callable or None
            Given its news.

        Raises
        ------
        CallError
            As in `Worker.run`; or if it takes too long.
        """
        try:
            async with self.worker() as worker, asyncio.timeout(seconds):
                return await worker.run(job, *args, listener=listener)
        except TimeoutError:
            raise CallError("limit", f"it took more than {seconds:g} s") from None

    def end(self) -> None:
        """End all workers, whatever they are at."""
        self._is_over = True
        workers = [*self._reserve, *self._busy]
        for worker in workers:
            worker.kill()
        for worker in workers:
            worker.bury()
