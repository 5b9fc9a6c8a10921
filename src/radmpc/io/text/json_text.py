"""JSON with readable lines: a matrix takes a line per row, not per number."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence

from radmpc.errors import FileFormatError
from radmpc.io.text.files import one_line
from radmpc.io.text.lines import json_places

__all__ = ["read_json", "write_json"]

_WIDTH = 120
"""Letters of a line up to which lists and mappings stay on it."""

_MAX_DIGITS = 400
"""Digits of an integer that is read as one; longer ones become floats, up to inf."""

_INDENT = "  "


class _RepeatedKeyError(ValueError):
    """A mapping holds a key twice; the standard parser would keep the last."""


def read_json(text: str, name: str) -> object:
    """Return the value that a JSON text describes.

    Parameters
    ----------
    text : str
        One JSON value.
    name : str
        The file, for messages.

    Returns
    -------
    object
        None, bool, int, float, str, list and dict.

    Raises
    ------
    FileFormatError
        If the text is no JSON, or a mapping holds a key twice.
    """
    if not text.strip():
        raise FileFormatError(one_line(f"{name}:1: is empty"))
    try:
        return json.loads(text, object_pairs_hook=_distinct, parse_int=_integer)
    except _RepeatedKeyError:
        json_places(text, name)
        raise
    except json.JSONDecodeError as error:
        raise FileFormatError(
            one_line(f"{name}:{error.lineno}: not valid JSON: {error.msg}, column {error.colno}")
        ) from error
    except RecursionError:
        json_places(text, name)
        raise


def _integer(digits: str) -> float:
    """Return an integer; longer ones than Python reads become inf, which the checks refuse."""
    return int(digits) if len(digits) <= _MAX_DIGITS else float(digits)


def _distinct(pairs: list[tuple[str, object]]) -> dict[str, object]:
    """Return a mapping's entries, refusing a key that stands twice."""
    entries = dict(pairs)
    if len(entries) < len(pairs):
        raise _RepeatedKeyError
    return entries


def write_json(value: Mapping[str, object]) -> str:
    """Return JSON text in lines of about 120 characters where the data allows.

    Parameters
    ----------
    value : mapping
        Plain values; floats are written so that they read back equal.

    Returns
    -------
    str
        What fits stands on one line; lists of numbers always do.

    Raises
    ------
    FileFormatError
        If a number is not finite.
    """
    try:
        return _written(value, "") + "\n"
    except ValueError as error:
        raise FileFormatError(f"cannot be written: {error}") from error


def _written(value: object, indent: str) -> str:
    """Return a value's text, its later lines indented."""
    if isinstance(value, Mapping):
        parts = [
            f"{json.dumps(key)}: {_written(entry, indent + _INDENT)}"
            for key, entry in value.items()
        ]
        return _joined(parts, "{}", indent)
    if isinstance(value, Sequence) and not isinstance(value, str):
        if all(isinstance(item, float | int) for item in value):
            return json.dumps(value, allow_nan=False)
        return _joined([_written(item, indent + _INDENT) for item in value], "[]", indent)
    return json.dumps(value, allow_nan=False)


def _joined(parts: list[str], brackets: str, indent: str) -> str:
    """Return parts between brackets, on one line if they fit."""
    length = sum(len(part) + 2 for part in parts)
    if length + len(indent) <= _WIDTH and not any("\n" in part for part in parts):
        return brackets[0] + ", ".join(parts) + brackets[1]
    inner = indent + _INDENT
    return f"{brackets[0]}\n{inner}" + f",\n{inner}".join(parts) + f"\n{indent}{brackets[1]}"
