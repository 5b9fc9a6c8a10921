"""Calls that are turned down, in words for the page."""

from __future__ import annotations

from radmpc.errors import RadmpcError
from radmpc.serving.protocol import Failure, FailureKind, Path

__all__ = ["CallError", "exists", "refused", "stale"]


class CallError(RadmpcError):
    """A call that the server does not carry out.

    Attributes
    ----------
    kind : str
        `stale`, `refused`, `exists`, `limit`, `gone` or `internal`.
    path : sequence of str or int, or None
        The place in the document that it is about.
    """

    def __init__(self, kind: FailureKind, text: str, path: Path | None = None) -> None:
        super().__init__(text)
        self.kind, self.path = kind, path

    @property
    def failure(self) -> Failure:
        """What the page is told."""
        return {"kind": self.kind, "text": str(self), "path": self.path}


def refused(text: str, path: Path | None = None) -> CallError:
    """Return the error of bad input.

    Parameters
    ----------
    text : str
        What is wrong, in one line.
    path : path or None
        Where in the document.
    """
    return CallError("refused", text, path)


def exists(path: str, also: str = "") -> CallError:
    """Return the error of writing over a file that nobody asked to replace.

    Parameters
    ----------
    path : str
        As the page names it.
    also : str
        What else is known of it.
    """
    return CallError("exists", f"{path}: it is there already{also}")


def stale(revision: int) -> CallError:
    """Return the error of a change to what has changed since."""
    return CallError("stale", f"changed elsewhere: it is at revision {revision} now")
