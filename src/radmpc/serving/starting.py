"""A server from its start to its end."""

from __future__ import annotations

import asyncio
import os
import signal
import socket
from collections.abc import Callable
from pathlib import Path

from radmpc.errors import RadmpcError
from radmpc.records import dataclass

__all__ = ["Serving", "ServingError", "check_extra", "listening", "serve"]

_NEEDED = ("starlette", "uvicorn", "websockets")


class ServingError(RadmpcError):
    """A server that cannot start."""


@dataclass(frozen=True, slots=True)
class Serving:
    """What is served.

    Attributes
    ----------
    folder : Path
        Where files are read and written.
    file : str or None
        What is opened first, relative to it.
    """

    folder: Path
    file: str | None = None


def check_extra() -> None:
    """Refuse to start without the packages of the extra.

    Raises
    ------
    ServingError
        With what installs them.
    """
    from importlib.util import find_spec  # noqa: PLC0415 - asked once

    missing = [name for name in _NEEDED if find_spec(name) is None]
    if missing:
        raise ServingError(f"radmpc serve needs {', '.join(missing)}: pip install 'radmpc[serve]'")


def listening(port: int) -> socket.socket:
    """Return a socket that listens on this machine alone.

    Parameters
    ----------
    port : int
        0 is any that is free.

    Raises
    ------
    ServingError
        If the port is taken, or not allowed.
    """
    try:
        return socket.create_server(("127.0.0.1", port))
    except OSError as error:
        # Python adds to the system's words what it was doing.
        reason = os.strerror(error.errno) if error.errno else str(error)
        raise ServingError(f"port {port}: {reason}") from error


def serve(serving: Serving, port: socket.socket, said: Callable[[str], None]) -> None:
    """Serve until Ctrl-C.

    Parameters
    ----------
    serving : Serving
        What.
    port : socket
        That listens.
    said : callable
        Called with the address once pages are served.
    """
    asyncio.run(_served(serving, port, said))


async def _served(serving: Serving, port: socket.socket, said: Callable[[str], None]) -> None:
    """Serve until a signal."""
    from radmpc.serving.desk.desk import Desk  # noqa: PLC0415 - slow to load; the port is taken first
    from radmpc.serving.desk.start import open_first  # noqa: PLC0415 - slow to load; the port is taken first
    from radmpc.serving.folder import Folder  # noqa: PLC0415 - slow to load; the port is taken first
    from radmpc.serving.web.app import application  # noqa: PLC0415 - its packages are an extra
    from radmpc.serving.web.guard import Guard  # noqa: PLC0415 - its packages are an extra
    from radmpc.serving.web.listener import Listener  # noqa: PLC0415 - its packages are an extra
    from radmpc.serving.web.socket import Pages  # noqa: PLC0415 - its packages are an extra

    guard, pages = Guard(port.getsockname()[1]), Pages()
    desk = Desk(Folder(serving.folder), pages.tell)

    def started() -> None:
        said(f"http://127.0.0.1:{guard.port}/#token={guard.token}")

    server = Listener(application(desk, pages, guard, started=started))
    loop = asyncio.get_running_loop()
    for number in (signal.SIGINT, signal.SIGTERM):
        loop.add_signal_handler(number, server.end)
    if serving.file is not None:
        # After the first answer: a large file takes seconds.
        desk.opening = loop.create_task(open_first(desk, serving.file))
        desk.opening.add_done_callback(lambda task: server.end() if _failure(task) else None)
    try:
        await server.serve(sockets=[port])
    finally:
        desk.end()
    failure = _failure(desk.opening)
    if failure is not None:
        raise failure


def _failure(opening: asyncio.Task[None] | None) -> BaseException | None:
    """Return why the file that the command names could not be opened."""
    if opening is None or not opening.done() or opening.cancelled():
        return None
    return opening.exception()
