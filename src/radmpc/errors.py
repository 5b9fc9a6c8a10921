"""The package's exceptions, by the party that has to act on them."""

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


_LONGEST_KEY = 100
"""Letters of a key that a message shows."""


class RadmpcError(Exception):
    """Base class of all exceptions that this package raises itself."""


class ScenarioError(RadmpcError, ValueError):
    """An invalid scenario: a value, a shape or a combination that is not allowed.

    Attributes
    ----------
    message : str
        What is wrong, the value and what is allowed.
    path : tuple of str or int
        Where in the scenario, as keys and indices: ``("vehicles", 2, "radius")``.
    more : tuple of ScenarioError
        Further errors in the same scenario; none of them has more.

    Examples
    --------
    >>> import radmpc
    >>> try:
    ...     radmpc.Obstacle.box("rock", [4.0, 3.0], [3.0, 7.0])
    ... except radmpc.ScenarioError as error:
    ...     print(error)
    min must not be above max on any axis, got [4.0, 3.0] and [3.0, 7.0]
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
        """Return the same error with its path seen from an enclosing value.

        Parameters
        ----------
        *prefix : str or int
            Keys and indices of this value in the enclosing one, outermost first.

        Returns
        -------
        ScenarioError
            With the longer path.
        """
        more = tuple(error.under(*prefix) for error in self.more)
        return type(self)(self.message, (*prefix, *self.path), more)


class ArgumentError(RadmpcError, ValueError):
    """An argument whose value is not allowed."""


class ArgumentTypeError(ArgumentError, TypeError):
    """An argument whose type is not allowed."""


class RiskError(RadmpcError, ValueError):
    """A risk outside the range for which its formula is valid."""


class FileFormatError(RadmpcError, ValueError):
    """A file that does not conform to its format."""


class SolverError(RadmpcError):
    """An optimizer that is missing, refuses the program or fails."""


class NoPlanError(RadmpcError):
    """Planning ended without the plan that was required.

    Examples
    --------
    >>> import radmpc
    >>> from dataclasses import replace
    >>> from radmpc.experiments.families import paper
    >>> try:
    ...     radmpc.plan(replace(paper(2, seed=1), horizon=2), rng=0).require()
    ... except radmpc.NoPlanError as error:
    ...     print(str(error).partition(",")[0])
    Vehicle 'v1' cannot reach its goal within 2 steps (2 s) under its control and speed limits
    """


def raise_together(errors: Iterable[ScenarioError]) -> None:
    """Raise the first of some errors with the others attached; do nothing if there is none.

    Of several errors at one path only the first is kept: a wrong default would show once per
    vehicle.

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
    """Run all checks, even if early ones fail.

    Raises
    ------
    ScenarioError
        With all errors raised, the first of them in front.
    """
    found = []
    for check in checks:
        try:
            check()
        except ScenarioError as error:
            found.append(error)
    raise_together(found)


def format_path(path: tuple[str | int, ...]) -> str:
    """Return ``vehicles[2].radius`` for ``("vehicles", 2, "radius")``; long keys are shortened."""
    text = ""
    for key in path:
        told = key_text(str(key))
        text += f"[{told}]" if isinstance(key, int) else f".{told}" if text else told
    return text


def key_text(key: str) -> str:
    """Return a key for a message: one that is too long to read with its middle left out."""
    if len(key) <= _LONGEST_KEY:
        return key
    kept = (_LONGEST_KEY - 3) // 2
    return f"{key[:kept]}...{key[-kept:]}"
