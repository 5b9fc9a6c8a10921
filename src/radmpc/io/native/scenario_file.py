"""Scenario files: ``format: radmpc/scenario/1``, YAML or JSON."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path

from radmpc.arguments import check_kind, check_path
from radmpc.errors import FileFormatError, ScenarioError
from radmpc.io.native.changes import changed
from radmpc.io.native.decoding import decode_scenario
from radmpc.io.native.encoding import encode_scenario
from radmpc.io.ranges import PLAN_FORMAT
from radmpc.io.text.document import Document, read_document
from radmpc.io.text.files import one_line
from radmpc.io.text.json_text import write_json
from radmpc.io.text.yaml_writing import write_yaml
from radmpc.model.given import check_scenario
from radmpc.model.scenario import Scenario
from radmpc.system.atomic import write_text

__all__ = [
    "decode_scenario",
    "encode_scenario",
    "load_scenario",
    "read_scenario_document",
    "save_scenario",
]

_WRITERS = {".json": write_json, ".yaml": write_yaml, ".yml": write_yaml}


def load_scenario(
    path: str | os.PathLike[str], changes: Mapping[str, object] | None = None
) -> Scenario:
    """Return the scenario in a file.

    Parameters
    ----------
    path : path
        YAML, or JSON if the name ends in ``.json``.
    changes : mapping of str to object, optional
        Values that stand in place of the file's, by key: ``{"risk_bound": 0.02,
        "vehicles.tug.start": [0, 5]}``. An entry of a list is named, or counted from 0 in brackets:
        ``obstacles[0].min``. None takes away an entry, and a key for which files have no ``null``.

    Returns
    -------
    Scenario
        Checked in full.

    Raises
    ------
    FileFormatError
        With one line that names file, line, field, value and what is allowed.
    ScenarioError
        If a change is no value of a key that there can be.

    Examples
    --------
    >>> import radmpc
    >>> from importlib.resources import files
    >>> harbor = files("radmpc") / "data" / "harbor.yaml"
    >>> radmpc.load_scenario(harbor, {"risk_bound": 0.01, "vehicles.tug.radius": 0.5})
    Scenario('harbor', 5 vehicles, 3 obstacles, 12 steps of 1 s, risk bound 0.01)
    """
    check_path(path)
    if changes is not None:
        check_kind(changes, Mapping, "changes", "a mapping of values by key or None")
    document = read_scenario_document(path)
    content, places = changed(document.value, {} if changes is None else changes)
    try:
        return decode_scenario(content)
    except ScenarioError as error:
        told = places.in_file(error)
        if places.hold(told.path) or places.brought(told.path, document.value):
            raise ScenarioError(f"{told} (as set; the file is {document.name})") from error
        raise document.failure(told) from error


def read_scenario_document(path: str | os.PathLike[str]) -> Document:
    """Return what a scenario's file holds, not yet checked.

    Parameters
    ----------
    path : path
        As in `load_scenario`.

    Raises
    ------
    FileFormatError
        If the file cannot be read, or holds a plan.
    """
    document = read_document(path)
    if _is_plan(document.value):
        told = f"{document.name}: is a plan, not a scenario: give the scenario that was planned"
        raise FileFormatError(one_line(told))
    return document


def _is_plan(value: object) -> bool:
    """Whether a file's content is a plan, and no scenario whose format was mistyped."""
    if not isinstance(value, Mapping) or "scenario" not in value:
        return False
    return value.get("format") == PLAN_FORMAT


def save_scenario(scenario: Scenario, path: str | os.PathLike[str]) -> None:
    """Write a scenario to a file, whole or not at all; it reads back equal.

    Parameters
    ----------
    scenario : Scenario
        What to write.
    path : path
        Ends in ``.yaml``, ``.yml`` or ``.json``.

    Raises
    ------
    FileFormatError
        If the name ends otherwise.
    ArgumentTypeError
        If an argument is of another kind; the message says what to do instead.
    ScenarioError
        If the scenario holds what no file can, see `encode_scenario`.
    OSError
        If the file cannot be written.

    Examples
    --------
    >>> import radmpc
    >>> from pathlib import Path
    >>> from tempfile import TemporaryDirectory
    >>> from radmpc.experiments.families import paper
    >>> with TemporaryDirectory() as folder:
    ...     radmpc.save_scenario(paper(2, seed=1), Path(folder) / "fleet.yaml")
    ...     radmpc.load_scenario(Path(folder) / "fleet.yaml")
    Scenario('paper-2-1', 2 vehicles, 3 obstacles, 10 steps of 1 s, risk bound 0.05)
    """
    check_scenario(scenario)
    check_path(path)
    writer = _WRITERS.get(Path(path).suffix.lower())
    if writer is None:
        raise FileFormatError(
            one_line(f"{os.fspath(path)}: a scenario file must end in .yaml, .yml or .json")
        )
    write_text(path, writer(encode_scenario(scenario)))
