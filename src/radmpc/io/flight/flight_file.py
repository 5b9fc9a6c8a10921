"""Flight files: a line of JSON per tick, chained by digests, on the disk before it is flown."""

from __future__ import annotations

import hashlib
import json
import os
import re
from collections.abc import Mapping
from pathlib import Path
from typing import BinaryIO

from radmpc.arguments import check_path
from radmpc.errors import FileFormatError, ScenarioError
from radmpc.io.flight.coding import decode_header, decode_row, encode_header, encode_row
from radmpc.io.flight.record import FlightRecord, FlightSettings, TickRow
from radmpc.io.text.files import one_line, read_text
from radmpc.io.text.json_text import read_json
from radmpc.model.plan import Plan
from radmpc.system.locking import try_lock

__all__ = ["FlightWriter", "is_flight", "load_flight"]

_DIGEST = re.compile(r', "digest": "([0-9a-f]{16})"\}$')
"""How a line ends: with the digest of the line before and of its own text so far."""

_START = re.compile(r'\s*\{\s*"format"\s*:\s*"radmpc/flight/')


def is_flight(path: str | os.PathLike[str]) -> bool:
    """Whether a file's first line says that it holds a flight, of whatever version."""
    if not Path(path).is_file():
        return False  # a pipe can be read only once
    try:
        with open(path, "rb") as file:
            return _START.match(file.read(80).decode("utf-8-sig", "replace")) is not None
    except OSError:
        return False


def load_flight(path: str | os.PathLike[str]) -> FlightRecord:
    """Return the flight in a file.

    Whether it is true is not checked here: lines that are not as they were written are named in
    the record, and `radmpc verify` books the account again. What was being written when the
    program was killed is left out.

    Parameters
    ----------
    path : path
        Lines of JSON.

    Returns
    -------
    FlightRecord
        Equal to what was flown, bit for bit.

    Raises
    ------
    FileFormatError
        With one line that names file, line, field, value and what is allowed.
    """
    check_path(path)
    name, text = os.fspath(path), read_text(path)
    return _record(name, _whole_lines(text))


def _whole_lines(text: str) -> list[str]:
    """Return the lines without the last if that was cut while it was written."""
    *whole, last = text.split("\n")
    return whole or [last]  # where no line is whole: say what is wrong with the only one


def _record(name: str, lines: list[str]) -> FlightRecord:
    """Return the flight that lines tell."""
    if not lines or not lines[0].strip():
        raise FileFormatError(one_line(f"{name}:1: is empty"))
    digest, changed = "", []
    head, rows = None, []
    for number, line in enumerate(lines, start=1):
        try:
            content = read_json(line, name)
        except FileFormatError as error:
            why = str(error).removeprefix(f"{name}:1: ")
            raise FileFormatError(one_line(f"{name}:{number}: {why}")) from error
        stated = _DIGEST.search(line)
        if stated is None or stated[1] != _digest(digest, line[: stated.start()]):
            changed.append(number)
        digest = stated[1] if stated else ""
        try:
            if head is None:
                head = decode_header(content)
            else:
                rows.append(decode_row(content, head[0].scenario))
        except ScenarioError as error:
            raise FileFormatError(one_line(f"{name}:{number}: {error}")) from error
    if head is None:
        raise FileFormatError(one_line(f"{name}:1: is empty"))
    plan, settings, versions = head
    return FlightRecord(plan, settings, tuple(rows), tuple(changed), versions)


def _digest(before: str, text: str) -> str:
    """Return the digest of a line's text, the digests of all lines before in it."""
    return hashlib.sha256(f"{before}\n{text}".encode()).hexdigest()[:16]


class FlightWriter:
    """Appends ticks to a flight file; each is on the disk when `append` returns.

    Made by `begin` or `go_on`; to be closed, or used as a context.
    """

    def __init__(self, file: BinaryIO, digest: str, name: str) -> None:
        self._file, self._digest, self._name = file, digest, name

    @classmethod
    def begin(
        cls,
        path: str | os.PathLike[str],
        plan: Plan,
        settings: FlightSettings,
        versions: Mapping[str, str],
    ) -> FlightWriter:
        """Start a file; what stood there is gone.

        Parameters
        ----------
        path : path
            Where.
        plan, settings, versions
            As in `FlightRecord`.

        Raises
        ------
        FileFormatError
            If another process is writing it, or it is no file.
        OSError
            If it cannot be written.
        """
        file = _locked(path, os.O_CREAT)
        file.truncate(0)
        writer = cls(file, "", os.fspath(path))
        writer._write(encode_header(plan, settings, versions))
        _settle_folder(path)
        return writer

    @classmethod
    def go_on(cls, path: str | os.PathLike[str]) -> tuple[FlightWriter, FlightRecord]:
        """Open a file to append to it, and return what it holds.

        Parameters
        ----------
        path : path
            What `begin` started; a line that was cut while it was written is removed.

        Raises
        ------
        FileFormatError
            If it is no flight, is not as it was written, or another process is writing it.
        OSError
            If it cannot be written.
        """
        check_path(path)
        name = os.fspath(path)
        file = _locked(path, 0)
        try:
            lines = _whole_lines(read_text(path))
            record = _record(name, lines)
            if record.changed:
                line = record.changed[0]
                raise FileFormatError(
                    one_line(f"{name}:{line}: was changed after it was written: nothing is added")
                )
        except BaseException:
            file.close()
            raise
        kept = file.read().rfind(b"\n") + 1
        if kept:
            file.truncate(kept)
        file.seek(0, os.SEEK_END)
        if not kept:  # a header that is whole but for its line end
            file.write(b"\n")
        found = _DIGEST.search(lines[-1])
        return cls(file, found[1] if found else "", name), record

    def append(self, row: TickRow) -> None:
        """Write a tick, and wait until it is on the disk.

        Raises
        ------
        OSError
            If it cannot be written.
        """
        self._write(encode_row(row))

    def close(self) -> None:
        """Let others write."""
        self._file.close()

    def __enter__(self) -> FlightWriter:
        """Use it as a context."""
        return self

    def __exit__(self, *error: object) -> None:
        """Close it."""
        self.close()

    def _write(self, content: dict[str, object]) -> None:
        """Write a line whole, its digest last."""
        text = json.dumps(content, ensure_ascii=False, allow_nan=False)[:-1]
        self._digest = _digest(self._digest, text)
        try:
            self._file.write(f'{text}, "digest": "{self._digest}"}}\n'.encode())
            self._file.flush()
            os.fsync(self._file.fileno())
        except OSError as error:
            raise OSError(error.errno, error.strerror, self._name) from error


def _locked(path: str | os.PathLike[str], flags: int) -> BinaryIO:
    """Return a file that no other process writes, open to be read and written."""
    if Path(path).exists() and not Path(path).is_file():
        # A pipe cannot be gone on with, and opening one may wait for ever.
        raise FileFormatError(one_line(f"{os.fspath(path)}: a flight needs a file of its own"))
    file = os.fdopen(os.open(path, os.O_RDWR | flags, 0o666), "r+b")
    if not try_lock(file):
        file.close()
        raise FileFormatError(one_line(f"{os.fspath(path)}: is being written by another flight"))
    return file


def _settle_folder(path: str | os.PathLike[str]) -> None:
    """Make a new file's name durable, too."""
    if os.name == "nt":
        return  # Windows opens no folders
    folder = os.open(Path(path).resolve().parent, os.O_RDONLY)
    try:
        os.fsync(folder)
    finally:
        os.close(folder)
