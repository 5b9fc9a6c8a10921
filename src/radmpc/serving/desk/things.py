"""Things on the desk by their names, and answers that are news to others."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, TypeVar

from radmpc.records import dataclass
from radmpc.serving.failures import CallError
from radmpc.serving.protocol import DocumentState

__all__ = ["Changed", "forget", "thing_of"]

_Thing = TypeVar("_Thing")


@dataclass(frozen=True, slots=True)
class Changed:
    """An answer that is news to all other pages.

    Attributes
    ----------
    state : DocumentState
        Of the document.
    """

    state: DocumentState


def thing_of(things: Mapping[str, _Thing], number: str, kind: str) -> _Thing:
    """Return a thing by its name.

    Parameters
    ----------
    things : mapping
        By their names.
    number : str
        A name.
    kind : str
        What it is, for the message.

    Raises
    ------
    CallError
        If there is none.
    """
    if number not in things:
        raise CallError("gone", f"there is no {kind} {number} any more")
    return things[number]


def forget(things: dict[str, Any], document: str, most: int) -> None:
    """Forget the oldest of a document's things that are over.

    Parameters
    ----------
    things : dict
        By their names; those forgotten are taken out.
    document : str
        Whose.
    most : int
        How many of them stay.
    """
    over = [n for n, thing in things.items() if thing.document == document and thing.is_over]
    for number in over[: max(0, len(over) - most)]:
        del things[number]
