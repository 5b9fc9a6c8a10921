"""Changes of a document: values at paths replaced, added or taken away; what was before stays."""

from __future__ import annotations

import json
from collections.abc import Sequence

from radmpc.errors import ScenarioError
from radmpc.io.native.plain import plain_mapping
from radmpc.serving.failures import refused
from radmpc.serving.protocol import Change, Content, Path

__all__ = ["changed", "check_changes", "check_size"]

_MOST_CHANGES, _MOST_KEYS = 20_000, 20
"""Values that one change replaces, and keys of a path [-]."""

_MOST_BYTES = 16 * 2**20
"""Size of a document as JSON [bytes]."""


def check_changes(changes: object) -> list[Change]:
    """Return changes as they came from the page, checked.

    Raises
    ------
    CallError
        If they are no changes.
    """
    if not isinstance(changes, list) or len(changes) > _MOST_CHANGES:
        raise refused(f"changes must be a list of at most {_MOST_CHANGES:,}")
    for change in changes:
        path = change.get("path") if isinstance(change, dict) else None
        keys = path if isinstance(path, list) else []
        is_path = 0 < len(keys) <= _MOST_KEYS and all(
            isinstance(key, str) or (isinstance(key, int) and not isinstance(key, bool))
            for key in keys
        )
        if not is_path or not change.keys() <= {"path", "value"}:
            raise refused("a change must be a path of keys and indices, and a value")
        try:
            plain_mapping({key: None for key in keys if isinstance(key, str)}, ())
        except ScenarioError as error:
            raise refused(error.message) from error
    return changes


def changed(content: Content, changes: Sequence[Change]) -> Content:
    """Return a document after some changes, one after the other.

    Parameters
    ----------
    content : mapping
        The document; it stays as it is, and shares what is not changed.
    changes : sequence of Change
        Checked.

    Raises
    ------
    CallError
        If a path leads nowhere, or a value cannot stand in a file.
    """
    for change in changes:
        try:
            plain_mapping({"value": change.get("value")}, ())
        except ScenarioError as error:
            raise refused(error.message, change["path"]) from error
        result = _with(content, list(change["path"]), change)
        if not isinstance(result, dict):
            raise refused("a document is a mapping", [])
        content = result
    return content


def check_size(content: Content) -> None:
    """Refuse a document that has grown too large."""
    if len(json.dumps(content, ensure_ascii=False)) > _MOST_BYTES:
        raise refused(f"a document must be at most {_MOST_BYTES // 2**20} MiB")


def _with(part: object, path: list[str | int], change: Change) -> object:
    """Return a part with the value at a path within it replaced."""
    if not path:
        return change.get("value")
    head, *rest = path
    if isinstance(part, list):
        return _with_item(part, head, rest, change)
    if (part is None or isinstance(part, dict)) and isinstance(head, str):
        entries = dict(part or {})
        if not rest and "value" not in change:
            entries.pop(head, None)
        else:
            entries[head] = _with(entries.get(head), rest, change)
        return entries
    raise _nowhere(change["path"])


def _with_item(
    items: list[object], head: str | int, rest: list[str | int], change: Change
) -> list[object]:
    """Return a list with an item replaced, added at its end, or taken away."""
    is_new = head == len(items) and "value" in change
    if not isinstance(head, int) or not (0 <= head < len(items) or is_new):
        raise _nowhere(change["path"])
    if not rest and "value" not in change:
        return [*items[:head], *items[head + 1 :]]
    before = None if is_new else items[head]
    return [*items[:head], _with(before, rest, change), *items[head + 1 :]]


def _nowhere(path: Path) -> Exception:
    """Return the error of a path that leads nowhere."""
    return refused("there is nothing at this place", path)
