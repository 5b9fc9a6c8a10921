"""The folder that the page may read and write: nothing outside it, only files of known kinds."""

from __future__ import annotations

import asyncio
import os
from collections.abc import Iterator
from hashlib import sha256
from pathlib import Path
from typing import Literal

from radmpc.serving.failures import exists, refused
from radmpc.serving.protocol import FileEntry
from radmpc.system.atomic import write_text

__all__ = ["CHARTS", "FLIGHTS", "SCENARIOS", "Folder"]

SCENARIOS = (".yaml", ".yml", ".json")
FLIGHTS = (".jsonl",)
CHARTS = (".geojson", ".kml", ".scen")

_LONGEST = 300
"""Letters of a path."""

_MOST_FILES, _DEEPEST, _MOST_SEEN = 1000, 5, 20_000
"""Files that are listed, levels of folders, and entries looked at."""

FileKind = Literal["scenario", "plan", "flight", "chart"]

_FORMATS: tuple[FileKind, ...] = ("flight", "plan", "scenario")
"""As files name them; a flight holds a plan, which holds a scenario."""

_SKIPPED = {"node_modules", "__pycache__"}

_HEAD = 400
"""Bytes in which a file says what it is."""


class Folder:
    """A folder, and nothing else of the disk.

    Parameters
    ----------
    root : Path
        There is one.

    Attributes
    ----------
    lock : asyncio.Lock
        Held from `writable` to the end of `write`: else two pages that name the same new file at
        once would both find it free.
    """

    def __init__(self, root: Path) -> None:
        self.root, self.lock = root.resolve(), asyncio.Lock()

    def readable(self, path: object, *suffixes: str) -> Path:
        """Return the file at a path that the page names.

        Parameters
        ----------
        path : str
            Relative, with ``/``.
        *suffixes : str
            Endings that are allowed.

        Raises
        ------
        CallError
            If it leads out of the folder, also by a link, ends otherwise, or there is no such file.
        """
        place = self._inside(path, suffixes)
        if not place.is_file():
            raise refused(f"{path}: there is no such file")
        return place

    def writable(self, path: object, *suffixes: str, overwrite: bool = False) -> Path:
        """Return where a file may be written; see `readable`.

        Parameters
        ----------
        path : str
            Relative, with ``/``.
        *suffixes : str
            Endings that are allowed.
        overwrite : bool
            Whether a file that is there may be replaced.

        Raises
        ------
        CallError
            As in `readable`; if its folder is not there, or a file is and is to stay.
        """
        place = self._inside(path, suffixes)
        if not place.parent.is_dir():
            raise refused(f"{path}: there is no such folder")
        if place.exists() and not place.is_file():
            raise refused(f"{path}: it is not a regular file")
        if place.exists() and not overwrite:
            raise exists(str(path))
        return place

    def name_of(self, place: Path) -> str:
        """Return the path by which the page names a file of the folder."""
        return place.relative_to(self.root).as_posix()

    def write(self, place: Path, text: str) -> None:
        """Write a file whole or not at all.

        Parameters
        ----------
        place : Path
            Writable, as `writable` has it.
        text : str
            What it is to hold.

        Raises
        ------
        CallError
            In the words of the system, without places outside the folder.
        """
        try:
            write_text(place, text)
        except OSError as error:
            reason = error.strerror or type(error).__name__
            raise refused(f"{self.name_of(place)}: {reason}") from error

    def digest(self, place: Path) -> str | None:
        """Return what tells a file's content from any other; None where it cannot be read."""
        try:
            return sha256(place.read_bytes()).hexdigest()
        except OSError:
            return None

    def files(self) -> list[FileEntry]:
        """Return the files that the page can open, in order."""
        found: list[FileEntry] = []
        for place in self._places():
            kind = _kind(place)
            size = _size(place)
            if kind is not None and size is not None and len(found) < _MOST_FILES:
                found.append({"path": self.name_of(place), "kind": kind, "bytes": size})
        return sorted(found, key=lambda entry: entry["path"])

    def _inside(self, path: object, suffixes: tuple[str, ...]) -> Path:
        """Return a place within the folder, links followed."""
        if not isinstance(path, str) or not 0 < len(path) <= _LONGEST or not path.isprintable():
            raise refused(f"a path must be text of at most {_LONGEST} letters")
        parts = path.split("/")
        is_plain = all(part and not part.startswith(".") for part in parts)
        if not is_plain or "\\" in path or ":" in path:
            raise refused("a path must lead into the folder, without '..' and hidden names")
        if not path.lower().endswith(suffixes):
            raise refused(f"{path}: must end in {', '.join(suffixes)}")
        place = Path(os.path.realpath(self.root.joinpath(*parts)))
        try:
            place.lstat()
        except (FileNotFoundError, NotADirectoryError):
            pass  # what that means is for those who ask
        except OSError as error:  # such as a name that is too long
            raise refused(f"{path}: {error.strerror or type(error).__name__}") from error
        if not place.is_relative_to(self.root) or not place.name.lower().endswith(suffixes):
            raise refused("a path must lead into the folder, without '..' and hidden names")
        return place

    def _places(self) -> Iterator[Path]:
        """Yield the files of the folder, none that is hidden or a link."""
        seen = 0
        folders = [(self.root, 0)]
        while folders:
            folder, depth = folders.pop()
            for place in _entries(folder):
                seen += 1
                if seen > _MOST_SEEN:
                    return
                if place.name.startswith(".") or place.name in _SKIPPED or place.is_symlink():
                    continue
                if not place.name.isprintable():  # nor could it be opened by that name
                    continue
                if place.is_file():  # a pipe would be waited for
                    yield place
                elif place.is_dir() and depth < _DEEPEST:
                    folders.append((place, depth + 1))


def _entries(folder: Path) -> list[Path]:
    """Return what is in a folder, nothing where it may not be read."""
    try:
        return sorted(folder.iterdir())
    except OSError:
        return []


def _size(place: Path) -> int | None:
    """Return a file's size [bytes], None where it is gone by now."""
    try:
        return place.stat().st_size
    except OSError:
        return None


def _kind(place: Path) -> FileKind | None:
    """Return what a file is, by its ending and its first lines."""
    suffix = place.suffix.lower()
    if suffix in CHARTS:
        return "chart"
    if suffix not in SCENARIOS and suffix not in FLIGHTS:
        return None
    try:
        with place.open("rb") as file:
            head = file.read(_HEAD).decode("utf-8", "replace")
            if suffix not in FLIGHTS and "radmpc/" not in head:
                # A long comment may stand before it.
                head += file.read(20 * _HEAD).decode("utf-8", "replace")
    except OSError:
        return None
    return next((kind for kind in _FORMATS if f"radmpc/{kind}/" in head), None)
