"""Tables and pictures that notebooks show for a value."""

from __future__ import annotations

import re
import warnings
from base64 import b64encode
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from html import escape

__all__ = ["html_picture", "html_table", "lacking_signs", "listed", "signs_text"]

_SIGN = re.compile(r"Glyph (\d+) .*missing from")
"""How matplotlib says that a font lacks a letter, by its number in Unicode."""

_MOST_NAMES = 8
"""Names that a notebook's table lists; the rest is counted."""


def html_table(facts: Sequence[tuple[str, str]]) -> str:
    """Return facts as part of a page, one per row.

    Parameters
    ----------
    facts : sequence of (str, str)
        What and how much, as plain text: names come from files, and are no HTML.

    Returns
    -------
    str
        A ``table`` element.
    """
    rows = "".join(
        f'<tr><th style="text-align:left">{escape(name)}</th>'
        f'<td style="text-align:left">{escape(text)}</td></tr>'
        for name, text in facts
    )
    return f"<table>{rows}</table>"


def listed(names: Sequence[str]) -> str:
    """Return how many there are and, of eight at most, what they are called."""
    if not names:
        return "none"
    more = f" and {len(names) - _MOST_NAMES} more" if len(names) > _MOST_NAMES else ""
    return f"{len(names)}: {', '.join(names[:_MOST_NAMES])}{more}"


@contextmanager
def lacking_signs() -> Iterator[set[str]]:
    """Draw without Python's warnings of letters that the font lacks, one for each.

    Other warnings are given as ever.

    Yields
    ------
    set of str
        After the block, the letters that boxes stand for.
    """
    lacking: set[str] = set()
    with warnings.catch_warnings(record=True) as caught:
        warnings.filterwarnings("always", message="Glyph ", category=UserWarning)
        yield lacking
    for one in caught:
        if found := _SIGN.match(str(one.message)):
            lacking.add(chr(int(found[1])))
        else:
            warnings.warn_explicit(one.message, one.category, one.filename, one.lineno)


def signs_text(lacking: Iterable[str]) -> str:
    """Return a line that says which letters boxes stand for."""
    return f"the font has no sign for {', '.join(sorted(lacking))}: boxes stand for them"


def html_picture(content: bytes, kind: str, name: str, lacking: Iterable[str]) -> str:
    """Return a picture as part of a page and, below it, what it could not write.

    Parameters
    ----------
    content : bytes
        The file.
    kind : str
        ``png`` or ``gif``.
    name : str
        What stands where it cannot be shown, as plain text.
    lacking : iterable of str
        Letters that the font lacks.
    """
    data = b64encode(content).decode("ascii")
    image = f'<img alt="{escape(name)}" src="data:image/{kind};base64,{data}"/>'
    signs = sorted(lacking)
    return f"{image}<p>{escape(signs_text(signs))}</p>" if signs else image
