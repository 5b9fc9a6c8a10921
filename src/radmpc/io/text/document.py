"""A file read: its value, and the lines of its parts for messages."""

from __future__ import annotations

import os
import re
from pathlib import Path

from radmpc.errors import FileFormatError, ScenarioError
from radmpc.io.ranges import MOST_OBSTACLES, MOST_VEHICLES, SCENARIO_FORMAT
from radmpc.io.text.files import one_line, read_text
from radmpc.io.text.json_text import read_json
from radmpc.io.text.lines import Place, json_places
from radmpc.io.text.yaml_text import read_yaml
from radmpc.records import dataclass

__all__ = ["SCENARIO_LINE", "Document", "read_document"]

_MOST_NOTES = 9
"""Errors of one file that are told after the first."""

SCENARIO_LINE = re.compile(rf"^format: *[\"']?{SCENARIO_FORMAT}\b", re.MULTILINE)
"""The line by which a scenario in YAML is known before it is parsed."""

_LIST = re.compile(
    r"^(?P<key>vehicles|obstacles):[ \t]*(?:#.*)?\n(?:[ \t]*(?:#.*)?\n)*(?P<indent> *)-",
    re.MULTILINE,
)

_MOST_YAML = 4 * 2**20
"""Size of a YAML file [bytes]: reading a megabyte takes seconds; of JSON, milliseconds."""


@dataclass(frozen=True, slots=True, eq=False)
class Document:
    """What a file holds.

    Attributes
    ----------
    name : str
        The file as its user named it.
    text : str
        Its text.
    value : object
        Plain values: None, bool, int, float, str, list, dict.
    places : Place or None
        Lines of the parts; None if finding them was put off.
    """

    name: str
    text: str
    value: object
    places: Place | None

    def failure(self, error: ScenarioError) -> FileFormatError:
        """Return the error of a value as one of this file: with its name and line.

        What else is wrong follows as notes, a line each, nine at most and how many there are.
        """
        places = self._places_for(error)
        first, *rest = (
            one_line(f"{self.name}:{places.line_of(one.path)}: {one}")
            for one in (error, *error.more[:_MOST_NOTES])
        )
        failure = FileFormatError(first)
        for line in rest:
            failure.add_note(line)
        hidden = len(error.more) - len(rest)
        if hidden > 0:
            failure.add_note(one_line(f"{self.name}: {hidden} more like these"))
        return failure

    def _places_for(self, error: ScenarioError) -> Place:
        """Return the lines of what an error is about."""
        if self.places is not None:
            return self.places
        is_far_up = len(error.path) == 1 and not error.more and isinstance(error.path[0], str)
        key = str(error.path[0]) if is_far_up else None
        return json_places(self.text, self.name, until=key)


def _check_lists(text: str, name: str) -> None:
    """Refuse a scenario's block list that is too long, by its lines: parsing takes long.

    Raises
    ------
    FileFormatError
        With how many entries there are and how many are allowed.
    """
    if not SCENARIO_LINE.search(text):
        return
    for head in _LIST.finditer(text):
        # The indentation of the first item is that of all, and what is in them stands deeper.
        item = re.compile(rf"{head['indent']}-(?:[ \t]|$)")
        count = 0
        for line in text[head.start("indent") :].splitlines():
            if item.match(line):
                count += 1
            elif line[:1].strip(" \t-#"):
                break
        most = MOST_VEHICLES if head["key"] == "vehicles" else MOST_OBSTACLES
        if count > most:
            number = text.count("\n", 0, head.start()) + 1
            raise FileFormatError(
                one_line(
                    f"{name}:{number}: {head['key']}: must have at most {most:,} entries, "
                    f"got {count:,}"
                )
            )


def read_document(path: str | os.PathLike[str]) -> Document:
    """Return what a YAML or JSON file holds.

    Parameters
    ----------
    path : path
        Read as JSON if it ends in ``.json``; all else as YAML, of which JSON is a part.

    Returns
    -------
    Document
        The value, not yet checked.

    Raises
    ------
    FileFormatError
        If the file cannot be read, or is neither YAML nor JSON.
    """
    name = os.fspath(path)
    if Path(path).suffix.lower() == ".json":
        text = read_text(path)
        return Document(name, text, read_json(text, name), None)
    text = read_text(path, _MOST_YAML)
    _check_lists(text, name)
    value, places = read_yaml(text, name)
    return Document(name, text, value, places)
