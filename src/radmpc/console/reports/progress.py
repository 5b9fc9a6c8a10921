"""One line that says what planning is at, on a terminal only."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager

from rich.console import Console
from rich.text import Text

__all__ = ["ProgressCallback", "progress_line", "progress_text"]

ProgressCallback = Callable[[str, int, int | None], None]


@contextmanager
def progress_line(
    console: Console | None = None, *, is_wanted: bool = True
) -> Iterator[ProgressCallback]:
    """Show progress on stderr while the context lasts, if somebody can see it.

    Parameters
    ----------
    console : Console or None
        Where to show it; None is stderr.
    is_wanted : bool
        Whether it is to be shown at all.

    Yields
    ------
    callable
        Takes the stage, the parts done and their number or None.
    """
    target = Console(stderr=True) if console is None else console
    if not (is_wanted and target.is_terminal):
        yield lambda stage, done, total: None
        return
    with target.status("planning") as status:
        yield lambda stage, done, total: status.update(Text(progress_text(stage, done, total)))


def progress_text(stage: str, done: int, total: int | None) -> str:
    """Return one line about a stage."""
    return f"{stage} {done}" if total is None else f"{stage} {done}/{total}"
