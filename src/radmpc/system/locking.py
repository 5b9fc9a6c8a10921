"""Files that one process at a time may write."""

from __future__ import annotations

from typing import IO

__all__ = ["try_lock"]

try:
    import fcntl
except ImportError:  # pragma: no cover - Windows has no advisory locks of this kind
    fcntl = None  # type: ignore[assignment] # a module or None


def try_lock(file: IO[bytes]) -> bool:
    """Lock a file until it is closed; return False where another process has locked it.

    Where the system has no advisory locks, as Windows, nothing is locked.

    Parameters
    ----------
    file : binary file
        Open.

    Raises
    ------
    OSError
        If the file system cannot lock it.
    """
    if fcntl is None:
        return True
    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    return True
