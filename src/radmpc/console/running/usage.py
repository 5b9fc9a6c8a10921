"""What is wrong with a command line: the option, the value, and what is allowed."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from radmpc.io.text.files import one_line, shown

__all__ = ["usage_line"]

_ALLOWED: Mapping[str, str] = {
    "greater_than_equal": "must be at least {ge:.10g}",
    "less_than_equal": "must be at most {le:.10g}",
    "int_parsing": "must be a whole number",
    "int_parsing_size": "must be a whole number of fewer digits",
    "float_parsing": "must be a number",
}
"""What typer's checks of values, which are pydantic's, allow; by the name of the check."""


def usage_line(error: Any) -> str:
    """Return what is wrong with the command line and where help is.

    Parameters
    ----------
    error : usage error of typer
        As raised: for a value that is refused, because of pydantic's error that names the value.
    """
    context = getattr(error, "ctx", None)
    command = "radmpc" if context is None else context.command_path
    find = getattr(error.__cause__, "errors", None)
    found = [] if find is None else find()
    if len(found) == 1 and hasattr(error, "message"):
        # Typer's words say what is allowed, but not what was given.
        error.message = _value_text(found[0])
    text = error.format_message().rstrip(".")
    # What ends in a question goes on with a sentence of its own.
    see = " See" if text.endswith("?") else "; see"
    return one_line(f"{text}{see} '{command} --help'")


def _value_text(detail: Mapping[str, Any]) -> str:
    """Return what is allowed, and the value."""
    allowed = _ALLOWED.get(detail["type"])
    text = detail["msg"] if allowed is None else allowed.format(**detail.get("ctx", {}))
    given = detail["input"]
    # As it was typed: numbers come as text.
    is_plain = isinstance(given, int | float) or (isinstance(given, str) and given.strip())
    return f"{text}, got {given if is_plain else shown(given)}"
