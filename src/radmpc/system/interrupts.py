"""Processes that a terminal's Ctrl-C does not reach: the process that started them decides."""

from __future__ import annotations

import signal
from collections.abc import Iterator
from contextlib import contextmanager
from multiprocessing import resource_tracker

__all__ = ["interrupts_deferred"]


@contextmanager
def interrupts_deferred() -> Iterator[None]:
    """Keep Ctrl-C from processes that are started here; one pressed meanwhile is answered after.

    Terminals send it to all processes of a command. These inherit that it is blocked, from their
    first moment; to ignore it here instead would lose one that is pressed while they start. Where
    the system does not block signals, they are started as any others.
    """
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    # Its first start, of a process of its own, would unblock signals.
    resource_tracker.ensure_running()
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)
