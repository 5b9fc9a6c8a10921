"""Packages that only some simulators need."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager, redirect_stdout
from importlib import import_module
from io import StringIO
from types import ModuleType

from radmpc.errors import ArgumentError

__all__ = ["loaded", "without"]


def loaded(module: str, extra: str) -> ModuleType:
    """Return a module of an optional package, imported in silence.

    Parameters
    ----------
    module : str
        Its full name.
    extra : str
        The extra of this package that brings it.

    Raises
    ------
    ArgumentError
        If it is not installed.
    """
    try:
        # What is printed on import would stand in the midst of a command's JSON.
        with redirect_stdout(StringIO()):
            return import_module(module)
    except ImportError as error:
        name = module.partition(".")[0]
        raise ArgumentError(f"{name} is not installed: pip install 'radmpc[{extra}]'") from error


@contextmanager
def without(module: str) -> Iterator[None]:
    """Make a module seem not to be installed.

    Parameters
    ----------
    module : str
        Its name; if it is loaded already, it stays.
    """
    if module in sys.modules:
        yield
        return
    # This is how imports are told to fail.
    sys.modules[module] = None  # type: ignore[assignment] # the stubs know of modules alone
    try:
        yield
    finally:
        del sys.modules[module]
