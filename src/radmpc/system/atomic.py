"""Files that are either the old or the new one, never half of it."""

from __future__ import annotations

import os
import secrets
import stat
from pathlib import Path

__all__ = ["write_bytes", "write_text"]


def write_text(path: str | os.PathLike[str], text: str) -> None:
    """Write a text file in one piece: readers see all of it or what was there before.

    Parameters
    ----------
    path : path
        The file; an existing one is replaced and keeps its permissions, a link keeps pointing.
    text : str
        Its new content, written in UTF-8.

    Raises
    ------
    OSError
        If the file cannot be written; it is then what it was before.
    """
    write_bytes(path, text.encode("utf-8"))


def write_bytes(path: str | os.PathLike[str], content: bytes) -> None:
    """Write a file in one piece, as `write_text` does.

    Parameters
    ----------
    path : path
        The file; an existing one is replaced and keeps its permissions, a link keeps pointing.
    content : bytes
        Its new content.

    Raises
    ------
    OSError
        If the file cannot be written; it is then what it was before.
    """
    # A link stays a link: what it points to is replaced.
    target = Path(os.path.realpath(path))
    if not target.exists() and os.path.exists(path):
        # A pipe behind /dev/stdout has no path of its own.
        target = Path(path)
    try:
        mode = _mode(target)
        if mode is not None and not stat.S_ISREG(mode):
            # A pipe or a device cannot be replaced; a folder says so itself.
            target.write_bytes(content)
        else:
            _replace(target, content, mode)
    except OSError as error:
        # The temporary file's name would tell the user nothing.
        raise OSError(error.errno, error.strerror, os.fspath(path)) from error


def _mode(target: Path) -> int | None:
    """Return kind and permissions of what stands at a path, None if nothing does."""
    try:
        return target.stat().st_mode
    except FileNotFoundError:
        return None


def _replace(target: Path, content: bytes, mode: int | None) -> None:
    """Write a temporary file beside the target, make it durable, rename it."""
    # In the same folder, because only there renaming is atomic. Not through `tempfile`,
    # whose files only their owner may read.
    temporary = target.with_name(f".radmpc-{secrets.token_hex(8)}.tmp")
    descriptor = os.open(temporary, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o666)
    is_done = False
    try:
        with os.fdopen(descriptor, "wb") as file:
            if mode is not None:
                os.chmod(temporary, stat.S_IMODE(mode))
            file.write(content)
            file.flush()
            os.fsync(file.fileno())
        os.replace(temporary, target)
        is_done = True
    finally:
        if not is_done:
            temporary.unlink(missing_ok=True)
