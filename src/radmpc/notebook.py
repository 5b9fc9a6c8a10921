"""Tables that notebooks show for a value."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape

__all__ = ["html_table", "listed"]

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
