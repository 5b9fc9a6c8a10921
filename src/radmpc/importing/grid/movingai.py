"""Grid worlds of MovingAI: tasks in a ``.scen`` file, cells in the ``.map`` file beside it."""

from __future__ import annotations

import os
import re
from collections.abc import Mapping, Sequence
from pathlib import Path, PurePosixPath, PureWindowsPath

import numpy as np
from pydantic import Field

from radmpc.errors import FileFormatError, ScenarioError
from radmpc.importing.grid.cells import Cells
from radmpc.importing.grid.problem import MOST_CELLS, Task, free_cell, grid_problem
from radmpc.importing.problem import ForeignModel, ForeignProblem
from radmpc.io.native.checking import validated
from radmpc.io.text.document import Document
from radmpc.io.text.files import one_line, read_text, shown
from radmpc.io.text.lines import Place
from radmpc.wording import count_text

__all__ = ["is_movingai", "map_refusal", "read_movingai", "scen_document"]

_USUAL_AGENTS = 8
"""Vehicles that are taken from a scenario file unless a number is asked for."""

_FIELDS = ("bucket", "map", "width", "height", "x", "y", "goal x", "goal y", "length")
_WHOLE = re.compile(r"[0-9]{1,9}")
_FREE, _BLOCKED = ".GS", "@OTW"
_VERSION = re.compile(r"version\s+1(\.0*)?")


class _Task(ForeignModel):
    """One line."""

    map: str
    size: list[int]
    start: list[int]
    goal: list[int]


class _File(ForeignModel):
    """All lines."""

    tasks: list[_Task] = Field(min_length=1)


def map_refusal(path: str | os.PathLike[str]) -> FileFormatError:
    """Return why a map alone is no problem."""
    name = os.fspath(path)
    return FileFormatError(
        one_line(f"{name}: is a map without starts and goals: import the .scen file that names it")
    )


def scen_document(path: str | os.PathLike[str]) -> Document:
    """Return the tasks in a ``.scen`` file, not yet checked against the map.

    Raises
    ------
    FileFormatError
        If the file cannot be read, or a line is not of the format; with its line.
    """
    name = os.fspath(path)
    text = read_text(path)
    lines = [line.rstrip("\r") for line in text.split("\n")]
    if not text.strip():
        raise _failure(name, 1, "is empty")
    if not _VERSION.fullmatch(lines[0].strip()):
        raise _failure(name, 1, f"must be 'version 1', got {shown(lines[0])}")
    tasks: list[dict[str, object]] = []
    places: list[Place] = []
    for number, line in enumerate(lines[1:], start=2):
        if line.strip():
            tasks.append(_task(line, name, number))
            places.append(Place(number))
    if not tasks:
        raise _failure(name, 1, "needs at least one task, got none")
    value = {"movingai": "scen", "tasks": tasks}
    return Document(name, text, value, Place(1, {"tasks": Place(2, places)}))


def _task(line: str, name: str, number: int) -> dict[str, object]:
    """Return one line's fields."""
    fields = [part.strip() for part in line.split("\t" if "\t" in line else None)]
    fields = fields[: len(_FIELDS)] if not any(fields[len(_FIELDS) :]) else fields
    if len(fields) != len(_FIELDS):
        raise _failure(
            name, number, f"must have 9 fields ({', '.join(_FIELDS)}), got {len(fields)}"
        )
    for key, field in zip(_FIELDS[2:8], fields[2:8], strict=True):
        if not _WHOLE.fullmatch(field):
            raise _failure(name, number, f"{key}: must be a whole number >= 0, got {shown(field)}")
    numbers = [int(field) for field in fields[2:8]]
    return {
        "map": fields[1],
        "size": numbers[:2],
        "start": numbers[2:4],
        "goal": numbers[4:],
    }


def is_movingai(value: object) -> bool:
    """Whether a document is of tasks on a MovingAI map."""
    return isinstance(value, Mapping) and value.get("movingai") == "scen"


def read_movingai(document: Document) -> ForeignProblem:
    """Return the problem of a ``.scen`` file and the map beside it.

    Lines whose start or goal cell an earlier one has taken are ignored: in files for single
    vehicles every line is a problem of its own.

    Raises
    ------
    FileFormatError
        If the map is missing or is none.
    ScenarioError
        If a task does not fit the map; its path says which.
    """
    if not isinstance(document.value, Mapping):
        raise ScenarioError(f"must be a mapping, got {shown(document.value)}")
    file = validated(_File, document.value)
    name = _map_name(file.tasks)
    path = Path(document.name).parent / name
    try:
        blocked = _read_map(path)
    except FileFormatError as error:
        if os.path.isfile(path):
            raise
        raise ScenarioError(f"must stand beside this file: {error}", ("tasks", 0, "map")) from error
    starts, goals = set(), set()
    tasks: list[Task] = []
    for i, task in enumerate(file.tasks):
        if tuple(task.size) != blocked.shape:
            raise ScenarioError(
                f"must be of the map's size {list(blocked.shape)}, got {task.size}",
                ("tasks", i, "size"),
            )
        start = free_cell(task.start, blocked, ("tasks", i, "start"))
        goal = free_cell(task.goal, blocked, ("tasks", i, "goal"))
        if start not in starts and goal not in goals:
            starts.add(start)
            goals.add(goal)
            tasks.append((f"agent{len(tasks) + 1}", start, goal))
    passed = len(file.tasks) - len(tasks)
    lines = (
        f"{count_text(len(file.tasks), 'line')} of the file in their order, whatever their bucket"
    )
    if passed:
        lines += f"; {passed} ignored, whose start or goal an earlier one has taken"
    return grid_problem(
        document,
        "MovingAI",
        blocked,
        tasks,
        (("map", name), ("tasks", lines)),
        _USUAL_AGENTS,
    )


def _map_name(tasks: Sequence[_Task]) -> str:
    """Return the name of the one map that all tasks are on, without folders."""
    for i, task in enumerate(tasks):
        if task.map != tasks[0].map:
            raise ScenarioError(
                f"must be that of the first line, {shown(tasks[0].map)}, got {shown(task.map)}",
                ("tasks", i, "map"),
            )
    # Published files state the folders of their authors, of whatever system.
    name = PurePosixPath(PureWindowsPath(tasks[0].map).as_posix()).name
    if not name:
        raise ScenarioError(
            f"must be a file's name, got {shown(tasks[0].map)}", ("tasks", 0, "map")
        )
    return name


def _read_map(path: Path) -> Cells:
    """Return which cells of a ``.map`` file are blocked, (width, height)."""
    name = os.fspath(path)
    lines = [line.rstrip("\r") for line in read_text(path).split("\n")]
    while lines and not lines[-1].strip():
        lines.pop()
    sizes: dict[str, int] = {}
    first = 0
    for number, line in enumerate(lines, start=1):
        key, _, rest = line.strip().partition(" ")
        if key == "map":
            first = number
            break
        if key in {"height", "width"} and _WHOLE.fullmatch(rest.strip()) and int(rest):
            sizes[key] = int(rest)
        elif key != "type" or number > 1:
            raise _failure(
                name, number, f"must be 'type', 'height N', 'width N' or 'map', got {shown(line)}"
            )
    if len(sizes) < 2 or not first:
        raise _failure(name, max(first, 1), "needs the lines 'height N', 'width N' and 'map'")
    width, height = sizes["width"], sizes["height"]
    if width * height > MOST_CELLS:
        raise _failure(name, 1, f"must be at most {MOST_CELLS:,} cells, got {width:,} x {height:,}")
    rows = lines[first:]
    if len(rows) != height:
        raise _failure(name, first, f"must have {height} rows below, got {len(rows)}")
    for number, row in enumerate(rows, start=first + 1):
        if len(row) != width:
            raise _failure(name, number, f"must have {width} cells, got {len(row)}")
        if strange := set(row) - set(_FREE + _BLOCKED):
            raise _failure(
                name,
                number,
                f"cells must be of {_FREE} (free) and {_BLOCKED} (blocked), "
                f"got {shown(min(strange))}",
            )
    cells = np.frombuffer("".join(rows).encode("ascii"), dtype=np.uint8).reshape(height, width)
    return np.ascontiguousarray(np.isin(cells, list(_BLOCKED.encode("ascii"))).T)


def _failure(name: str, line: int, message: str) -> FileFormatError:
    """Return an error at a line of a file."""
    return FileFormatError(one_line(f"{name}:{line}: {message}"))
