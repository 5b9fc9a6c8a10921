"""Documents looked at before they are planned, once they rest."""

from __future__ import annotations

import asyncio
from collections.abc import Callable

from radmpc.serving.documents.document import Document
from radmpc.serving.failures import CallError
from radmpc.serving.processes.crew import Crew

__all__ = ["Lookout"]

_PAUSE = 0.15
"""Seconds without a change before a document is looked at [s]."""

_SECONDS = 60.0
"""Seconds that this may take [s]."""


class Lookout:
    """Looks at the newest revision of each document, at one of them at a time.

    Parameters
    ----------
    crew : Crew
        Who does it.
    seen : callable
        Called with a document once more is known of it.
    """

    def __init__(self, crew: Crew, seen: Callable[[Document], None]) -> None:
        self._crew, self._seen = crew, seen
        self._tasks: dict[str, asyncio.Task[None]] = {}
        self._wanted: set[str] = set()

    def look_at(self, document: Document) -> None:
        """Have a document looked at, once nobody looks at an earlier revision of it."""
        self._wanted.add(document.number)
        if document.number not in self._tasks:
            task = asyncio.get_running_loop().create_task(self._watch(document))
            self._tasks[document.number] = task
            task.add_done_callback(lambda _: self._tasks.pop(document.number, None))

    def end(self) -> None:
        """Look no more."""
        for task in self._tasks.values():
            task.cancel()

    async def _watch(self, document: Document) -> None:
        """Look at a document until it rests."""
        while document.number in self._wanted:
            self._wanted.discard(document.number)
            await asyncio.sleep(_PAUSE)
            if document.number in self._wanted or document.reading.scenario is None:
                continue
            revision, content = document.revision, document.content
            try:
                concerns = await self._crew.run("concerns", content, seconds=_SECONDS)
            except CallError:
                continue  # it is a help, and planning says the same later
            if document.revision == revision:
                document.concerns = tuple(concerns)
                self._seen(document)
