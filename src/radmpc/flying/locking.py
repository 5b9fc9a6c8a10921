"""One thread at a time: what changes a mission waits until another change of it is over."""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from threading import RLock
from typing import Concatenate, ParamSpec, Protocol, TypeVar

__all__ = ["Locked", "one_at_a_time"]

_Given = ParamSpec("_Given")
_Answer = TypeVar("_Answer")


class Locked(Protocol):
    """Has a lock that a thread may take several times."""

    _lock: RLock


_Owner = TypeVar("_Owner", bound=Locked)


def one_at_a_time(
    method: Callable[Concatenate[_Owner, _Given], _Answer],
) -> Callable[Concatenate[_Owner, _Given], _Answer]:
    """Return a method that only one thread runs at a time of all that are locked alike.

    Parameters
    ----------
    method : callable
        Of an object with a lock.
    """

    @wraps(method)
    def locked(self: _Owner, /, *args: _Given.args, **kwargs: _Given.kwargs) -> _Answer:
        with self._lock:
            return method(self, *args, **kwargs)

    return locked
