"""Output to stdout and stderr; a closed pipe is no error."""

from __future__ import annotations

import json
import os
import sys
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager, nullcontext, redirect_stdout
from io import StringIO
from pathlib import Path
from shutil import get_terminal_size
from typing import TYPE_CHECKING, TypeGuard

from radmpc.console.files import OutputError, writing
from radmpc.system.streams import has_every_letter

if TYPE_CHECKING:
    from rich.console import RenderableType

__all__ = [
    "is_stdout",
    "note",
    "reports_beside",
    "show",
    "show_json",
    "silence_closed_pipe",
    "width",
]

_STDOUT = 1
"""The descriptor that ``/dev/stdout`` is."""

_PIPED_WIDTH = 5000
"""Width of a line into a pipe or a file [letters]: no line of a report is broken there."""


def show(*parts: RenderableType) -> None:
    """Print parts of a report to stdout: styled on a terminal, plain text otherwise."""
    is_terminal, most = sys.stdout.isatty(), width()
    lines = [part.rstrip() for part in parts if _is_plain(part, most)]
    _write("\n".join(lines) if len(lines) == len(parts) else _rendered(parts, is_terminal, most))


def _is_plain(part: RenderableType, most: int) -> TypeGuard[str]:
    """Whether a part is a line that is printed as it is."""
    return isinstance(part, str) and len(part) <= most and part.isascii() and part.isprintable()


def _rendered(parts: Sequence[RenderableType], is_terminal: bool, most: int) -> str:
    """Return parts of a report as text, with styles on a terminal."""
    from rich.console import Console  # noqa: PLC0415 - a line or two do without

    buffer = StringIO()
    console = Console(
        file=buffer,
        force_terminal=is_terminal,
        width=most,
        # Names come from files: brackets in them are no markup.
        markup=False,
        highlight=False,
        emoji=False,
    )
    for part in parts:
        console.print(part)
    return "\n".join(line.rstrip() for line in buffer.getvalue().splitlines())


def width() -> int:
    """Return how many letters a line of stdout has: a terminal's, or more than anybody needs."""
    return get_terminal_size().columns if sys.stdout.isatty() else _PIPED_WIDTH


def show_json(content: Mapping[str, object]) -> None:
    """Print one JSON object to stdout: in UTF-8, or in ASCII where stdout has another encoding."""
    is_ascii = not has_every_letter(sys.stdout.encoding)
    _write(json.dumps(content, indent=2, ensure_ascii=is_ascii, allow_nan=False))


def note(text: str) -> None:
    """Print one line to stderr, whatever line breaks the text has."""
    line = " ".join(text.split())
    try:
        print(f"radmpc: {line}", file=sys.stderr, flush=True)  # noqa: T201 - the console prints
    except BrokenPipeError:
        _close(sys.stderr.fileno())


@contextmanager
def reports_beside(outputs: Iterable[Path]) -> Iterator[None]:
    """Report on stderr as long as data are written to stdout, as to ``/dev/stdout``.

    Parameters
    ----------
    outputs : iterable of Path
        Where data go.
    """
    is_taken = any(is_stdout(path) for path in outputs)
    with redirect_stdout(sys.stderr) if is_taken else nullcontext():
        yield


def is_stdout(path: Path) -> bool:
    """Whether a path, by whatever name, is where stdout goes; not if that is nowhere.

    Parameters
    ----------
    path : Path
        Of a file, a device or a link to either; nothing need be there.
    """
    try:
        place = path.stat()
        is_same = os.path.samestat(place, os.fstat(_STDOUT))
        return is_same and not os.path.samestat(place, os.stat(os.devnull))
    except OSError:
        return False


@contextmanager
def silence_closed_pipe() -> Iterator[None]:
    """Keep the interpreter from complaining at exit about a closed stdout."""
    yield
    try:
        sys.stdout.flush()
    except BrokenPipeError:
        _close(sys.stdout.fileno())


def _write(text: str) -> None:
    """Write to stdout; if its reader has gone, go on: the exit code still tells."""
    try:
        with writing("stdout"):
            print(text, flush=True)  # noqa: T201 - the console prints
    except OutputError as error:
        _close(sys.stdout.fileno())
        if not isinstance(error.__cause__, BrokenPipeError):
            raise


def _close(descriptor: int) -> None:
    """Send what is still written to a closed pipe to nowhere."""
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, descriptor)
    os.close(nowhere)
