"""A progress line: drawn on a terminal, now and then a line elsewhere if that is asked for."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from rich.console import Console
from rich.text import Text

from radmpc.wording import percent, short_cost

__all__ = ["ProgressCallback", "ProgressLine", "progress_line", "progress_text"]

_EVERY = 10.0
"""How often progress is told where there is no terminal, at most [s]."""

ProgressCallback = Callable[[str, int, int | None], None]


class ProgressLine:
    """What is being done, the best plan so far, and the time; drawn anew while it is shown.

    Parameters
    ----------
    is_planning : bool
        Whether there is a best plan to tell of, which Ctrl-C keeps.
    seconds : float or None
        The time limit; None where there is none.
    keeps : str
        What else Ctrl-C keeps; empty is nothing.
    tell : callable or None
        Takes the line every `every` seconds at most, as it is called; or None.
    every : float
        How often [s].
    write : callable or None
        Writes what stays above the line; None writes nothing.
    """

    def __init__(
        self,
        *,
        is_planning: bool = False,
        seconds: float | None = None,
        keeps: str = "",
        tell: Callable[[str], None] | None = None,
        every: float = _EVERY,
        write: Callable[[Text], None] | None = None,
    ) -> None:
        self._is_planning, self._keeps = is_planning, keeps
        self._tell, self._every, self._told = tell, every, time.monotonic()
        self._seconds, self._write = seconds, write
        self._stage = "planning" if is_planning else "working"
        self._best = ""
        self._begun = time.monotonic()

    def __call__(self, stage: str, done: int, total: int | None) -> None:
        """Take the stage, the parts done and their number or None."""
        self._stage = progress_text(stage, done, total)
        now = time.monotonic()
        if self._tell is not None and now - self._told >= self._every:
            self._told = now
            self._tell(self.text())

    def found(self, cost: float, bound: float | None) -> None:
        """Take the cost of the best plan so far, and its lower bound or None.

        Parameters
        ----------
        cost : float
            Of the incumbent.
        bound : float or None
            Lower bound on the cost of plans by faces; None where there is none yet, or above it.
        """
        from radmpc.solvers.solution import relative_gap  # noqa: PLC0415 - verifying needs none

        gap = "" if bound is None else f", gap {percent(relative_gap(cost, bound))}"
        self._best = f"best cost {short_cost(cost)}{gap}"

    def keep(self, text: Text) -> None:
        """Write what is done above the line, to stay; nothing where no line is drawn.

        Parameters
        ----------
        text : Text
            One line.
        """
        if self._write is not None:
            self._write(text)

    def text(self) -> str:
        """Return the line as of now."""
        passed = f"{time.monotonic() - self._begun:.0f}"
        parts = [self._stage]
        if self._best:
            parts.append(self._best)
        parts.append(f"{passed} s" if self._seconds is None else f"{passed} of {self._seconds:g} s")
        kept = "this plan" if self._best else "the best plan so far"
        if self._is_planning or self._keeps:
            parts.append(f"Ctrl-C keeps {self._keeps or kept}")
        return "; ".join(parts)

    def __rich__(self) -> Text:
        """Return the line for a terminal, which asks for it several times a second."""
        return Text(self.text())


@contextmanager
def progress_line(
    console: Console | None = None,
    *,
    is_shown: bool = True,
    is_planning: bool = False,
    seconds: float | None = None,
    keeps: str = "",
    tell: Callable[[str], None] | None = None,
) -> Iterator[ProgressLine]:
    """Show progress on stderr while the context lasts, if somebody can see it.

    Parameters
    ----------
    console : Console or None
        Where to show it; None is stderr.
    is_shown : bool
        Whether it is to be shown at all.
    is_planning, seconds, keeps : bool, float or None, and str
        As in `ProgressLine`.
    tell : callable or None
        Takes a line now and then where there is no terminal; None is silent there.

    Yields
    ------
    ProgressLine
        Call it with the stage, the parts done and their number or None.
    """
    target = Console(stderr=True) if console is None else console
    if not (is_shown and target.is_terminal):
        # Nobody presses keys in a pipe.
        yield ProgressLine(is_planning=is_planning, seconds=seconds, tell=tell)
        return
    line = ProgressLine(is_planning=is_planning, seconds=seconds, keeps=keeps, write=target.print)
    with target.status(line):
        yield line


def progress_text(stage: str, done: int, total: int | None) -> str:
    """Return one line about a stage.

    Parameters
    ----------
    stage : str
        What is being done.
    done : int
        How much of it.
    total : int or None
        Of how much; None is unknown.
    """
    return f"{stage} {done}" if total is None else f"{stage} {done}/{total}"
