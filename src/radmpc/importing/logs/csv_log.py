"""Logs as CSV: a header, a row per sample and vehicle."""

from __future__ import annotations

import csv
from collections.abc import Mapping, Sequence
from io import StringIO
from pathlib import Path

import numpy as np

from radmpc.arrays import Matrix
from radmpc.errors import FileFormatError, ScenarioError
from radmpc.identification.track import Track
from radmpc.importing.logs.recording import Recording, clock_of, refusal
from radmpc.io.text.files import read_text, shown
from radmpc.ranges import LARGEST

__all__ = ["COLUMNS", "MissingColumnError", "read_csv"]

_AXES = "xyz"
_PARTS = {
    "positions": "{axis}",
    "velocities": "v{axis}",
    "controls": "a{axis}",
    "references": "{axis}_ref",
    "reference_velocities": "v{axis}_ref",
    "second_positions": "{axis}2",
}
"""Names of columns by what they hold."""

_NEEDED = ("time", "x", "y")
"""Columns that every log has."""

COLUMNS = (
    "time",
    "vehicle",
    *(form.format(axis=axis) for form in _PARTS.values() for axis in _AXES),
)
"""What columns may be called, and what `columns` may say others are."""

_MISSING = {"", "nan", "na", "null", "none", "-"}
"""Texts that stand for a number that is not there."""


class MissingColumnError(FileFormatError):
    """A column that a log does not have, at least by that name.

    Attributes
    ----------
    cure : str
        What the message says to do about it in Python.
    names : dict
        Names of columns that would do, by what they hold; ``NAME`` where none is known.
    """

    def __init__(
        self, path: Path, name: str, header: Sequence[str], columns: Mapping[str, str]
    ) -> None:
        named = {key: called for key, called in columns.items() if called in header}
        lacking = [key for key in _NEEDED if columns.get(key, key) not in header]
        self.names = named | dict.fromkeys([*lacking, name], "NAME")
        entries = [
            f"{key!r}: {called if called == 'NAME' else repr(called)}"
            for key, called in self.names.items()
        ]
        self.cure = f"name it by columns={{{', '.join(entries)}}}"
        message = f"has no column {columns.get(name, name)!r} for {name}: {self.cure}"
        super().__init__(str(refusal(path, f"{message}; there are {', '.join(header)}")))


def read_csv(path: Path, columns: Mapping[str, str]) -> Recording:
    """Return the vehicles of a log.

    Parameters
    ----------
    path : Path
        The log.
    columns : mapping
        How the file calls what `COLUMNS` lists, where it uses other words.

    Returns
    -------
    Recording
        A track per vehicle; without a column ``vehicle`` one, named like the file.

    Raises
    ------
    FileFormatError
        If columns are missing or a cell is no number, or beyond 1e9; with its line.
    ScenarioError
        If ``columns`` names what is not known here, or a column twice.
    """
    unknown = [name for name in columns if name not in COLUMNS]
    if unknown:
        allowed = ", ".join(COLUMNS)
        raise ScenarioError(f"must name some of {allowed}; got {unknown[0]!r}", ("columns",))
    text = read_text(path)
    if not text.strip():
        raise refusal(path, "is empty")
    # Lines are counted as the file has them; those before the header may be blank.
    blank = len(text) - len(text.lstrip("\r\n \t"))
    blank = text.rfind("\n", 0, blank) + 1
    head = text[blank:].splitlines()[0]
    delimiter = max(",;\t", key=head.count)
    begin = text.count("\n", 0, blank) + 2
    rows = _rows(path, text[blank:], delimiter, begin - 2)
    header = _header(path, rows[0])
    places = _places(path, header, columns)
    numbers, vehicles = _table(path, rows[1:], header, places, begin)
    ignored = [name for i, name in enumerate(header) if name and i not in places.values()]
    warnings = (f"{path}: columns ignored: {', '.join(ignored)}",) if ignored else ()
    own: dict[str, list[int]] = {}
    for i, name in enumerate(vehicles):
        own.setdefault(name, []).append(i)
    tracks = tuple(_track(path, name, numbers[rows_of], places) for name, rows_of in own.items())
    return Recording(tracks, warnings)


def _rows(path: Path, text: str, delimiter: str, lines_before: int) -> list[list[str]]:
    """Return the cells of all rows, whatever ends the lines."""
    reader = csv.reader(StringIO(text, newline=None), delimiter=delimiter)
    try:
        return list(reader)
    except csv.Error as error:
        line = lines_before + reader.line_num
        raise refusal(path, f"line {line}: cannot be read as CSV: {error}") from error


def _header(path: Path, cells: Sequence[str]) -> list[str]:
    """Return the names of columns: most are no numbers."""
    header = [cell.strip() for cell in cells]
    if 2 * sum(map(_is_number, header)) > len(header):
        needed = ", ".join(_NEEDED)
        raise refusal(path, f"begins with numbers: its first line must name columns: {needed}")
    return header


def _is_number(cell: str) -> bool:
    """Whether a cell is that of a row rather than of a header."""
    try:
        float(cell)
    except ValueError:
        return False
    return True


def _places(path: Path, header: Sequence[str], columns: Mapping[str, str]) -> dict[str, int]:
    """Return where each known column stands."""
    doubled = next((name for name in header if name and header.count(name) > 1), None)
    if doubled is not None:
        raise refusal(path, f"has two columns {doubled!r}")
    found = {}
    for name in COLUMNS:
        called = columns.get(name, _own_name(name, header))
        if called in header:
            found[name] = header.index(called)
        elif name in columns or name in _NEEDED:
            raise MissingColumnError(path, name, header, columns)
        at = found.get(name)
        other = next((key for key, place in found.items() if key != name and place == at), None)
        if other is not None:
            called = f"{header[found[name]]!r} for {other} and for {name}"
            raise ScenarioError(f"must name every column once, got {called}", ("columns",))
    for form in _PARTS.values():
        names = [form.format(axis=axis) for axis in _AXES]
        given = [name for name in names if name in found]
        if given and given != names[: len(given)]:
            raise refusal(path, f"has {', '.join(given)}, but not {names[0]}")
        if given and len(given) < (3 if "z" in found else 2):
            missing = names[len(given)]
            raise refusal(path, f"has {', '.join(given)}, but no column {missing!r}")
        if len(given) == 3 and "z" not in found:
            raise refusal(path, f"has a column {given[2]!r}, but no column 'z'")
    return found


def _own_name(name: str, header: Sequence[str]) -> str:
    """Return how a header spells a column that goes by its own name, in whatever case."""
    if name in header:
        return name
    alike = [called for called in header if called.lower() == name]
    return alike[0] if len(alike) == 1 else name


def _table(
    path: Path,
    rows: Sequence[Sequence[str]],
    header: Sequence[str],
    places: Mapping[str, int],
    begin: int,
) -> tuple[Matrix, list[str]]:
    """Return the numbers of all rows, a column per place, and their vehicles."""
    wanted = [name for name in places if name != "vehicle"]
    numbers, vehicles = [], []
    for line, row in enumerate(rows, start=begin):
        if not any(cell.strip() for cell in row):
            continue
        if len(row) != len(header):
            raise refusal(path, f"line {line}: has {len(row)} cells, the header {len(header)}")
        numbers.append([_number(path, line, name, row[places[name]]) for name in wanted])
        vehicles.append(row[places["vehicle"]].strip() if "vehicle" in places else path.stem)
        if not vehicles[-1]:
            raise refusal(path, f"line {line}: has no name of a vehicle")
    if not numbers:
        raise refusal(path, "has a header and no row")
    table = np.full((len(numbers), len(header)), np.nan)
    table[:, [places[name] for name in wanted]] = numbers
    return table, vehicles


def _number(path: Path, line: int, name: str, cell: str) -> float:
    """Return the number in a cell, NaN where it says that there is none."""
    if cell.strip().lower() in _MISSING:
        return np.nan
    try:
        number = float(cell.replace("_", "x"))  # Python reads 1_5 as 15
    except ValueError as error:
        raise refusal(path, f"line {line}: {name} must be a number, got {shown(cell)}") from error
    # Those of times have no end: some count nanoseconds since 1970. What is infinite is missing.
    if LARGEST < abs(number) < np.inf and name != "time":
        allowed = f"must lie between {-LARGEST:.10g} and {LARGEST:.10g}"
        raise refusal(path, f"line {line}: {name} {allowed}, got {shown(cell)}")
    return number


def _track(path: Path, name: str, rows: Matrix, places: Mapping[str, int]) -> Track:
    """Return one vehicle's rows."""
    parts: dict[str, Matrix] = {}
    for part, form in _PARTS.items():
        names = [form.format(axis=axis) for axis in _AXES if form.format(axis=axis) in places]
        if names:
            parts[part] = rows[:, [places[one] for one in names]]
    speeds = parts.pop("reference_velocities", None)
    if speeds is not None and "references" in parts:
        parts["references"] = np.hstack([parts["references"], speeds])
    times = rows[:, places["time"]]
    return Track(name, str(path), clock_of(path, rows[:, places["time"]]), times, **parts)
