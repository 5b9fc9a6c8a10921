"""Short numbers that are surely no smaller, or no larger, than what they stand for."""

from __future__ import annotations

from decimal import ROUND_CEILING, ROUND_FLOOR, Context

__all__ = ["rounded_down", "rounded_up"]


def rounded_up(value: float, num_digits: int = 2) -> float:
    """Return the next larger number of so many digits; what has no more digits stays itself.

    Parameters
    ----------
    value : float
        What is rounded, >= 0.
    num_digits : int
        Significant digits that are kept.

    Returns
    -------
    float
        At least the value, without exception: of rounding errors in it nothing is known.
    """
    return _rounded(value, num_digits, ROUND_CEILING)


def rounded_down(value: float, num_digits: int = 2) -> float:
    """Return the next smaller number of so many digits; what has no more digits stays itself.

    Parameters
    ----------
    value : float
        What is rounded, >= 0.
    num_digits : int
        Significant digits that are kept.

    Returns
    -------
    float
        At most the value, without exception.
    """
    return _rounded(value, num_digits, ROUND_FLOOR)


def _rounded(value: float, num_digits: int, direction: str) -> float:
    """Return a value rounded as it is written: by the shortest decimals that mean this float.

    A number of so many digits is then itself, and any other float lies strictly between two of
    them, whose floats are no further away than it.
    """
    return float(Context(prec=num_digits, rounding=direction).create_decimal(repr(float(value))))
