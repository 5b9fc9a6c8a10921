"""Stages of planning, reported on stderr while it runs."""

from __future__ import annotations

import logging
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager

__all__ = ["stage_notes"]


@contextmanager
def stage_notes(is_shown: bool) -> Iterator[None]:
    """Show the package's log while the context lasts, a line per stage with the time since.

    Parameters
    ----------
    is_shown : bool
        Whether anything is shown.
    """
    if not is_shown:
        yield
        return
    logger = logging.getLogger("radmpc")
    handler = logging.StreamHandler(sys.stderr)
    handler.setFormatter(_SinceStart())
    level = logger.level
    logger.addHandler(handler)
    logger.setLevel(logging.INFO)
    try:
        yield
    finally:
        logger.removeHandler(handler)
        logger.setLevel(level)


class _SinceStart(logging.Formatter):
    """Lines that begin with the seconds since the formatter was made."""

    def __init__(self) -> None:
        super().__init__()
        self._first = time.time()

    def format(self, record: logging.LogRecord) -> str:
        """Return one line."""
        return f"{record.created - self._first:7.2f} s  {record.getMessage()}"
