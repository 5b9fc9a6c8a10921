"""YAML for people: top-level keys in blocks, entries on lines of their own."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping, Sequence

__all__ = ["write_yaml"]

_WIDTH = 100
"""Letters of a line up to which lists and mappings stay on it."""

_INDENT = "  "

# Words that mean themselves in every version of YAML; all others are quoted.
_PLAIN = re.compile(r"[A-Za-z_][A-Za-z0-9_/.-]*")
_RESERVED = {"null", "true", "false", "yes", "no", "on", "off", "y", "n"}


def write_yaml(value: Mapping[str, object]) -> str:
    """Return YAML text: mappings in blocks as far as they do not fit on a line.

    Parameters
    ----------
    value : mapping
        Plain values, all numbers finite; floats are written so that they read back equal.

    Returns
    -------
    str
        One document.
    """
    return "\n".join(_entries(value, "")) + "\n"


def _entries(value: Mapping[str, object], indent: str) -> list[str]:
    """Return the lines of a mapping's entries."""
    lines = []
    for key, entry in value.items():
        head = f"{indent}{_text(key)}:"
        lines += _attached(head, entry, indent + _INDENT)
    return lines


def _items(value: Sequence[object], indent: str) -> list[str]:
    """Return the lines of a list's items."""
    lines = []
    for item in value:
        first, *rest = _attached(f"{indent}-", item, indent + _INDENT)
        if rest and isinstance(item, Mapping):
            # The first entry moves up beside the dash.
            first, rest = f"{indent}- {rest[0].lstrip()}", rest[1:]
        lines += [first, *rest]
    return lines


def _attached(head: str, value: object, indent: str) -> list[str]:
    """Return a head and its value: on one line if that fits, else the value below."""
    line = f"{head} {_flow(value)}"
    is_list = isinstance(value, Sequence) and not isinstance(value, str)
    if len(line) <= _WIDTH or not value or not (is_list or isinstance(value, Mapping)):
        return [line]
    if isinstance(value, Mapping):
        return [head, *_entries(value, indent)]
    if isinstance(value, Sequence) and all(isinstance(item, float | int) for item in value):
        return [line]
    return [head, *_items(value, indent)] if isinstance(value, Sequence) else [line]


def _flow(value: object) -> str:
    """Return a value on one line."""
    if isinstance(value, Mapping):
        return "{" + ", ".join(f"{_text(k)}: {_flow(v)}" for k, v in value.items()) + "}"
    if isinstance(value, str):
        return _text(value)
    if isinstance(value, Sequence):
        return "[" + ", ".join(_flow(item) for item in value) + "]"
    if isinstance(value, float):
        # Older parsers take 1e-05 for text; 1.0e-05 is a number to all.
        return re.sub(r"^(-?\d+)e", r"\1.0e", float.__repr__(value))
    return json.dumps(value)


def _text(text: str) -> str:
    """Return text as a plain word where it is one, else in quotes."""
    if _PLAIN.fullmatch(text) and text.lower() not in _RESERVED:
        return text
    quoted = json.dumps(text, ensure_ascii=False)
    return "".join(c if c.isprintable() else _escaped(c) for c in quoted)


def _escaped(character: str) -> str:
    """Return a character that YAML does not let stand as it is."""
    code = ord(character)
    return (
        f"\\x{code:02x}"
        if code < 0x100
        else f"\\u{code:04x}"
        if code < 0x10000
        else f"\\U{code:08x}"
    )
