"""The listener on the port: uvicorn, with limits, without its logs and its own way with signals."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

import uvicorn
from starlette.types import ASGIApp

from radmpc.serving.web.socket import MOST_BYTES

__all__ = ["Listener"]

_GRACE = 1
"""Seconds that pages get to say goodbye [s]."""

_MOST_CONNECTIONS = 200
"""Connections at once, pages' files included."""

_QUEUE = 64
"""Messages of a page that wait to be taken."""


class Listener(uvicorn.Server):
    """Speaks HTTP and WebSocket for an application.

    Parameters
    ----------
    app : ASGI application
        What answers.
    """

    def __init__(self, app: ASGIApp) -> None:
        super().__init__(
            uvicorn.Config(
                app,
                log_level="critical",
                access_log=False,  # the token stands in the socket's address
                server_header=False,
                date_header=False,
                proxy_headers=False,
                http="h11",
                ws="websockets-sansio",
                ws_max_size=MOST_BYTES,
                ws_max_queue=_QUEUE,
                h11_max_incomplete_event_size=16 * 1024,
                timeout_graceful_shutdown=_GRACE,
                limit_concurrency=_MOST_CONNECTIONS,
            )
        )

    def end(self) -> None:
        """End; asked a second time, without waiting for pages."""
        self.force_exit = self.should_exit
        self.should_exit = True

    @contextmanager
    def capture_signals(self) -> Iterator[None]:
        """Leave signals to the program: what uvicorn does with them ends in a traceback."""
        yield
