"""Files that commands read and write."""

from __future__ import annotations

import errno
import os
from importlib.resources import files
from pathlib import Path

__all__ = ["DEMO_NAME", "check_output", "demo_text"]

DEMO_NAME = "harbor"


def check_output(path: Path | None) -> None:
    """Refuse a path that cannot be written, before any work is done for it.

    Raises
    ------
    OSError
        If the path is a folder, or its folder is missing or not writable.
    """
    if path is None:
        return
    if path.is_dir():
        raise _failure(errno.EISDIR, path)
    if not path.parent.is_dir():
        raise _failure(errno.ENOENT if not path.parent.exists() else errno.ENOTDIR, path.parent)
    if not os.access(path.parent, os.W_OK):
        raise _failure(errno.EACCES, path)


def demo_text() -> str:
    """Return the shipped scenario as it stands in its file."""
    return files("radmpc.data").joinpath(f"{DEMO_NAME}.yaml").read_text(encoding="utf-8")


def _failure(number: int, path: Path) -> OSError:
    """Return the system's own error for a path."""
    return OSError(number, os.strerror(number), str(path))
