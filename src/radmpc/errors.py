"""Everything that can go wrong, by who has to act on it."""

from __future__ import annotations

from collections.abc import Callable, Iterable

__all__ = [
    "ArgumentError",
    "ArgumentTypeError",
    "FileFormatError",
    "NoPlanError",
    "RadmpcError",
    "RiskError",
    "ScenarioError",
    "SolverError",
    "all_checked",
    "raise_together",
]


class RadmpcError(Exception):
    """Root of all errors raised on purpose by this package."""


class ScenarioError(RadmpcError, ValueError):
    """A scenario that cannot be meant: a wrong value, shape or combination.

    Attributes
    ----------
    message : str
        What is wrong, the value and what is allowed.
    path : tuple of str or int
        Where in the scenario, as keys and indices: ``("vehicles", 2, "radius")``.
    more : tuple of ScenarioError
        What else is wrong, found in one go; none of them has more.
    """

    def __init__(
        self,
        message: str,
        path: tuple[str | int, ...] = (),
        more: tuple[ScenarioError, ...] = (),
    ) -> None:
        super().__init__(message)
        self.message = message
        self.path = path
        self.more = more

    def __str__(self) -> str:
        """Return the place and the message in one line."""
        place = format_path(self.path)
        return f"{place}: {self.message}" if place else self.message

    def under(self, *prefix: str | int) -> ScenarioError:
        """Return the same error seen from a larger value that holds this one.

        Parameters
        ----------
        *prefix : str or int
            Where this value stands in the larger one, from the outside in.

        Returns
        -------
        ScenarioError
            With the longer path.
        """
        more = tuple(error.under(*prefix) for error in self.more)
        return type(self)(self.message, (*prefix, *self.path), more)


class ArgumentError(RadmpcError, ValueError):
    """An argument of a function that it cannot be called with: a value out of range."""


class ArgumentTypeError(ArgumentError, TypeError):
    """An argument of another kind than the function takes."""


class RiskError(RadmpcError, ValueError):
    """A risk outside the range in which its formula holds."""


class FileFormatError(RadmpcError, ValueError):
    """A file that is not what its format says it should be."""


class SolverError(RadmpcError):
    """An optimizer failed for a reason that is not the program's."""


class NoPlanError(RadmpcError):
    """A plan was required but planning ended without one."""


def raise_together(errors: Iterable[ScenarioError]) -> None:
    """Raise the first of some errors, the others with it; nothing where there is none.

    Of several at one place the first is told: what is wrong with all vehicles' defaults shows with
    each of them.

    Raises
    ------
    ScenarioError
        With ``more``.
    """
    found: dict[tuple[str | int, ...], ScenarioError] = {}
    for error in errors:
        for one in (ScenarioError(error.message, error.path), *error.more):
            found.setdefault(one.path, one)
    if found:
        first, *rest = found.values()
        raise ScenarioError(first.message, first.path, tuple(rest))


def all_checked(*checks: Callable[[], object]) -> None:
    """Run checks, all of them whatever the first ones find.

    Raises
    ------
    ScenarioError
        What they raised, together.
    """
    found = []
    for check in checks:
        try:
            check()
        except ScenarioError as error:
            found.append(error)
    raise_together(found)


def format_path(path: tuple[str | int, ...]) -> str:
    """Return ``vehicles[2].radius`` for ``("vehicles", 2, "radius")``."""
    text = ""
    for key in path:
        text += f"[{key}]" if isinstance(key, int) else f".{key}" if text else key
    return text
