"""Rows of a sweep as CSV: written durably one by one, read back whole after any end."""

from __future__ import annotations

import csv
import hashlib
import io
import json
import os
from collections.abc import Sequence
from pathlib import Path
from typing import BinaryIO

from radmpc.errors import FileFormatError
from radmpc.experiments.sweeping import SweepPoint, Values
from radmpc.io.native.encoding import encode_scenario
from radmpc.model.scenario import Scenario
from radmpc.records import dataclass, fields
from radmpc.system.locking import try_lock

__all__ = ["SweepRow", "SweepTable", "scenario_digest", "sweep_row"]


@dataclass(frozen=True, slots=True)
class SweepRow:
    """One combination of values, and what planning made of it.

    Attributes
    ----------
    values : tuple of str
        One per axis, as JSON spells them.
    status : str
        Of the plan; ``failed`` where the solver gave up.
    cost, lower_bound : float or None
        Of the plan, and the bound on plans by its own half-spaces; None without.
    certified : float or None
        The certificate [-].
    within : bool
        Whether there is a plan whose certificate is within Δ.
    seconds : float
        What planning took [s].
    problem : str
        Why there is no plan; empty where there is one.
    scenario : str
        `scenario_digest` of what was planned.
    """

    values: Values
    status: str
    cost: float | None
    lower_bound: float | None
    certified: float | None
    within: bool
    seconds: float
    problem: str
    scenario: str


_COLUMNS = tuple(field.name for field in fields(SweepRow))[1:]


def sweep_row(point: SweepPoint) -> SweepRow:
    """Return the row of one scenario planned.

    Parameters
    ----------
    point : SweepPoint
        From `sweep`.
    """
    digest, result = scenario_digest(point.scenario), point.result
    if result is None:
        return SweepRow(
            point.values, "failed", None, None, None, False, 0.0, point.problem or "", digest
        )
    certificate = result.certificate
    return SweepRow(
        point.values,
        result.status.value,
        result.cost,
        result.lower_bound,
        None if certificate is None else certificate.certified,
        result.is_certified,
        result.seconds["total"],
        "" if result.plan is not None else result.explanation or "no plan",
        digest,
    )


def scenario_digest(scenario: Scenario) -> str:
    """Return what tells a scenario from others: the first letters of a hash of its content.

    Parameters
    ----------
    scenario : Scenario
        Any; names count.
    """
    text = json.dumps(encode_scenario(scenario), sort_keys=True)
    return hashlib.sha256(text.encode()).hexdigest()[:12]


class SweepTable:
    """A CSV file with a row per combination; what stands in it is not planned again.

    Parameters
    ----------
    path : Path
        The file; one that does not exist is made. A pipe or a device gets all rows, since nothing
        can be read back.
    axes : sequence of str
        Keys, the first columns.
    question : sequence of str
        Planner, seed, time limit and gap as text: the last column, the same in every row.

    Raises
    ------
    FileFormatError
        If it is no table of this sweep, or another process writes it.
    """

    def __init__(self, path: Path, axes: Sequence[str], question: Sequence[str]) -> None:
        self.path = path
        self._is_new = not path.exists()
        self._is_stream = not self._is_new and not path.is_file()
        self._has_header = False
        self._file = open(path, "wb") if self._is_stream else _locked(path)  # noqa: SIM115 - kept open
        self._header = [*axes, *_COLUMNS, "asked"]
        self._asked = " ".join(question)
        self._num_axes = len(axes)
        try:
            self.rows = () if self._is_stream else self._read()
        except BaseException:
            self.close()
            raise

    def append(self, row: SweepRow) -> None:
        """Write a row; when this returns it is on the disk, or in the pipe."""
        cells = [*row.values, *(_cell(getattr(row, name)) for name in _COLUMNS), self._asked]
        self._file.write((b"" if self._has_header else _line(self._header)) + _line(cells))
        self._file.flush()
        self._has_header = True
        if not self._is_stream:
            os.fsync(self._file.fileno())

    def close(self) -> None:
        """Let others write; a new table without any row is not left behind."""
        is_empty = not os.fstat(self._file.fileno()).st_size
        self._file.close()
        if is_empty and self._is_new:
            self.path.unlink(missing_ok=True)

    def _read(self) -> tuple[SweepRow, ...]:
        """Return what is there; a line that a kill cut off is removed."""
        self._file.seek(0)
        content = self._file.read()
        whole = content[: content.rfind(b"\n") + 1]
        self._has_header = bool(content)
        lines = list(csv.reader(io.StringIO(whole.decode("utf-8", "replace"))))
        if lines and lines[0] != self._header:
            raise FileFormatError(f"{self.path}:1: is no table of a sweep over these keys")
        if len(whole) < len(content) and lines:
            self._file.truncate(len(whole))
        return tuple(self._row(number, cells) for number, cells in enumerate(lines[1:], start=2))

    def _row(self, number: int, cells: list[str]) -> SweepRow:
        """Return one line's row."""
        if len(cells) != len(self._header):
            raise FileFormatError(f"{self.path}:{number}: must have {len(self._header)} cells")
        values, (*told, asked) = cells[: self._num_axes], cells[self._num_axes :]
        if asked != self._asked:
            raise FileFormatError(
                f"{self.path}:{number}: was made by '{asked}', not by '{self._asked}'"
            )
        entry = dict(zip(_COLUMNS, told, strict=True))
        try:
            cost, bound, certified = (
                float(entry[name]) if entry[name] else None
                for name in ("cost", "lower_bound", "certified")
            )
            seconds = float(entry["seconds"])
        except ValueError as error:
            raise FileFormatError(f"{self.path}:{number}: {error}") from error
        return SweepRow(
            tuple(values), entry["status"], cost, bound, certified, entry["within"] == "yes",
            seconds, entry["problem"], entry["scenario"],
        )  # fmt: skip


def _locked(path: Path) -> BinaryIO:
    """Return a table's file that no other process writes, open to be read and appended to."""
    file = open(path, "a+b")  # noqa: SIM115 - stays open, and locked, until the table is closed
    if not try_lock(file):
        file.close()
        raise FileFormatError(f"{path}: is being written by another sweep")
    return file


def _line(cells: Sequence[str]) -> bytes:
    """Return one line of CSV."""
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerow(cells)
    return text.getvalue().encode()


def _cell(value: object) -> str:
    """Return a value as text that reads back equal."""
    if value is None:
        return ""
    if isinstance(value, bool):
        return "yes" if value else "no"
    return repr(value) if isinstance(value, float) else str(value).replace("\n", " ")
