"""The socket of one page: calls in, answers and events out."""

from __future__ import annotations

import asyncio
import json
from collections.abc import Mapping
from typing import Any

from starlette.websockets import WebSocket, WebSocketDisconnect

from radmpc.serving.desk.calls import answer
from radmpc.serving.desk.desk import Desk
from radmpc.serving.desk.things import Changed
from radmpc.serving.failures import CallError
from radmpc.serving.web.guard import Rate

__all__ = ["MOST_BYTES", "Page", "Pages"]

MOST_BYTES = 24 * 2**20
"""Size of a message from a page: four million letters, each spelled out in six [bytes]."""

_MOST_PAGES = 16
"""Pages at once."""

_PER_SECOND, _AT_ONCE = 60.0, 240.0
"""Calls of one page: more than a hand that drags makes."""

_MOST_OPEN = 32
"""Calls of one page that wait for their answers."""

_MOST_QUEUED = 512
"""Messages that wait for a page to read them; a page that reads no more is let go."""

_TOO_SLOW, _TOO_MANY, _NO_CALL = 1013, 1013, 1003


def _dumped(message: object) -> str:
    """Return a message as text, "?" for what UTF-8 cannot encode, such as some names of folders.

    A message that cannot be sent would end the connection, and every one that tells of the same.
    """
    text = json.dumps(message, allow_nan=False, ensure_ascii=False, separators=(",", ":"))
    return text if text.isascii() else text.encode("utf-8", "replace").decode("utf-8")


class Page:
    """A page that looks.

    Parameters
    ----------
    socket : WebSocket
        Accepted.
    """

    def __init__(self, socket: WebSocket) -> None:
        self.socket = socket
        self.queue: asyncio.Queue[str] = asyncio.Queue(_MOST_QUEUED)
        self.rate = Rate(_PER_SECOND, _AT_ONCE)
        self.calls: set[asyncio.Task[None]] = set()
        self.is_slow = asyncio.Event()
        self.is_wrong = False

    def put(self, text: str) -> None:
        """Have a message sent, unless the page does not read."""
        try:
            self.queue.put_nowait(text)
        except asyncio.QueueFull:
            self.is_slow.set()


class Pages:
    """All pages of a server."""

    def __init__(self) -> None:
        self._pages: set[Page] = set()

    def tell(self, event: Mapping[str, Any]) -> None:
        """Tell every page of an event."""
        if self._pages:
            self.put(_dumped(event))

    def put(self, text: str, but: Page | None = None) -> None:
        """Have a message sent to every page.

        Parameters
        ----------
        text : str
            The message.
        but : Page or None
            Who knows it already.
        """
        for page in self._pages:
            if page is not but:
                page.put(text)

    async def serve(self, socket: WebSocket, desk: Desk) -> None:
        """Answer a page until it leaves.

        Parameters
        ----------
        socket : WebSocket
            Accepted.
        desk : Desk
            What it works on.
        """
        if len(self._pages) >= _MOST_PAGES:
            await socket.close(_TOO_MANY, "too many pages")
            return
        page = Page(socket)
        self._pages.add(page)
        tasks = [
            asyncio.create_task(self._receive(page, desk)),
            asyncio.create_task(_send(page)),
            asyncio.create_task(page.is_slow.wait()),
        ]
        try:
            await asyncio.wait(tasks, return_when=asyncio.FIRST_COMPLETED)
        finally:
            self._pages.discard(page)
            # What was asked for is done all the same: a change may be half made.
            for task in tasks:
                task.cancel()
            await asyncio.gather(*tasks, return_exceptions=True)
        if page.is_slow.is_set():
            await socket.close(_TOO_SLOW, "too slow")
        elif page.is_wrong:
            await socket.close(_NO_CALL, "not a call")

    async def _receive(self, page: Page, desk: Desk) -> None:
        """Take calls, each answered in its own time."""
        while True:
            try:
                text = await page.socket.receive_text()
            except WebSocketDisconnect:
                return
            except KeyError:  # bytes, which no page of ours sends
                page.is_wrong = True
                return
            number, name, args = _parsed(text)
            if number is None:
                page.is_wrong = True
                return
            if not page.rate.takes() or len(page.calls) >= _MOST_OPEN:
                failure = CallError("limit", "too many calls: wait a moment").failure
                page.put(_dumped({"id": number, "failure": failure}))
                continue
            task = asyncio.create_task(self._answered(page, desk, number, name, args))
            page.calls.add(task)
            task.add_done_callback(page.calls.discard)

    async def _answered(
        self, page: Page, desk: Desk, number: int, name: object, args: object
    ) -> None:
        """Answer one call; a change is news to the other pages."""
        try:
            result = await answer(desk, name, args)
            # Large, and the same in both messages.
            text = _dumped(result.state if isinstance(result, Changed) else result)
        except CallError as error:
            failure = error.failure
        except Exception as error:
            what = f"internal error: {type(error).__name__}"
            failure = CallError("internal", what).failure
        else:
            page.put(f'{{"id":{number},"result":{text}}}')
            if isinstance(result, Changed):
                self.put(f'{{"event":"document","state":{text}}}', but=page)
            return
        page.put(_dumped({"id": number, "failure": failure}))


async def _send(page: Page) -> None:
    """Send what is to be sent, in order."""
    while True:
        await page.socket.send_text(await page.queue.get())


def _parsed(text: str) -> tuple[int | None, object, object]:
    """Return a call's number, name and arguments; no number where it is none."""
    try:
        call = json.loads(text, parse_constant=_refuse)
    except (ValueError, RecursionError):
        return None, None, None
    if not isinstance(call, dict):
        return None, None, None
    number = call.get("id")
    if isinstance(number, bool) or not isinstance(number, int) or abs(number) > 2**53:
        return None, None, None
    return number, call.get("call"), call.get("args")


def _refuse(word: str) -> float:
    """Refuse what is no number in JSON."""
    raise ValueError(word)
