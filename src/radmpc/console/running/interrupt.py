"""Ctrl-C: first a request to finish, then an order to stop. SIGTERM is the latter."""

from __future__ import annotations

import itertools
import os
import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType

__all__ = ["interrupt_on_termination", "stop_on_interrupt"]


@contextmanager
def stop_on_interrupt(
    answer: str = "finishing with the best plan so far",
) -> Iterator[Callable[[], bool]]:
    """Turn the first Ctrl-C into a flag and the second into `KeyboardInterrupt`.

    Parameters
    ----------
    answer : str
        What is told of the first.

    Yields
    ------
    callable
        Returns True once Ctrl-C was pressed.
    """
    requested = threading.Event()
    request = f"radmpc: {answer}; Ctrl-C again stops at once\n".encode()
    # Counted in one step: the second Ctrl-C may fall into what answers the first.
    earlier = itertools.count()
    if threading.current_thread() is not threading.main_thread():
        # Only the main thread may set handlers; elsewhere the caller owns the signal.
        yield requested.is_set
        return

    def handle(signum: int, frame: FrameType | None) -> None:
        del signum, frame
        if next(earlier):
            raise KeyboardInterrupt
        requested.set()
        # Not print: a handler may interrupt a print, which is not reentrant.
        os.write(2, request)

    previous = signal.signal(signal.SIGINT, handle)
    try:
        yield requested.is_set
    finally:
        signal.signal(signal.SIGINT, previous)


@contextmanager
def interrupt_on_termination() -> Iterator[None]:
    """Turn SIGTERM into `KeyboardInterrupt`: temporary files and worker processes go with us."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return

    def handle(signum: int, frame: FrameType | None) -> None:
        del signum, frame
        raise KeyboardInterrupt

    previous = signal.signal(signal.SIGTERM, handle)
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, previous)
