"""How large the numbers of scenarios may be, so that arithmetic on them stays finite and ends."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from radmpc.arguments import check_integer, field_integer, field_number, value_text
from radmpc.errors import ScenarioError

__all__ = [
    "FILE_STEPS",
    "LARGEST",
    "LEAST",
    "check_range",
    "check_size",
    "check_steps",
    "sized",
    "steps_ahead",
]

LARGEST = 1e9
"""Largest magnitude of a number of a scenario: beyond, squares and solvers lose all digits."""

LEAST = 1e-100
"""Smallest of those that must be above zero: of much smaller ones the square is 0."""

FILE_STEPS = 1000
"""Steps of a scenario in a file [-], and the longest horizon that is tried as a cure."""

_MOST_STEPS = 1_000_000
"""Steps of a horizon beyond which not even its scenario is made [-]."""

_LEAST_SIZE, _MOST_SIZE = 1e-6, 1e6


def check_range(value: float, unit: str, path: tuple[str | int, ...]) -> float:
    """Return a number; refuse sizes, speeds and times that no vehicle has: below 1e-6, above 1e6.

    Parameters
    ----------
    value : float
        What was given.
    unit : str
        Its unit, for the message.
    path : tuple of str or int
        Where it stands.

    Returns
    -------
    float
        Python's.

    Raises
    ------
    ScenarioError
        With the unit and what is allowed.
    """
    value = field_number(value, path)
    if not value > 0.0:
        raise ScenarioError(f"must be > 0 {unit}, got {value}", path)
    if not _LEAST_SIZE <= value <= _MOST_SIZE:
        allowed = f"must lie between {_LEAST_SIZE:g} and {_MOST_SIZE:g}"
        raise ScenarioError(f"{allowed} {unit}, got {value}", path)
    return value


def check_steps(horizon: int) -> int:
    """Return a horizon; refuse one without steps, or with more than memory holds.

    Parameters
    ----------
    horizon : int
        What was given.

    Returns
    -------
    int
        Python's.

    Raises
    ------
    ScenarioError
        With what is allowed.
    """
    path = ("horizon",)
    horizon = field_integer(horizon, path)
    if horizon < 1:
        raise ScenarioError(f"must be at least 1 step, got {horizon}", path)
    if horizon > _MOST_STEPS:
        text = f"must be at most {_MOST_STEPS} steps, got {value_text(horizon)}"
        raise ScenarioError(text, path)
    return horizon


def steps_ahead(horizon: int) -> int:
    """Return how many steps to look ahead: none, or as many as a scenario may have.

    Parameters
    ----------
    horizon : int
        What was given.

    Returns
    -------
    int
        Python's.

    Raises
    ------
    ArgumentError, ScenarioError
        With what is allowed.
    """
    horizon = check_integer(horizon, "horizon", 0)
    return check_steps(horizon) if horizon else 0


def check_size(value: float, path: tuple[str | int, ...], most: float = LARGEST) -> None:
    """Refuse a number of a larger magnitude than allowed.

    Parameters
    ----------
    value : float
        What was given; nan passes.
    path : tuple of str or int
        Where it stands.
    most : float
        Largest magnitude allowed.

    Raises
    ------
    ScenarioError
        With what is allowed.
    """
    if value > most:
        raise ScenarioError(f"must be at most {most:.10g}, got {value_text(float(value))}", path)
    if value < -most:
        raise ScenarioError(f"must be at least {-most:.10g}, got {value_text(float(value))}", path)


def sized(
    values: npt.NDArray[np.float64], path: tuple[str | int, ...], most: float = LARGEST
) -> npt.NDArray[np.float64]:
    """Return an array as it is; refuse entries of a larger magnitude than allowed.

    Parameters
    ----------
    values : array
        Finite numbers.
    path : tuple of str or int
        Where they stand.
    most : float
        Largest magnitude allowed.

    Raises
    ------
    ScenarioError
        With the first of them, and what is allowed.
    """
    is_over = np.abs(values) > most
    if is_over.any():
        at = tuple(int(i) for i in np.argwhere(is_over)[0])
        check_size(values[at], (*path, *at), most)
    return values
