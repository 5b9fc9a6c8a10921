"""A server in a thread, on a port of its own, and pages that call it."""

from __future__ import annotations

import asyncio
import json
import socket
import threading
from contextlib import ExitStack
from http.client import HTTPConnection
from pathlib import Path

from websockets.sync.client import connect

from radmpc.serving.desk.desk import Desk
from radmpc.serving.folder import Folder
from radmpc.serving.protocol import SOCKET
from radmpc.serving.starting import listening
from radmpc.serving.web.app import application
from radmpc.serving.web.guard import Guard
from radmpc.serving.web.listener import Listener
from radmpc.serving.web.socket import Pages

PATIENCE = 60.0
"""Seconds after which a test that waits for the server has failed [s]."""

ENDING: list[tuple[threading.Thread, socket.socket]] = []
"""Servers that have been told to end, or will be."""


def wait_for_all() -> None:
    """Wait until all servers have ended."""
    for thread, port in ENDING:
        thread.join(PATIENCE)
        port.close()
        assert not thread.is_alive(), "a server does not end"
    ENDING.clear()


class CallFailedError(Exception):
    """A call that the server turned down."""

    def __init__(self, failure):
        super().__init__(failure["text"])
        self.kind, self.path = failure["kind"], failure["path"]


class Page:
    """A page that calls and collects events."""

    def __init__(self, socket):
        self.socket, self.events, self._last = socket, [], 0

    def receive(self):
        """Return the next message."""
        return json.loads(self.socket.recv(timeout=PATIENCE))

    def call(self, name, /, **args):
        """Return the result of a call."""
        self._last += 1
        self.socket.send(json.dumps({"id": self._last, "call": name, "args": args}))
        while True:
            message = self.receive()
            if "event" in message:
                self.events.append(message)
            elif message["id"] == self._last:
                if "failure" in message:
                    raise CallFailedError(message["failure"])
                return message["result"]

    def event(self, name, wanted=lambda message: True):
        """Return the next event of a kind that is wanted, told or yet to come."""
        while True:
            while self.events:
                message = self.events.pop(0)
                if message["event"] == name and wanted(message):
                    return message
            self.events.append(self.receive())


class Site:
    """An application on a folder, and its pages."""

    def __init__(self, folder: Path, bundle: Path | None = None):
        self.folder, self.pages = folder, Pages()
        self._bundle = folder / "no-bundle" if bundle is None else bundle
        self._stack = ExitStack()

    def __enter__(self):
        port = listening(0)
        self.guard = Guard(port.getsockname()[1])
        self.desk = Desk(Folder(self.folder), self.pages.tell)
        app = application(
            self.desk, self.pages, self.guard, started=lambda: None, bundle=self._bundle
        )
        listener = Listener(app)
        thread = threading.Thread(target=asyncio.run, args=(listener.serve(sockets=[port]),))
        thread.start()
        # It looks about ten times a second whether it is to end: nobody waits for that.
        ENDING.append((thread, port))
        self._stack.callback(listener.end)
        return self

    def __exit__(self, *error):
        self._stack.close()

    def connect(self, token=None, **options):
        """Return the context of a socket."""
        said = self.guard.token if token is None else token
        address = f"ws://127.0.0.1:{self.guard.port}{SOCKET}?token={said}"
        # What is not read yet must not keep the end from being read.
        return connect(address, max_size=None, max_queue=1 << 20, **options)

    def page(self) -> Page:
        """Return a page that is there until the site is closed."""
        return Page(self._stack.enter_context(self.connect()))

    def get(self, path, method="GET", **headers):
        """Return status, headers and text of a request."""
        line = HTTPConnection("127.0.0.1", self.guard.port, timeout=PATIENCE)
        try:
            line.putrequest(method, path, skip_host="Host" in headers)
            for key, value in headers.items():
                line.putheader(key.replace("_", "-"), value)
            line.endheaders()
            answer = line.getresponse()
            return answer.status, dict(answer.getheaders()), answer.read().decode()
        finally:
            line.close()
