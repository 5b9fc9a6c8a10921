"""A file read: its value, and the lines of its parts for messages."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path

from radmpc.errors import FileFormatError, ScenarioError
from radmpc.io.text.files import one_line, read_text
from radmpc.io.text.json_text import read_json
from radmpc.io.text.lines import Place, json_places
from radmpc.io.text.yaml_text import read_yaml

__all__ = ["Document", "read_document"]

_MOST_YAML = 4 * 2**20  # reading a megabyte takes seconds; of JSON, milliseconds


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
        """Return the error of a value as one of this file: with its name and line."""
        places = json_places(self.text, self.name) if self.places is None else self.places
        line = places.line_of(error.path)
        return FileFormatError(one_line(f"{self.name}:{line}: {error}"))


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
    value, places = read_yaml(text, name)
    return Document(name, text, value, places)
