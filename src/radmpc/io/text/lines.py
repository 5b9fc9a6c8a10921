"""Where in a text something stands: a tree of line numbers, shaped like the data."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping, Sequence

from radmpc.errors import FileFormatError
from radmpc.io.text.files import one_line, shown
from radmpc.records import dataclass, field

__all__ = ["MAX_DEPTH", "Place", "json_places"]

MAX_DEPTH = 50
"""Levels of lists and mappings that a file may have."""

_TOKEN = re.compile(r'"(?:[^"\\]|\\.)*"|[\[\]{}:,]|[^\s\[\]{}:,"]+|\n', re.DOTALL)


@dataclass(frozen=True, slots=True, eq=False)
class Place:
    """The line on which a value starts, and the places of its parts.

    Attributes
    ----------
    line : int
        Counted from 1; of a mapping's entry, the line of its key.
    parts : mapping or sequence or None
        Places of entries by key, or of items; None for a scalar.
    """

    line: int
    parts: Mapping[str, Place] | Sequence[Place] | None = None

    def part(self, key: str | int) -> Place | None:
        """Return the place of an entry or item, None if there is none."""
        if isinstance(self.parts, Mapping):
            return self.parts.get(key) if isinstance(key, str) else None
        if self.parts is None or isinstance(key, str) or not 0 <= key < len(self.parts):
            return None
        return self.parts[key]

    def line_of(self, path: Sequence[str | int]) -> int:
        """Return the line of a value, or of the innermost thing around it that is there."""
        place = self
        for key in path:
            part = place.part(key)
            if part is None:
                break
            place = part
        return place.line


@dataclass(slots=True)
class _Open:
    """A mapping or list whose end has not been seen; its place grows with it."""

    line: int
    entries: dict[str, Place] | None
    items: list[Place] = field(default_factory=list)
    key: str | None = None
    key_line: int = 0

    def add(self, line: int, parts: dict[str, Place] | list[Place] | None) -> None:
        """Take the next value."""
        if self.entries is None:
            self.items.append(Place(line, parts))
        else:
            self.entries[self.key or ""] = Place(self.key_line, parts)
            self.key = None


def json_places(text: str, name: str, until: str | None = None) -> Place:
    """Return the places of a JSON text that is valid but for repeated keys and deep nesting.

    The standard parser tells no lines; this runs only once an error needs one.

    Parameters
    ----------
    text : str
        One JSON value.
    name : str
        The file, for messages.
    until : str or None
        A key of the outermost mapping at which to stop: what follows has no place. Large files
        take seconds to their end.

    Returns
    -------
    Place
        Of the value and its parts.

    Raises
    ------
    FileFormatError
        If a mapping holds a key twice, or values are nested too deep.
    """
    line = 1
    stack = [_Open(1, None)]
    for match in _TOKEN.finditer(text):
        token, top = match[0], stack[-1]
        if token == "\n":
            line += 1
        elif token in "[{":
            if len(stack) > MAX_DEPTH:
                raise FileFormatError(
                    one_line(f"{name}:{line}: must not be nested deeper than {MAX_DEPTH} levels")
                )
            stack.append(_Open(line, {} if token == "{" else None))
        elif token in "]}":
            stack.pop()
            stack[-1].add(top.line, top.items if top.entries is None else top.entries)
        elif token in ":,":
            continue
        elif top.entries is not None and top.key is None:
            top.key, top.key_line = json.loads(token), line
            if top.key in top.entries:
                raise FileFormatError(
                    one_line(f"{name}:{line}: the key {shown(top.key)} stands twice")
                )
            if len(stack) == 2 and top.key == until:
                return Place(top.line, {**top.entries, top.key: Place(line)})
        else:
            top.add(line, None)
    return stack[0].items[0]
