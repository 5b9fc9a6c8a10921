"""Text files in, one-line messages out."""

from __future__ import annotations

import os
import reprlib

from radmpc.errors import FileFormatError

__all__ = ["one_line", "read_text", "shown"]

_LONGEST_LINE = 400
"""Letters of a line that a message shows."""

_MOST_BYTES = 512 * 2**20
"""Size of a text file [bytes]: devices such as /dev/zero have no end."""

_REPR = reprlib.Repr()
_REPR.maxstring = _REPR.maxother = _REPR.maxlong = 60
_REPR.maxlevel = 3


def read_text(path: str | os.PathLike[str], most_bytes: int = _MOST_BYTES) -> str:
    """Return the text of a file in UTF-8.

    Parameters
    ----------
    path : path
        The file; a byte order mark at its start is dropped.
    most_bytes : int
        A longer one is refused; no more of it is read.

    Returns
    -------
    str
        Its text.

    Raises
    ------
    FileFormatError
        If the file cannot be read, is too long, or is not text in UTF-8.
    """
    name = os.fspath(path)
    try:
        with open(path, "rb") as file:
            content = file.read(most_bytes + 1)
    except OSError as error:
        raise FileFormatError(one_line(f"{name}: {error.strerror or error}")) from error
    except ValueError as error:  # a name with a NUL in it
        raise FileFormatError(one_line(f"{name}: is no file name: {error}")) from error
    if len(content) > most_bytes:
        raise FileFormatError(one_line(f"{name}: must be at most {most_bytes / 2**20:g} MiB"))
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = 1 + content.count(b"\n", 0, error.start)
        raise FileFormatError(
            one_line(
                f"{name}:{line}: must be text in UTF-8, got the byte {content[error.start]:#x}"
            )
        ) from error


def shown(value: object) -> str:
    """Return a value for a message: as files spell it, and short."""
    if value is None or isinstance(value, bool):
        return {None: "null", True: "true", False: "false"}[value]
    return _REPR.repr(value)


def one_line(text: str) -> str:
    """Return a message without line breaks or control characters, cut if it is long."""
    if not text.isprintable():
        text = "".join(c if c.isprintable() else repr(c)[1:-1] for c in text)
    if len(text) > _LONGEST_LINE:
        text = text[: _LONGEST_LINE - 3] + "..."
    return text
