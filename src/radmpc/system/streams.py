"""Standard streams that the caller has closed, or whose encoding lacks letters."""

from __future__ import annotations

import os
import sys
from io import TextIOWrapper

__all__ = ["has_every_letter", "settle_streams"]


def settle_streams() -> None:
    """Open closed standard streams to nowhere, and have stdout escape letters that it lacks.

    Python leaves None where a stream is closed, as with ``>&-`` in a shell or in a process without
    a console, and the next file that is opened would get the stream's number: what a library
    prints would then be written into it.
    """
    for number, name in enumerate(("stdin", "stdout", "stderr")):
        if getattr(sys, name) is None:
            _open_to_nowhere(number, name)
    if isinstance(sys.stdout, TextIOWrapper) and sys.stdout.errors == "strict":
        sys.stdout.reconfigure(errors="backslashreplace")


def has_every_letter(encoding: str | None) -> bool:
    """Whether an encoding is UTF-8, by whatever name.

    Parameters
    ----------
    encoding : str or None
        Of a stream; None is that of text in memory, which has every letter.
    """
    return encoding is None or encoding.lower().replace("_", "-") in {"utf-8", "utf8", "utf-8-sig"}


def _open_to_nowhere(number: int, name: str) -> None:
    """Make a closed standard stream one that reads and writes nothing."""
    nowhere = os.open(os.devnull, os.O_RDWR)
    if nowhere != number:
        os.dup2(nowhere, number)
        os.close(nowhere)
    mode = "r" if number == 0 else "w"
    # It stays open as long as the process, as standard streams do.
    setattr(sys, name, open(number, mode, encoding="utf-8", closefd=False))  # noqa: SIM115 - kept
