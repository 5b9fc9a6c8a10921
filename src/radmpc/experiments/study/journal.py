"""Rows on disk: appended durably one by one, read back whole after any end."""

from __future__ import annotations

import json
import os
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import asdict
from pathlib import Path
from typing import IO, Any

from pydantic import TypeAdapter, ValidationError

from radmpc.errors import FileFormatError
from radmpc.experiments.study.trial import Row
from radmpc.system.locking import try_lock

__all__ = ["Journal", "read_rows"]

_ROW = TypeAdapter(Row)


def read_rows(path: Path) -> tuple[Row, ...]:
    """Return the rows of a journal, in the order they were written.

    Parameters
    ----------
    path : Path
        The journal; one that does not exist is empty.

    Raises
    ------
    FileFormatError
        If a whole line is no row. A last line without an end was cut off by a kill, and is left
        out.
    """
    if not path.exists():
        return ()
    content = path.read_bytes()
    whole = content[: content.rfind(b"\n") + 1]
    rows = []
    for number, line in enumerate(whole.splitlines(), start=1):
        try:
            rows.append(_ROW.validate_json(line))
        except ValidationError as error:
            reason = error.errors()[0]["msg"]
            raise FileFormatError(f"{path}: line {number}: not a row: {reason}") from error
    return tuple(rows)


class Journal:
    """An open journal.

    Parameters
    ----------
    path : Path
        The file.
    file : binary file
        The same, opened for reading and writing.
    """

    def __init__(self, path: Path, file: IO[bytes]) -> None:
        self.path = path
        self._file = file

    @classmethod
    @contextmanager
    def opened(cls, path: Path) -> Iterator[Journal]:
        """Open a journal for appending; a line that a kill cut off is removed.

        Raises
        ------
        FileFormatError
            If another process has it open.
        """
        with open(path, "a+b") as file:
            if not try_lock(file):
                raise FileFormatError(f"{path}: another run is writing to it")
            file.seek(0)
            content = file.read()
            file.truncate(content.rfind(b"\n") + 1)
            yield cls(path, file)

    def append(self, row: Row) -> None:
        """Write a row; when this returns it is on the disk."""
        values: dict[str, Any] = asdict(row)
        line = json.dumps(values, ensure_ascii=False, allow_nan=False) + "\n"
        # One write: a line is there whole, or is the last and has no end.
        self._file.write(line.encode("utf-8"))
        self._file.flush()
        os.fsync(self._file.fileno())
