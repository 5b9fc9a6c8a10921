"""Keys of a scenario's content given other values before it is read: ``risk_bound``, ``0.02``."""

from __future__ import annotations

import re
from collections.abc import Mapping

from radmpc.errors import FileFormatError, ScenarioError, key_text
from radmpc.io.native.nulls import Gone, in_file, is_taken_away, without_gone
from radmpc.io.native.plain import plain_mapping
from radmpc.io.text.files import one_line, shown
from radmpc.io.text.yaml_text import read_yaml
from radmpc.records import dataclass

__all__ = ["Places", "changed", "key_path", "key_value", "split_key"]

Path = tuple[str | int, ...]

_NOTHING = object()
"""Stands where a key is not there."""


@dataclass(frozen=True, slots=True)
class Places:
    """Where a scenario's content was changed.

    Attributes
    ----------
    all : tuple of path
        Of every change, entries of lists counted as in the file.
    gone : tuple of path
        Of the entries of lists that were taken away.
    """

    all: tuple[Path, ...]
    gone: tuple[Path, ...] = ()

    def in_file(self, error: ScenarioError) -> ScenarioError:
        """Return an error of what was changed with its paths as in the file.

        Parameters
        ----------
        error : ScenarioError
            Of the content without what was taken away.
        """
        more = tuple(self.in_file(one) for one in error.more)
        return ScenarioError(error.message, in_file(error.path, self.gone), more)

    def hold(self, path: Path) -> bool:
        """Whether a value is one of those that were replaced, or a part of one.

        Parameters
        ----------
        path : path
            Of the value, as in the file.
        """
        return any(path[: len(place)] == place for place in self.all)

    def brought(self, path: Path, content: object) -> bool:
        """Whether a value holds one of those that were set, and the file has none there.

        Parameters
        ----------
        path : path
            Of the value, as in the file.
        content : object
            Of the file.
        """
        return not _has(content, path) and any(place[: len(path)] == path for place in self.all)


def _has(content: object, path: Path) -> bool:
    """Whether content has a value at a path."""
    for part in path:
        if isinstance(content, Mapping):
            content = content.get(part, _NOTHING)
        elif isinstance(content, list) and isinstance(part, int) and part < len(content):
            content = content[part]
        else:
            return False
    return content is not _NOTHING


_PART = re.compile(r"\.?(?P<key>[^.\[\]]+)|\[(?P<item>[^\[\]]+)\]")
_KEY = re.compile(r"[^.\[\]]+(?:\.[^.\[\]]+|\[[^\[\]]+\])*")

_MOST_DIGITS = 18
"""Digits of a number that counts entries."""


def split_key(text: str, allowed: str) -> tuple[str, str]:
    """Return the two sides of ``KEY=VALUE``.

    Parameters
    ----------
    text : str
        What was typed.
    allowed : str
        What is, for the message.

    Raises
    ------
    ScenarioError
        If either side is missing.
    """
    key, sign, value = text.partition("=")
    if not (key.strip() and sign and value.strip()):
        raise ScenarioError(f"must be {allowed}, got {shown(text)}")
    return key.strip(), value.strip()


def key_value(key: str, text: str) -> object:
    """Return the value that a text stands for in a scenario file.

    Parameters
    ----------
    key : str
        Whose value it is, for the message.
    text : str
        YAML on one line: ``0.02``, ``steps``, ``[0, 1]``, ``{model: double_integrator}``.

    Raises
    ------
    ScenarioError
        If it is no YAML.
    """
    try:
        return read_yaml(text, key)[0]
    except FileFormatError as error:
        raise ScenarioError(f"{key}: must be a value as in a file, got {shown(text)}") from error


def key_path(key: str) -> Path:
    """Return the parts of a key: ``vehicles.tug.radius``, ``obstacles[0].min``.

    Parameters
    ----------
    key : str
        Keys with dots between them. An entry of a list is named, or counted from 0 in brackets;
        brackets hold names with dots, too: ``vehicles[tug.2].radius``.

    Raises
    ------
    ScenarioError
        If it is none.
    """
    if not _KEY.fullmatch(key):
        raise ScenarioError(
            f"a key must be as in 'risk_bound' or 'vehicles.tug.radius', got {shown(key)}"
        )
    parts = [(match["key"], match["item"]) for match in _PART.finditer(key)]
    return tuple(int(item) if _counts(item) else name or item for name, item in parts)


def _counts(item: str | None) -> bool:
    """Whether what stands in brackets counts entries: no list has as many as take more digits."""
    return item is not None and item.isdecimal() and len(item) <= _MOST_DIGITS


def changed(content: object, changes: Mapping[str, object]) -> tuple[object, Places]:
    """Return a scenario's content with some values replaced, and where they stand.

    None takes away an entry of a list, and a key for which files have no ``null``.

    Parameters
    ----------
    content : object
        Of a scenario file, not yet checked; it stays as it is.
    changes : mapping of str to object
        Values by key, see `key_path`; a key that is not there is added.

    Returns
    -------
    content : object
        A copy as deep as the changes.
    places : Places
        Of every change, entries of lists counted as before the change.

    Raises
    ------
    ScenarioError
        If a key names an entry that is not there, or a part of what has none; if a value is not
        plain.
    """
    plain = plain_mapping(changes, ())
    places = []
    for key, value in plain.items():
        content, place = _with(content, key_path(key), value, key_text(key))
        places.append(place)
    content, gone = without_gone(content, places)
    return content, Places(tuple(places), gone)


def _with(
    content: object, path: Path, value: object, key: str, above: Path = ()
) -> tuple[object, Path]:
    """Return content with the value at a path replaced, and the path as it was found."""
    if not path:
        is_entry = value is None and isinstance(content, Mapping) and isinstance(above[-1], int)
        return (Gone() if is_entry else value), above
    head, *rest = path
    if isinstance(content, list):
        index = _index(content, head, key)
        part, place = _with(content[index], tuple(rest), value, key, (*above, index))
        return [*content[:index], part, *content[index + 1 :]], place
    if not isinstance(content, Mapping | None) or not isinstance(head, str):
        raise ScenarioError(f"{key}: {shown(content)} has no part {shown(head)}")
    entries = {} if content is None else dict(content)
    if value is None and not rest and is_taken_away((*above, head)):
        entries.pop(head, None)
        return entries, (*above, head)
    part, place = _with(entries.get(head), tuple(rest), value, key, (*above, head))
    return {**entries, head: part}, place


def _index(entries: list[object], head: str | int, key: str) -> int:
    """Return where in a list an entry stands that is counted or named."""
    if isinstance(head, int):
        if head < len(entries):
            return head
        raise ScenarioError(f"{key}: must name one of {len(entries)} entries from 0, got {head}")
    names = [entry.get("name") if isinstance(entry, Mapping) else None for entry in entries]
    if head in names:
        return names.index(head)
    known = one_line(", ".join(name for name in names if isinstance(name, str)))
    raise ScenarioError(
        f"{key}: there is no {shown(head)}, only {known or 'entries without names'}"
    )
