"""Sets of vehicles planned on a Dask cluster."""

from __future__ import annotations

import importlib
import logging
import socket
from collections.abc import Callable, Iterator
from concurrent.futures import BrokenExecutor, CancelledError, Executor, Future
from contextlib import contextmanager
from typing import Any
from urllib.parse import urlsplit

from radmpc.errors import ScenarioError

__all__ = ["cluster"]

_SECONDS = 10
"""How long the scheduler may take to answer."""


@contextmanager
def cluster(address: str) -> Iterator[Executor]:
    """Provide an executor on a Dask cluster.

    Parameters
    ----------
    address : str
        Of the scheduler, as in ``tcp://127.0.0.1:8786``.

    Yields
    ------
    Executor
        Dask gives the tasks of a worker that dies to others; where none is left they break like
        those of any executor.

    Raises
    ------
    ScenarioError
        If Dask is not installed, or the scheduler does not answer.
    """
    try:
        distributed = importlib.import_module("distributed")
    except ImportError as error:
        raise ScenarioError(
            "--dask needs the package distributed: pip install 'radmpc[dask]'"
        ) from error
    _check_answers(address)
    # What goes wrong with a task comes with its result; of one that is given up while the client is
    # asking for it, Tornado would print how that was taken.
    # Dask gives some of these a level of their own as it loads.
    parts = "distributed", "distributed.client", "distributed.gc", "tornado", "tornado.application"
    for name in parts:
        logging.getLogger(name).setLevel(logging.CRITICAL)
    try:
        client = distributed.Client(address, timeout=_SECONDS, set_as_default=False)
    except (OSError, ValueError, TypeError) as error:
        raise ScenarioError(f"--dask: no scheduler answers at {address!r}") from error
    try:
        yield _Lossless(client.get_executor(pure=False))
    finally:
        client.close(timeout=_SECONDS)


def _check_answers(address: str) -> None:
    """Refuse an address where nothing listens; Dask itself would report it late and at length."""
    try:
        parts = urlsplit(address)
        host, port = parts.hostname, parts.port
    except ValueError:
        host, port = None, None
    if host is None or port is None:
        raise ScenarioError(f"--dask must be an address such as tcp://host:8786, got {address!r}")
    try:
        socket.create_connection((host, port), timeout=_SECONDS).close()
    except OSError as error:
        raise ScenarioError(f"--dask: no scheduler answers at {address!r}") from error


class _Lossless(Executor):
    """Dask's executor, with lost workers reported as by every other executor."""

    def __init__(self, inner: Any) -> None:
        self._inner = inner

    def submit(self, fn: Callable[..., Any], /, *args: object, **kwargs: object) -> Future[Any]:
        """Schedule a call."""
        outer: Future[Any] = Future()
        inner: Future[Any] = self._inner.submit(fn, *args, **kwargs)
        inner.add_done_callback(lambda done: _pass_on(done, outer))
        outer.add_done_callback(lambda given_up: given_up.cancelled() and inner.cancel())
        return outer

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """Leave the cluster as it is: it is not this program's."""
        del wait, cancel_futures


def _pass_on(done: Future[Any], outer: Future[Any]) -> None:
    """Hand a result on, a lost worker as a broken executor; nothing, if it was cancelled."""
    if not outer.set_running_or_notify_cancel():
        return
    try:
        outer.set_result(done.result())
    except CancelledError:
        outer.set_exception(BrokenExecutor("the cluster dropped a task"))
    except Exception as error:
        is_lost = type(error).__name__ in {"KilledWorker", "CommClosedError"}
        outer.set_exception(BrokenExecutor(str(error)) if is_lost else error)
