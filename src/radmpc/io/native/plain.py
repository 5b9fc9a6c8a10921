"""Free-form data, reduced to what both YAML and JSON can hold."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np

from radmpc.errors import ScenarioError
from radmpc.io.text.files import shown

__all__ = ["plain_mapping"]

_MAX_DEPTH = 20
"""Levels that free-form parts of a file may be nested."""

Path = tuple[str | int, ...]


def plain_mapping(value: Mapping[str, object], path: Path) -> dict[str, object]:
    """Return a copy made of dict, list, str, int, float, bool and None.

    Parameters
    ----------
    value : mapping
        Of a file or of a caller.
    path : tuple of str or int
        Where it stands.

    Raises
    ------
    ScenarioError
        If it holds anything else, numbers that are not finite, halves of characters, or too many
        levels.
    """
    if len(path) > _MAX_DEPTH:
        raise ScenarioError(f"must not be nested deeper than {_MAX_DEPTH} levels", path[:1])
    result = {}
    for key, entry in value.items():
        if not isinstance(key, str):
            raise ScenarioError(f"keys must be text, got {shown(key)}", path)
        if not _is_whole(key):
            raise ScenarioError("keys must be text that UTF-8 can encode", path)
        result[key] = _plain(entry, (*path, key))
    return result


def _plain(value: object, path: Path) -> object:
    """Return one value as plain data."""
    if isinstance(value, np.ndarray | np.generic):
        value = value.tolist()
    if isinstance(value, str) and not _is_whole(value):
        raise ScenarioError("must be text that UTF-8 can encode", path)
    if value is None or isinstance(value, str | bool | int):
        return value
    if isinstance(value, float):
        if not math.isfinite(value):
            raise ScenarioError(f"must be a finite number, got {value}", path)
        return value
    if isinstance(value, Mapping):
        return plain_mapping(value, path)
    if isinstance(value, Sequence) and not isinstance(value, bytes | bytearray):
        if len(path) > _MAX_DEPTH:
            raise ScenarioError(f"must not be nested deeper than {_MAX_DEPTH} levels", path[:1])
        return [_plain(item, (*path, i)) for i, item in enumerate(value)]
    raise ScenarioError(f"must be plain data, got {shown(value)}", path)


def _is_whole(text: str) -> bool:
    """Whether a file can hold a text: no halves of characters."""
    try:
        text.encode("utf-8")
    except UnicodeEncodeError:
        return False
    return True
