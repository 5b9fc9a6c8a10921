"""A worker's life: load what planning takes, then one job after the other."""

from __future__ import annotations

import ctypes
import os
import signal
import threading
from collections.abc import Callable
from contextlib import suppress
from importlib import import_module
from multiprocessing import parent_process
from multiprocessing.connection import Connection, wait
from typing import Any

from radmpc.errors import RadmpcError
from radmpc.serving.work.control import Control, Flags, stop_the_clock

__all__ = ["JOBS", "work"]

JOBS = {
    "plan": "radmpc.serving.work.plan_content:plan_content",
    "concerns": "radmpc.serving.work.concerns:concerns_of_content",
    "why": "radmpc.serving.work.cures:why_not",
    "simulate": "radmpc.serving.work.trails:trails_of",
    "fly": "radmpc.serving.work.flying:fly_plan",
    "judge": "radmpc.serving.work.judging:judged",
    "import": "radmpc.serving.work.charts:read_chart",
    "obstacles": "radmpc.serving.work.charts:read_obstacles",
}
"""What a worker can be asked for, and where it is."""

_SET_DEATH_SIGNAL = 1
"""Number of that request to the system."""

_AHEAD = ("radmpc.serving.work.plan_content", "radmpc.planners.certified.certified")
"""Loaded before anything is asked for, so that planning begins at once."""


def work(line: Connection, stop: Flags, paused: Flags) -> None:
    """Do jobs until the line is closed.

    Parameters
    ----------
    line : Connection
        To the server: jobs come, news and answers go.
    stop : Flags
        Not 0 once the job is to end.
    paused : Flags
        Seconds that this process was held for.
    """
    # Terminals send Ctrl-C to all: the server decides.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    _die_with_parent()
    threading.Thread(target=_end_with_parent, daemon=True).start()
    stop_the_clock(paused)
    for name in _AHEAD:
        import_module(name)
    lock = threading.Lock()

    def send(message: tuple[str, object]) -> None:
        with lock:
            line.send(message)

    control = Control(lambda kind, news: send(("news", (kind, news))), stop)
    while True:
        try:
            job, args = line.recv()
        except (EOFError, OSError):
            return
        try:
            send(_done(job, control, args))
        except (BrokenPipeError, OSError):
            return


def _done(job: str, control: Control, args: tuple[Any, ...]) -> tuple[str, object]:
    """Return the answer of a job: what it made, or why it did not."""
    try:
        module, name = JOBS[job].split(":")
        found: Callable[..., object] = getattr(import_module(module), name)
        return "done", found(control, *args)
    except RadmpcError as error:
        return "refused", str(error)
    except OSError as error:
        return "refused", error.strerror or type(error).__name__
    except Exception as error:
        what = f"{type(error).__name__}: {error}" if str(error) else type(error).__name__
        return "failed", f"internal error: {what}"


def _die_with_parent() -> None:
    """Have the system kill this process when the server is gone, also while it is held."""
    with suppress(OSError, AttributeError):  # what Linux has, others do without
        libc = ctypes.CDLL(None, use_errno=True)
        libc.prctl(_SET_DEATH_SIGNAL, signal.SIGKILL)


def _end_with_parent() -> None:
    """End this process when the server does, however that ends."""
    parent = parent_process()
    if parent is not None:
        wait([parent.sentinel])
        os._exit(1)
