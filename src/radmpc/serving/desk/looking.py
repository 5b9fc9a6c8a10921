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
    """Looks at one revision of each document at a time, the newest.

    Parameters
    ----------
    crew : Crew
        Who does it.
    seen : callable
        Told of a document once more is known of it.
    """

    def __init__(self, crew: Crew, seen: Callable[[Document], None]) -> None:
        self._crew, self._seen = crew, seen
        self._tasks: dict[str, asyncio.Task[None]] = {}

    def look_at(self, document: Document) -> None:
        """Have a document looked at; what was being looked at of it is of no use any more."""
        before = self._tasks.pop(document.number, None)
        if before is not None:
            before.cancel()
        if document.reading.scenario is not None:
            task = asyncio.get_running_loop().create_task(self._look(document))
            self._tasks[document.number] = task

    def end(self) -> None:
        """Look no more."""
        for task in self._tasks.values():
            task.cancel()

    async def _look(self, document: Document) -> None:
        """Look at a document, and tell what was seen unless it has changed meanwhile."""
        await asyncio.sleep(_PAUSE)
        revision, content = document.revision, document.content
        try:
            concerns = await self._crew.run("concerns", content, seconds=_SECONDS)
        except CallError:
            return  # it is a help, and planning says the same later
        if document.revision == revision:
            document.concerns = tuple(concerns)
            self._seen(document)
