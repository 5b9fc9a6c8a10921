"""Has notebooks show values by the page's view, where they can."""

from __future__ import annotations

import sys
from typing import Any

__all__ = ["show_in_notebooks"]

_SHOWN = (
    ("radmpc.result", "Result"),
    ("radmpc.model.plan", "Plan"),
    ("radmpc.model.scenario", "Scenario"),
)


def show_in_notebooks() -> None:
    """Register the view with the IPython that runs, if one does.

    Values are named, not imported: the package loads without them.
    """
    ipython = sys.modules.get("IPython")
    shell = ipython.get_ipython() if ipython else None
    # A terminal has no place for pictures.
    if shell is None or not hasattr(shell, "kernel"):
        return
    formatter = shell.display_formatter.mimebundle_formatter
    for module, name in _SHOWN:
        formatter.for_type_by_name(module, name, _mime_bundle)


def _mime_bundle(value: Any, include: Any = None, exclude: Any = None) -> Any:
    """Return a value's view, beside which IPython puts what pages without widgets show."""
    # Whoever displays a value has it, and most of what its view needs, loaded already.
    from radmpc.viewing.bundle import can_view  # noqa: PLC0415 - notebooks alone need it

    if not can_view():
        return None
    from radmpc.viewing.view import view  # noqa: PLC0415 - notebooks alone need it

    made = view(value)._repr_mimebundle_(include=include, exclude=exclude)
    # Versions of the library return one or both.
    data, metadata = made if isinstance(made, tuple) else (made, {})
    return {**(data or {}), "text/plain": repr(value)}, metadata
