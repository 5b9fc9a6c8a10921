"""Logs of any format, recognized by their names."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path

from radmpc.arguments import check_kind, check_path, value_text
from radmpc.errors import ArgumentTypeError, ScenarioError
from radmpc.identification.track import Track
from radmpc.importing.logs.bags import read_bag, read_mcap
from radmpc.importing.logs.csv_log import read_csv
from radmpc.importing.logs.recording import Recording, refusal
from radmpc.importing.logs.ulog import read_ulog

__all__ = ["read_logs"]

_TABLES = (".csv", ".tsv", ".txt")
"""Endings of tables, which alone have columns to be named."""

_READERS: dict[str, Callable[[Path], Recording]] = {
    ".mcap": read_mcap,
    ".ulg": read_ulog,
    ".db3": read_bag,
}
"""What reads the other logs, by their endings."""


def read_logs(
    paths: Sequence[str | os.PathLike[str]], columns: Mapping[str, str] | None = None
) -> Recording:
    """Return what logs hold, vehicle by vehicle.

    Parameters
    ----------
    paths : sequence of path
        CSV, MCAP, PX4 ULog (``.ulg``), or ROS 2 bags: folders, or a ``.db3`` in one.
    columns : mapping or None
        Names of columns in CSV, by what they hold; see `radmpc.importing.logs.csv_log.COLUMNS`.

    Returns
    -------
    Recording
        A track per log and vehicle.

    Raises
    ------
    FileFormatError
        With one line that names file and place.
    ArgumentTypeError
        If an argument is of another kind.
    ScenarioError
        If ``columns`` says what is not known, or there is no CSV to which it applies.
    """
    hint = "put it in a list" if isinstance(paths, str | os.PathLike) else ""
    if hint or not isinstance(paths, Iterable):
        raise ArgumentTypeError(
            f"paths must be a sequence of files, got {value_text(paths)}{hint and f': {hint}'}"
        )
    if columns is not None:
        check_kind(columns, Mapping, "columns", "a mapping of text or None")
    tracks: list[Track] = []
    warnings: list[str] = []
    files = [_checked(path) for path in paths]
    if columns and not any(path.suffix.lower() in _TABLES for path in files):
        raise ScenarioError("is for CSV, and no log is", ("columns",))
    for path in _once(files, warnings):
        found = _read(path, columns or {})
        tracks += found.tracks
        warnings += found.warnings
    return Recording(tuple(tracks), tuple(warnings))


def _checked(path: str | os.PathLike[str]) -> Path:
    """Return a path that is one."""
    check_path(path)
    return Path(path)


def _once(files: Sequence[Path], warnings: list[str]) -> list[Path]:
    """Return files without those of a bag that another of them stands for: they count once."""
    kept: list[Path] = []
    bags: dict[Path, Path] = {}
    folders = {_bag(path) for path in files} - {None}
    for path in files:
        bag = _bag(path)
        if bag is None and path.suffix.lower() == ".mcap" and _whole(path).parent in folders:
            bag = _whole(path).parent
        if bag is None:
            kept.append(path)
        elif bag in bags:
            warnings.append(f"{path}: is of the same bag as {bags[bag]}, and is read with it")
        else:
            bags[bag] = path
            kept.append(path if path.is_dir() or path.suffix == ".db3" else bag)
    return kept


def _bag(path: Path) -> Path | None:
    """Return the folder of the bag that a log stands for; None where it stands for itself."""
    if path.is_dir():
        return _whole(path)
    return _whole(path).parent if path.suffix.lower() == ".db3" else None


def _whole(path: Path) -> Path:
    """Return a path without links; one that links to itself is refused once it is read."""
    return Path(os.path.realpath(path))


def _read(path: Path, columns: Mapping[str, str]) -> Recording:
    """Return what one log holds."""
    suffix = path.suffix.lower()
    is_folder = path.is_dir()
    if suffix in _TABLES and not is_folder:
        return read_csv(path, columns)
    reader = read_bag if is_folder else _READERS.get(suffix)
    if reader is not None:
        try:
            return reader(path)
        except ScenarioError as error:  # of a track that cannot be one
            raise refusal(path, str(error)) from error
    if suffix == ".bag":
        raise refusal(path, "is a ROS 1 bag: convert it, 'rosbags-convert' does")
    known = ", ".join((_TABLES[0], *_READERS))
    raise refusal(path, f"a log must end in {known}, or be the folder of a bag")
