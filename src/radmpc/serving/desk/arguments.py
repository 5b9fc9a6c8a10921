"""Arguments of calls, checked one by one: a page may send anything."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from radmpc.serving.failures import refused

__all__ = ["flag", "integer", "number", "option", "text"]

_LONGEST = 500
"""Letters of a text, but for the content of files."""


def text(args: Mapping[str, Any], key: str, longest: int = _LONGEST) -> str:
    """Return a text.

    Parameters
    ----------
    args : mapping
        Of the call.
    key : str
        Which one.
    longest : int
        Letters that it may have.

    Raises
    ------
    CallError
        If it is none, or too long.
    """
    value = args.get(key)
    if not isinstance(value, str) or len(value) > longest:
        raise refused(f"{key} must be text of at most {longest:,} letters")
    return value


def option(args: Mapping[str, Any], key: str) -> str | None:
    """Return a text or None.

    Parameters
    ----------
    args : mapping
        Of the call.
    key : str
        Which one.

    Raises
    ------
    CallError
        As in `text`.
    """
    return None if args.get(key) is None else text(args, key)


def integer(args: Mapping[str, Any], key: str, least: int, most: int) -> int:
    """Return a whole number within bounds.

    Parameters
    ----------
    args : mapping
        Of the call.
    key : str
        Which one.
    least, most : int
        Its bounds.

    Raises
    ------
    CallError
        If it is none.
    """
    value = args.get(key)
    if isinstance(value, bool) or not isinstance(value, int) or not least <= value <= most:
        raise refused(f"{key} must be a whole number from {least:,} to {most:,}")
    return value


def number(args: Mapping[str, Any], key: str, least: float, most: float) -> float:
    """Return a number within bounds.

    Parameters
    ----------
    args : mapping
        Of the call.
    key : str
        Which one.
    least, most : float
        Its bounds.

    Raises
    ------
    CallError
        If it is none.
    """
    value = args.get(key)
    if isinstance(value, int | float) and not isinstance(value, bool) and least <= value <= most:
        return float(value)
    raise refused(f"{key} must be a number from {least:g} to {most:g}")


def flag(args: Mapping[str, Any], key: str) -> bool:
    """Return True or False.

    Parameters
    ----------
    args : mapping
        Of the call.
    key : str
        Which one.

    Raises
    ------
    CallError
        If it is neither.
    """
    value = args.get(key)
    if not isinstance(value, bool):
        raise refused(f"{key} must be true or false")
    return value
