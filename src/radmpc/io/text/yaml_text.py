"""YAML 1.2 to plain values and their lines: no tags, no repeated keys, no exploding aliases."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence

from ruamel.yaml import YAML
from ruamel.yaml.error import MarkedYAMLError, YAMLError
from ruamel.yaml.events import (
    AliasEvent,
    DocumentStartEvent,
    Event,
    MappingEndEvent,
    MappingStartEvent,
    NodeEvent,
    ScalarEvent,
    SequenceEndEvent,
    SequenceStartEvent,
)
from ruamel.yaml.reader import ReaderError

from radmpc.errors import FileFormatError
from radmpc.io.ranges import MOST_OBSTACLES, MOST_VEHICLES
from radmpc.io.text.files import one_line, shown
from radmpc.io.text.lines import MAX_DEPTH, Place
from radmpc.records import dataclass, field

__all__ = ["NOT_YAML", "read_yaml"]

NOT_YAML = "not valid YAML"
"""What is said of text that cannot be parsed, before where and why."""

_MAX_ALIASED = 1_000_000
"""Values that all aliases together may stand for: a few lines could else fill the memory."""

_MAX_DIGITS = 400
"""Digits of an integer that is read as one; longer ones stay text."""

_MOST_ENTRIES = max(MOST_VEHICLES, MOST_OBSTACLES)

_DEPTH_OF_LISTS = 3
"""Depth of the long lists: the file, its mapping, a list in it."""

# The core schema of YAML 1.2, section 10.3.2: `yes` and `1_000` are text.
_WORDS: dict[str, object] = {
    **dict.fromkeys(["", "~", "null", "Null", "NULL"]),
    **dict.fromkeys(["true", "True", "TRUE"], True),
    **dict.fromkeys(["false", "False", "FALSE"], False),
    **dict.fromkeys([".nan", ".NaN", ".NAN"], float("nan")),
    **dict.fromkeys([s + w for s in ("", "+") for w in (".inf", ".Inf", ".INF")], float("inf")),
    **dict.fromkeys(["-.inf", "-.Inf", "-.INF"], float("-inf")),
}
_DECIMAL = re.compile(r"[-+]?[0-9]+")
_OCTAL = re.compile(r"0o([0-7]+)")
_HEX = re.compile(r"0x([0-9a-fA-F]+)")
_FLOAT = re.compile(r"[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?")


def read_yaml(text: str, name: str) -> tuple[object, Place]:
    """Return the value that a YAML text describes, and the lines of its parts.

    Parameters
    ----------
    text : str
        One document.
    name : str
        The file, for messages.

    Returns
    -------
    value : object
        None, bool, int, float, str, list and dict with text keys.
    places : Place
        Lines of everything in it.

    Raises
    ------
    FileFormatError
        If the text is no YAML, or uses tags, repeated keys, endless aliases or deep nesting.
    """
    builder = _Builder(name)
    try:
        for event in YAML(typ="safe", pure=True).parse(text):
            builder.take(event)
    except ReaderError as error:
        line = 1 + text.count("\n", 0, error.position)
        raise builder.failure(
            f"must be printable text, got {text[error.position]!r}", line
        ) from error
    except MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        what = ", ".join(str(part) for part in (error.context, error.problem) if part)
        line = 1 if mark is None else mark.line + 1
        raise builder.failure(f"{NOT_YAML}: {what}", line) from error
    except YAMLError as error:
        raise builder.failure(f"{NOT_YAML}: {error}", 1) from error
    if not builder.root.items:
        raise builder.failure("is empty", 1)
    return builder.root.items[0], builder.root.places[0]


@dataclass(slots=True)
class _Open:
    """A mapping or list whose end has not been seen."""

    line: int
    anchor: str | None
    is_mapping: bool
    keys: dict[str, None] = field(default_factory=dict)
    items: list[object] = field(default_factory=list)
    places: list[Place] = field(default_factory=list)
    key_line: int = 0
    size: int = 1


class _Builder:
    """Puts events together, without recursion."""

    def __init__(self, name: str) -> None:
        self.name = name
        self.root = _Open(1, None, False)
        self._stack = [self.root]
        self._anchors: dict[str, tuple[object, Place, int]] = {}
        self._num_documents = 0
        self._num_aliased = 0

    def failure(self, message: str, line: int) -> FileFormatError:
        """Return an error at a line."""
        return FileFormatError(one_line(f"{self.name}:{line}: {message}"))

    def take(self, event: Event) -> None:
        """Take the next event."""
        line = event.start_mark.line + 1
        if isinstance(event, NodeEvent):
            self._check(event, line)
        if isinstance(event, ScalarEvent):
            self._scalar(event, line)
        elif isinstance(event, MappingStartEvent | SequenceStartEvent):
            self._open(event, line)
        elif isinstance(event, MappingEndEvent | SequenceEndEvent):
            self._close()
        elif isinstance(event, AliasEvent):
            self._alias(event, line)
        elif isinstance(event, DocumentStartEvent):
            self._num_documents += 1
            if self._num_documents > 1:
                raise self.failure("must hold one document, a second one starts here", line)

    def _check(self, event: NodeEvent, line: int) -> None:
        """Refuse tags, and keys that are not plain text."""
        tag = getattr(event, "tag", None)
        if tag is not None:
            raise self.failure(
                f"tags are not allowed, got {shown(str(tag).replace('tag:yaml.org,2002:', '!!'))}",
                line,
            )
        if self._awaits_key() and not isinstance(event, ScalarEvent):
            raise self.failure("keys must be text", line)

    def _awaits_key(self) -> bool:
        """Whether the next node is the key of a mapping's entry."""
        top = self._stack[-1]
        return top.is_mapping and len(top.keys) == len(top.items)

    def _scalar(self, event: ScalarEvent, line: int) -> None:
        """Take a key or a scalar value."""
        if not self._awaits_key():
            is_plain = event.implicit[0]
            value = _plain_value(event.value) if is_plain else event.value
            self._add(value, line, None, 1, event.anchor)
            return
        top = self._stack[-1]
        if event.value in top.keys:
            raise self.failure(f"the key {shown(event.value)} stands twice", line)
        top.keys[event.value] = None
        top.key_line = line

    def _open(self, event: MappingStartEvent | SequenceStartEvent, line: int) -> None:
        """Start a mapping or a list."""
        if len(self._stack) > MAX_DEPTH:
            raise self.failure(f"must not be nested deeper than {MAX_DEPTH} levels", line)
        if event.anchor is not None:
            self._anchors.pop(event.anchor, None)
        self._stack.append(_Open(line, event.anchor, isinstance(event, MappingStartEvent)))

    def _close(self) -> None:
        """End a mapping or a list and hand it to what is around it."""
        done = self._stack.pop()
        if done.is_mapping:
            value: object = dict(zip(done.keys, done.items, strict=True))
            parts: dict[str, Place] | list[Place] = dict(zip(done.keys, done.places, strict=True))
        else:
            value, parts = done.items, done.places
        self._add(value, done.line, parts, done.size, done.anchor)

    def _alias(self, event: AliasEvent, line: int) -> None:
        """Put what an anchor named in place of its alias."""
        if event.anchor not in self._anchors:
            raise self.failure(f"the alias *{event.anchor} stands for nothing before it", line)
        value, place, size = self._anchors[event.anchor]
        self._num_aliased += size
        if self._num_aliased > _MAX_ALIASED:
            raise self.failure(f"aliases stand for more than {_MAX_ALIASED:,} values", line)
        self._add(value, line, place.parts, size, None)

    def _add(
        self,
        value: object,
        line: int,
        parts: Mapping[str, Place] | Sequence[Place] | None,
        size: int,
        anchor: str | None,
    ) -> None:
        """Add a finished value to what is around it."""
        top = self._stack[-1]
        place = Place(top.key_line if top.is_mapping else line, parts)
        is_counted = len(self._stack) == _DEPTH_OF_LISTS and not top.is_mapping
        if is_counted and len(top.items) >= _MOST_ENTRIES:
            # The rest would take long to read, and the file be refused all the same.
            raise self.failure(f"must have at most {_MOST_ENTRIES:,} entries, got more", top.line)
        top.items.append(value)
        top.places.append(place)
        top.size += size
        if anchor is not None:
            self._anchors[anchor] = (value, place, size)


def _plain_value(text: str) -> object:
    """Return what a scalar without quotes means."""
    if text in _WORDS:
        return _WORDS[text]
    # Longer numbers are no quantities, and Python refuses to print them.
    if len(text) <= _MAX_DIGITS:
        if _DECIMAL.fullmatch(text):
            return int(text)
        if _FLOAT.fullmatch(text):
            return float(text)
        if match := _OCTAL.fullmatch(text):
            return int(match[1], 8)
        if match := _HEX.fullmatch(text):
            return int(match[1], 16)
    return text
