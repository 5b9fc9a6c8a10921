"""Short numbers that are surely no smaller, or no larger, than what they stand for."""

from __future__ import annotations

from math import ceil, floor, log10

__all__ = ["rounded_down", "rounded_up"]

_LEAST = 1e-300
"""Value below which all count as that [-]: smaller ones have no power of ten to be scaled by."""

_NOISE = 1e-9
"""What a scaled value may miss a whole number by and still count as it [-]: rounding errors."""


def rounded_up(value: float, num_digits: int = 2) -> float:
    """Return the next larger number of so many digits.

    Parameters
    ----------
    value : float
        What is rounded, >= 0.
    num_digits : int
        Significant digits that are kept.
    """
    digits = _decimals(value, num_digits)
    return round(ceil(value * 10.0**digits - _NOISE) / 10.0**digits, digits)


def rounded_down(value: float, num_digits: int = 2) -> float:
    """Return the next smaller number of so many digits.

    Parameters
    ----------
    value : float
        What is rounded, >= 0.
    num_digits : int
        Significant digits that are kept.
    """
    digits = _decimals(value, num_digits)
    return round(floor(value * 10.0**digits + _NOISE) / 10.0**digits, digits)


def _decimals(value: float, num_digits: int) -> int:
    """Return how many decimals a value has with so many digits; negative from tens on."""
    return num_digits - 1 - floor(log10(max(value, _LEAST)))
