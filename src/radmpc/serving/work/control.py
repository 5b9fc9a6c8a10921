"""What a job is given beside its arguments: somebody to tell, and when to end."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any, Protocol

__all__ = ["Control", "Flags", "stop_the_clock"]


class Flags(Protocol):
    """Numbers that server and worker share."""

    @property
    def value(self) -> Any:
        """The number."""
        ...


class Control:
    """A job's line to the server.

    Parameters
    ----------
    tell : callable
        Takes what kind of news it is, and the news.
    stop : Flags
        Not 0 once the job is to end with what it has.
    """

    def __init__(self, tell: Callable[[str, object], None], stop: Flags) -> None:
        self.tell = tell
        self._stop = stop

    def is_stopped(self) -> bool:
        """Whether the job is to end."""
        return bool(self._stop.value)


def stop_the_clock(paused: Flags) -> None:
    """Let this process's clock stand still while the process does: a pause is no time spent.

    Planners end by ``time.monotonic``. A process that is held by a signal does not see it, but the
    clock goes on; what it was held for is in shared memory before it goes on.

    Parameters
    ----------
    paused : Flags
        Seconds that the process was held for, all pauses together.
    """
    running = time.monotonic
    # A name of the module, not of this function: whoever asks for the time asks there.
    setattr(time, "monotonic", lambda: running() - paused.value)  # noqa: B010 - said to mypy
