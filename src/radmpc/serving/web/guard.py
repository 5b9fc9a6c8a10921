"""Who may speak to the server, and how much; what else browsers are told to refuse."""

from __future__ import annotations

import secrets
import time
from collections.abc import Mapping

from starlette.datastructures import Headers

__all__ = ["HEADERS", "Guard", "Rate"]

HEADERS: Mapping[str, str] = {
    "Content-Security-Policy": (
        "default-src 'none'; script-src 'self'; style-src 'self' 'unsafe-inline'; "
        "img-src 'self' data: blob:; font-src 'self'; connect-src 'self'; worker-src 'self'; "
        "base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
    ),
    "X-Content-Type-Options": "nosniff",
    "X-Frame-Options": "DENY",
    "Referrer-Policy": "no-referrer",
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Permissions-Policy": "camera=(), microphone=(), geolocation=(), interest-cohort=()",
    "Cache-Control": "no-store",
}
"""With every answer. Styles within elements are how drawings are placed; scripts come from here."""

_NAMES = ("127.0.0.1", "localhost")
"""What this machine may be called: any other name that leads here is somebody's trick."""


class Guard:
    """Knows the server's token and its port.

    Parameters
    ----------
    port : int
        That it listens on.
    """

    def __init__(self, port: int) -> None:
        self.token, self.port = secrets.token_urlsafe(32), port

    def is_host(self, headers: Headers) -> bool:
        """Whether a request is for this machine, by the name that the browser used.

        A page elsewhere may have its name point here (DNS rebinding): its requests bear that name.
        """
        return headers.get("host", "") in self._hosts()

    def is_origin(self, headers: Headers) -> bool:
        """Whether a socket is opened by our own page, or by a program, which sends no origin."""
        origin = headers.get("origin")
        return origin is None or origin in {f"http://{host}" for host in self._hosts()}

    def is_token(self, token: str) -> bool:
        """Whether a token is this server's, in a time that tells nothing about it."""
        return secrets.compare_digest(token.encode("utf-8", "replace"), self.token.encode())

    def _hosts(self) -> set[str]:
        """Return what browsers may call this server."""
        return {f"{name}:{self.port}" for name in _NAMES}


class Rate:
    """A bucket that fills at a rate, of which every call takes one.

    Parameters
    ----------
    per_second : float
        Calls that may be made all the time.
    most : float
        Calls that may be made at once.
    """

    def __init__(self, per_second: float, most: float) -> None:
        self._per_second, self._most = per_second, most
        self._left, self._at = most, time.monotonic()

    def takes(self) -> bool:
        """Whether one more may be made now; it then counts."""
        now = time.monotonic()
        self._left = min(self._most, self._left + self._per_second * (now - self._at))
        self._at = now
        if self._left < 1.0:
            return False
        self._left -= 1.0
        return True
