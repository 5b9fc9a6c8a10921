"""Wrong arguments of the library, named as the command line spells them."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from radmpc.errors import ScenarioError, format_path

__all__ = ["is_option", "named_options"]


def is_option(error: ScenarioError, options: tuple[str, ...]) -> bool:
    """Whether an error is about one of some options, rather than about a part of a file.

    Parameters
    ----------
    error : ScenarioError
        Whose path begins with an option or a part of a file.
    options : tuple of str
        As the library calls them.
    """
    return bool(error.path) and error.path[0] in options


@contextmanager
def named_options(*options: str) -> Iterator[None]:
    """Spell options as they are typed in errors about them: ``--risk-bound must …``.

    Parameters
    ----------
    *options : str
        As the library calls them: ``risk_bound``.

    Raises
    ------
    ScenarioError
        The same one; others pass as they are.
    """
    try:
        yield
    except ScenarioError as error:
        if not is_option(error, options):
            raise
        name, *rest = error.path
        typed = f"--{str(name).replace('_', '-')}"
        part = format_path(tuple(rest))
        where = f"{typed}: {part}:" if part else typed
        raise ScenarioError(f"{where} {error.message}") from error
