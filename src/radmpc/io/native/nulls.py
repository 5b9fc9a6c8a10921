"""What ``null`` means in place of a scenario's values: a key or an entry of a list taken away."""

from __future__ import annotations

import typing
from collections.abc import Sequence
from typing import Any

from pydantic import BaseModel

from radmpc.io.native.checking import union_members
from radmpc.io.native.schema import ScenarioSpec

__all__ = ["Gone", "in_file", "is_taken_away", "without_gone"]

Path = tuple[str | int, ...]


class Gone(dict[str, object]):
    """Stands for an entry of a list that was taken away, until all changes are made."""


def is_taken_away(path: Path) -> bool:
    """Whether files know a key, and no ``null`` in its place.

    Where they know one it stands for something: ``speed: null`` of a goal leaves its speed free,
    ``feedback: null`` of a vehicle takes none from the defaults. A key that they do not know stays,
    to be refused.

    Parameters
    ----------
    path : path
        Of a value in a scenario, entries of lists counted.
    """
    match path:
        case ("vehicles", int(), "goal"):
            # Required here or in the defaults: a null of its own would only hide theirs.
            return True
    annotations: list[Any] = [ScenarioSpec]
    for part in path:
        annotations = [one for each in annotations for one in _parts(each, part)]
    members = [one for each in annotations for one in union_members(each)]
    return bool(members) and type(None) not in members


def without_gone(content: object, places: Sequence[Path]) -> tuple[object, tuple[Path, ...]]:
    """Return content without the entries that were taken away, and where those stood.

    Parameters
    ----------
    content : object
        Of a scenario, with `Gone` in place of the entries.
    places : sequence of path
        Of all that was changed.
    """
    gone = tuple(sorted({p for p in places if _holds_gone(content, p)}, reverse=True))
    for place in gone:
        content = _without(content, place)
    return content, gone


def in_file(path: Path, gone: Sequence[Path]) -> Path:
    """Return where a value stood before entries of lists were taken away.

    Parameters
    ----------
    path : path
        Where it stands without them.
    gone : sequence of path
        Where those stood.
    """
    found: Path = ()
    for part in path:
        place = part
        # The lowest first: each moves what stood behind it.
        for index in sorted(p[-1] for p in gone if p[:-1] == found and isinstance(p[-1], int)):
            if isinstance(place, int):
                place += index <= place
        found = (*found, place)
    return found


def _holds_gone(content: Any, place: tuple[Any, ...]) -> bool:
    """Whether an entry that was taken away stood at a place."""
    try:
        for part in place:
            content = content[part]
    except (IndexError, KeyError, TypeError):
        # A later change put something else there.
        return False
    return isinstance(content, Gone)


def _without(content: Any, place: Path) -> Any:
    """Return a copy, as deep as need be, without the entry at a place."""
    head: Any  # a key or an index
    head, *rest = place
    if isinstance(content, dict):
        return {**content, head: _without(content[head], tuple(rest))}
    entries = list(content)
    kept = [_without(entries[head], tuple(rest))] if rest else []
    return [*entries[:head], *kept, *entries[head + 1 :]]


def _parts(annotation: Any, part: str | int) -> list[Any]:
    """Return the types that a part of a value may have; none where it has no such part."""
    found = []
    for member in union_members(annotation):
        origin = typing.get_origin(member)
        if isinstance(part, int) and origin is list:
            found.append(typing.get_args(member)[0])
        elif isinstance(part, str) and origin is dict:
            found.append(typing.get_args(member)[1])
        elif isinstance(member, type) and issubclass(member, BaseModel):
            fields = member.model_fields.items()
            found += [f.annotation for name, f in fields if (f.alias or name) == part]
    return found
