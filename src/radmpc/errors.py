"""Everything that can go wrong, by who has to act on it."""

from __future__ import annotations

__all__ = [
    "ArgumentError",
    "ArgumentTypeError",
    "FileFormatError",
    "NoPlanError",
    "RadmpcError",
    "RiskError",
    "ScenarioError",
    "SolverError",
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
    """

    def __init__(self, message: str, path: tuple[str | int, ...] = ()) -> None:
        super().__init__(message)
        self.message = message
        self.path = path

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
        return type(self)(self.message, (*prefix, *self.path))


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


def format_path(path: tuple[str | int, ...]) -> str:
    """Return ``vehicles[2].radius`` for ``("vehicles", 2, "radius")``."""
    text = ""
    for key in path:
        text += f"[{key}]" if isinstance(key, int) else f".{key}" if text else key
    return text
