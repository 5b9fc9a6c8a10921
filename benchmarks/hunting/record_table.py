"""Tables of records that outlive a crash: a line each, synced at once, and gone on with."""

from __future__ import annotations

import csv
import os
from collections.abc import Mapping, Sequence
from pathlib import Path

__all__ = ["add_row", "rows_of"]


def rows_of(path: Path) -> list[dict[str, str]]:
    """Return the rows of an earlier run; a line cut off by its end is dropped.

    Parameters
    ----------
    path : Path
        The table, CSV; none is there before the first row.
    """
    if not path.exists():
        return []
    content = path.read_bytes()
    whole = content[: content.rfind(b"\n") + 1]
    if len(whole) < len(content):
        os.truncate(path, len(whole))
    return list(csv.DictReader(whole.decode("utf-8").splitlines()))


def add_row(path: Path, columns: Sequence[str], row: Mapping[str, object]) -> None:
    """Add a row, below the names of the columns where it is the first.

    Parameters
    ----------
    path : Path
        The table.
    columns : sequence of str
        Their order.
    row : mapping
        By their names.
    """
    with path.open("a", encoding="utf-8", newline="") as file:
        writer = csv.DictWriter(file, columns, lineterminator="\n")
        if file.tell() == 0:
            writer.writeheader()
        writer.writerow(row)
        file.flush()
        os.fsync(file.fileno())
