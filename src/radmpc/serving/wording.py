"""Sentences of the library in the words of the page."""

from __future__ import annotations

__all__ = ["for_page"]


def for_page(text: str) -> str:
    """Return sentences without the keys of a terminal: a page has a button for what they do.

    Parameters
    ----------
    text : str
        As the library has it.
    """
    return text.replace(" (Ctrl-C)", "")
