"""One worker process, as the server sees it: a job, its news, its answer or its death."""

from __future__ import annotations

import asyncio
import multiprocessing
import os
import signal
import threading
import time
from collections.abc import Callable
from multiprocessing.context import SpawnContext
from typing import Any

from radmpc.serving.failures import CallError, refused
from radmpc.serving.work.main import work
from radmpc.system.interrupts import interrupts_deferred

__all__ = ["DiedError", "Listener", "Worker"]

Listener = Callable[[str, Any], None]
"""Takes what kind of news it is, and the news, in the server's own thread."""

_CONTEXT: SpawnContext = multiprocessing.get_context("spawn")
"""Not fork: it copies a process that has threads and open sockets."""

_JOIN = 2.0
"""Seconds that a process may take to be gone once it was killed [s]."""


class DiedError(CallError):
    """A worker is gone: killed by somebody, or out of memory."""

    def __init__(self) -> None:
        super().__init__("internal", "the worker process died")


class Worker:
    """A process that does one job at a time. Used from the server's thread alone."""

    def __init__(self) -> None:
        self._line, theirs = _CONTEXT.Pipe()
        self._stop = _CONTEXT.RawValue("b", 0)
        self._paused = _CONTEXT.RawValue("d", 0.0)
        self._held_since: float | None = None
        self._answer: asyncio.Future[Any] | None = None
        self._listener: Listener | None = None
        self._loop = asyncio.get_running_loop()
        args = (theirs, self._stop, self._paused)
        self._process = _CONTEXT.Process(target=work, args=args, daemon=True)
        with interrupts_deferred():
            self._process.start()
        theirs.close()
        self.jobs = 0
        threading.Thread(target=self._listen, daemon=True).start()

    @property
    def pid(self) -> int | None:
        """Its number in the system."""
        return self._process.pid

    @property
    def is_alive(self) -> bool:
        """Whether the process is there."""
        return self._process.is_alive()

    @property
    def is_held(self) -> bool:
        """Whether it stands still."""
        return self._held_since is not None

    async def run(self, job: str, *args: object, listener: Listener | None = None) -> Any:
        """Have a job done.

        Parameters
        ----------
        job : str
            One of the worker's `JOBS`.
        *args : object
            What it takes.
        listener : callable or None
            Given its news.

        Returns
        -------
        object
            What it made.

        Raises
        ------
        CallError
            With what the job says, or that the worker died.
        """
        self._stop.value = 0
        self._listener, self._answer = listener, self._loop.create_future()
        self.jobs += 1
        answer = self._answer
        try:
            # A worker that is still loading reads what is long later.
            await asyncio.to_thread(self._line.send, (job, args))
            return await answer
        except (BrokenPipeError, OSError):
            raise DiedError from None
        finally:
            self._listener = self._answer = None

    def stop(self) -> None:
        """Ask the job to end with what it has."""
        self._stop.value = 1
        self.go_on()

    def hold(self) -> None:
        """Let the process stand still, in whatever it is."""
        if self._held_since is None and self.is_alive:
            self._held_since = time.monotonic()
            self._signal(signal.SIGSTOP)

    def go_on(self) -> None:
        """Let it go on; it never learns that it was held."""
        if self._held_since is not None:
            self._paused.value += time.monotonic() - self._held_since
            self._held_since = None
            self._signal(signal.SIGCONT)

    def kill(self) -> None:
        """End the process at once."""
        if self._process.is_alive():
            self._process.kill()

    def bury(self) -> None:
        """Wait until a killed process is gone."""
        self._process.join(_JOIN)

    def _signal(self, number: int) -> None:
        """Send the process a signal, if it is there."""
        if self._process.pid is not None and self._process.is_alive():
            os.kill(self._process.pid, number)

    def _listen(self) -> None:
        """Hand on what comes from the process, in a thread of its own."""
        while True:
            try:
                message = self._line.recv()
            except Exception:
                message = ("died", None)
            try:
                self._loop.call_soon_threadsafe(self._take, *message)
            except RuntimeError:  # the server has ended
                return
            if message[0] == "died":
                self._line.close()
                return

    def _take(self, kind: str, news: Any) -> None:
        """Take what came, in the server's thread."""
        if kind == "news":
            if self._listener is not None:
                self._listener(*news)
            return
        if self._answer is None or self._answer.done():
            return
        if kind == "done":
            self._answer.set_result(news)
        elif kind == "refused":
            self._answer.set_exception(refused(news))
        elif kind == "failed":
            self._answer.set_exception(CallError("internal", news))
        else:
            self._answer.set_exception(DiedError())
