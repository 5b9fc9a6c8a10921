"""A document that is open: its content, what was before, and what is known of it."""

from __future__ import annotations

import asyncio
from collections.abc import Sequence
from pathlib import PurePosixPath

from radmpc.serving.documents.content import changed, check_size
from radmpc.serving.documents.reading import Reading, read_content
from radmpc.serving.documents.text import Original
from radmpc.serving.failures import refused, stale
from radmpc.serving.protocol import Change, Content, Remark, ScenarioView

__all__ = ["Document"]

_MOST_UNDONE = 300
"""Changes that can be undone [-]."""


class Document:
    """A scenario as its file has it, with its history; changes require its lock.

    Parameters
    ----------
    number : str
        By which pages name it.
    content : mapping
        As its file has it.
    file : str or None
        Path in the folder; None was never saved.
    origin : Original or None
        The text that it was read from.
    """

    def __init__(
        self, number: str, content: Content, file: str | None = None, origin: Original | None = None
    ) -> None:
        self.number, self.content, self.file, self.origin = number, content, file, origin
        self.lock = asyncio.Lock()
        self.digest: str | None = None  # of its file, as it was read or written last
        self.revision = 0
        self.reading = Reading(None, None)
        self.view: ScenarioView | None = None
        self._viewed: tuple[int, ...] = ()
        self.concerns: tuple[Remark, ...] = ()
        self._done: list[Content] = []
        self._undone: list[Content] = []
        self._saved = content if file is not None else None

    @property
    def name(self) -> str:
        """What it is called: the scenario's name, or the file's."""
        said = self.content.get("name")
        return said if isinstance(said, str) and said else PurePosixPath(self.file or "new").name

    @property
    def can_undo(self) -> bool:
        """Whether there is a change to be undone."""
        return bool(self._done)

    @property
    def can_redo(self) -> bool:
        """Whether there is an undone change."""
        return bool(self._undone)

    @property
    def is_saved(self) -> bool:
        """Whether its file holds what it says."""
        return self._saved is not None and self._saved == self.content

    @property
    def remarks(self) -> list[Remark]:
        """What is wrong, or worth knowing."""
        return [*self.reading.remarks, *self.concerns]

    async def read(self) -> None:
        """Understand the content, once."""
        self._take(await asyncio.to_thread(read_content, self.content))

    async def change(self, revision: int, changes: Sequence[Change]) -> None:
        """Change some values.

        Parameters
        ----------
        revision : int
            That the changes are of.
        changes : sequence of Change
            Checked.

        Raises
        ------
        CallError
            If the document has changed since, or a path leads nowhere.
        """
        async with self.lock:
            self._check(revision)
            content = changed(self.content, changes)
            check_size(content)
            await self._become(content, [*self._done, self.content][-_MOST_UNDONE:], [])

    async def undo(self, revision: int) -> None:
        """Undo the last change; see `change`."""
        async with self.lock:
            self._check(revision)
            if not self._done:
                raise refused("there is nothing to undo")
            await self._become(self._done[-1], self._done[:-1], [*self._undone, self.content])

    async def redo(self, revision: int) -> None:
        """Do again what was undone last; see `change`."""
        async with self.lock:
            self._check(revision)
            if not self._undone:
                raise refused("there is nothing to redo")
            await self._become(self._undone[-1], [*self._done, self.content], self._undone[:-1])

    def saved_as(self, file: str, content: Content) -> None:
        """Note that a file holds what the document said.

        Parameters
        ----------
        file : str
            Its path in the folder.
        content : mapping
            What was written.
        """
        self.file, self._saved = file, content

    def _check(self, revision: int) -> None:
        """Refuse a change of what is no longer so."""
        if revision != self.revision:
            raise stale(self.revision)

    async def _become(self, content: Content, done: list[Content], undone: list[Content]) -> None:
        """Take another content, with another history."""
        reading = await asyncio.to_thread(read_content, content)
        self.content, self._done, self._undone = content, done, undone
        self.revision += 1
        self._take(reading)

    def _take(self, reading: Reading) -> None:
        """Take what was understood; while something is wrong, the last view stays."""
        self.reading = reading
        # Without vehicles nothing is wrong yet with what is drawn; where entries have come or gone,
        # paths of the last view would lead to others.
        lists = (self.content.get(key) for key in ("vehicles", "obstacles"))
        counts = tuple(len(part) if isinstance(part, list) else 0 for part in lists)
        is_begun = self.view is None or not counts[0] or counts != self._viewed
        view = reading.view or (reading.partial if is_begun else None)
        if view is not None:
            self.view, self._viewed = view, counts
        self.concerns = ()
