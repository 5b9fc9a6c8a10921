"""Files that commands read and write."""

from __future__ import annotations

import errno
import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from radmpc.errors import RadmpcError

__all__ = [
    "DEMO_NAME",
    "OutputError",
    "check_output",
    "check_separate",
    "demo_text",
    "file_of",
    "writing",
]

DEMO_NAME = "harbor"


class OutputError(RadmpcError):
    """Something asked for cannot be written."""


def check_output(path: Path | None) -> None:
    """Refuse a path that cannot be written, before any work is done for it.

    Raises
    ------
    OutputError
        If the path is a folder, its folder is missing or not writable, or it is ``-``, which
        other programs take for stdout and no user for a name.
    """
    if path is None:
        return
    if path == Path("-"):
        raise OutputError("cannot write -: is no file name here; /dev/stdout stands for stdout")
    with writing(path):
        if path.is_dir():
            raise _failure(errno.EISDIR, path)
        if not path.parent.is_dir():
            raise _failure(errno.ENOTDIR if path.parent.exists() else errno.ENOENT, path.parent)
        if not os.access(path.parent, os.W_OK):
            raise _failure(errno.EACCES, path.parent)


def file_of(path: Path) -> Path:
    """Return a path without links; one that leads in a circle is refused when it is opened.

    Parameters
    ----------
    path : Path
        As it was typed.

    Returns
    -------
    Path
        Absolute.
    """
    return Path(os.path.realpath(path))


def check_separate(source: Path | None, *outputs: Path | None) -> None:
    """Refuse outputs that would replace what is read, or one another.

    Parameters
    ----------
    source : Path or None
        What is read.
    *outputs : Path or None
        What is written; None is nothing.

    Raises
    ------
    OutputError
        If two of them are one file.
    """
    taken = {} if source is None else {file_of(source): "it is what is read"}
    for path in outputs:
        if path is None or path.is_char_device():
            continue
        file = file_of(path)
        if file in taken:
            raise OutputError(f"cannot write {path}: {taken[file]}")
        taken[file] = "something else is written there"


@contextmanager
def writing(target: Path | str) -> Iterator[None]:
    """Name what was to be written in the errors of the system.

    Raises
    ------
    OutputError
        If the system refuses; its word for a part of the way, such as a folder, is kept.
    """
    try:
        yield
    except OSError as error:
        reason = error.strerror or str(error) or type(error).__name__
        place = "" if error.filename is None else os.fsdecode(error.filename)
        # Temporary files stand beside their target: their names tell nothing.
        is_part = place and Path(place) in Path(target).parents
        where = f"{place}: " if is_part else ""
        raise OutputError(f"cannot write {target}: {where}{reason}") from error


def demo_text() -> str:
    """Return the shipped scenario as it stands in its file."""
    from importlib.resources import files  # noqa: PLC0415 - few commands ask

    return files("radmpc.data").joinpath(f"{DEMO_NAME}.yaml").read_text(encoding="utf-8")


def _failure(number: int, path: Path) -> OSError:
    """Return the system's own error for a path."""
    return OSError(number, os.strerror(number), str(path))
