"""Ctrl-C: first a request to finish, then an order to stop. SIGTERM is the latter."""

from __future__ import annotations

import itertools
import os
import signal
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from sys import UnraisableHookArgs

__all__ = ["interrupt_on_termination", "repeat_swallowed_interrupts", "stop_on_interrupt"]


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


@contextmanager
def repeat_swallowed_interrupts() -> Iterator[None]:
    """Raise `KeyboardInterrupt` again after code that can pass no exception on, as finalizers.

    Python would print it with a traceback and go on: finalizers, and compiled code that calls
    Python where it cannot fail.
    """
    usual = sys.unraisablehook

    def hook(swallowed: UnraisableHookArgs) -> None:
        is_main = threading.current_thread() is threading.main_thread()
        if is_main and issubclass(swallowed.exc_type, KeyboardInterrupt):
            # Raised here it would be swallowed as well. Python asks a profiler at the next call or
            # return, and one that raises does so there; if that is swallowed, too, it comes back.
            sys.setprofile(repeat)
        else:
            usual(swallowed)

    def repeat(frame: FrameType, event: str, argument: object) -> None:
        del event, argument
        if frame.f_code is not hook.__code__:
            sys.setprofile(None)
            raise KeyboardInterrupt

    sys.unraisablehook = hook
    try:
        yield
    finally:
        sys.unraisablehook = usual
