"""Options of simulators: numbers, or as they are typed on a command line."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from radmpc.arguments import is_number, value_text
from radmpc.arrays import Vector, frozen
from radmpc.errors import ArgumentError, ArgumentTypeError

__all__ = ["number_within", "vector_within"]


def number_within(value: object, name: str, low: float, high: float, unit: str) -> float:
    """Return an option that is a number within a range.

    Parameters
    ----------
    value : object
        As given; a number, or one as text.
    name : str
        What it is called.
    low, high : float
        Least and largest allowed.
    unit : str
        For the message.

    Raises
    ------
    ArgumentTypeError
        If it is no number.
    ArgumentError
        If it is out of the range.
    """
    number = _number(value)
    if number is None:
        raise ArgumentTypeError(f"{name} must be a number, got {value_text(value)}")
    if not low <= number <= high:
        allowed = f"from {low:g} to {high:g} {unit}".rstrip()
        raise ArgumentError(f"{name} must be {allowed}, got {number:g}")
    return number


def vector_within(value: object, name: str, count: int, most: float, unit: str) -> Vector:
    """Return an option that is a vector up to some length.

    Parameters
    ----------
    value : object
        As given; a sequence of numbers, or text with commas between them.
    name : str
        What it is called.
    count : int
        How many numbers.
    most : float
        Largest length allowed.
    unit : str
        For the message.

    Returns
    -------
    (count,) array
        Read-only.

    Raises
    ------
    ArgumentTypeError
        If it is no sequence of so many numbers.
    ArgumentError
        If it is too long.
    """
    parts = value.split(",") if isinstance(value, str) else value
    numbers = [_number(part) for part in parts] if isinstance(parts, Sequence | np.ndarray) else []
    found = [number for number in numbers if number is not None]
    if len(found) != count or len(numbers) != count:
        raise ArgumentTypeError(f"{name} must be {count} numbers, got {value_text(value)}")
    vector = np.array(found)
    if not float(np.linalg.norm(vector)) <= most:
        raise ArgumentError(f"{name} must be at most {most:g} {unit}, got {found}")
    return frozen(vector)


def _number(value: object) -> float | None:
    """Return a number, also of text; None if it is none."""
    if isinstance(value, str):
        try:
            return float(value)
        except ValueError:
            return None
    return float(value) if is_number(value) else None
