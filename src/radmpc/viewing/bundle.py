"""Where the page's code for notebooks is, if it was built."""

from __future__ import annotations

from importlib.util import find_spec
from pathlib import Path

from radmpc.errors import ArgumentError

__all__ = ["BUNDLE", "bundle_folder", "can_view"]

BUNDLE = Path(__file__).parent.parent / "serving" / "bundle"
"""The folder that `make page` writes, and wheels bring."""


def can_view() -> bool:
    """Whether both are here: the bundle, and the library that notebooks load it by."""
    return _lack() is None


def bundle_folder() -> Path:
    """Return the bundle's folder, if values can be viewed.

    Raises
    ------
    ArgumentError
        If something is missing; the message says how to get it.
    """
    lack = _lack()
    if lack is not None:
        raise ArgumentError(lack)
    return BUNDLE


def _lack() -> str | None:
    """Return what is missing, in one line."""
    if find_spec("anywidget") is None:
        return "view needs anywidget: pip install 'radmpc[notebook]'"
    if not (BUNDLE / "widget.js").is_file():
        return "view needs the page, which this installation lacks: make page in a checkout"
    return None
