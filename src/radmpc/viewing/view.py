"""Values as the page shows them, by a call."""

from __future__ import annotations

from typing import TYPE_CHECKING

from radmpc.viewing.bundle import bundle_folder
from radmpc.viewing.content import Viewable, view_content

if TYPE_CHECKING:
    from radmpc.viewing.widget import ValueView

__all__ = ["view"]


def view(value: Viewable) -> ValueView:
    """Show a value in a notebook as the page of ``radmpc serve`` does.

    Notebooks do so by themselves with the last value of a cell, where ``radmpc[notebook]`` is
    installed; this is for elsewhere in a cell, and to set the time by a program.

    Parameters
    ----------
    value : Result or Plan or Scenario
        What to show: map (scenes of three dimensions turn), timeline and ledger.

    Returns
    -------
    ValueView
        A widget of ``anywidget``. Its ``time`` [steps] follows the timeline, and moves it.

    Raises
    ------
    ArgumentTypeError
        If the value is none of these.
    ArgumentError
        If ``anywidget`` is not installed, or the page was not built.
    """
    content = view_content(value)
    bundle = bundle_folder()
    # An extra, and a second to load.
    from radmpc.viewing.widget import ValueView  # noqa: PLC0415 - few need it

    return ValueView(content, bundle)
