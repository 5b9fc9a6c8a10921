"""Numbers that an importer computes, without the last bits of its arithmetic."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

__all__ = ["rounded"]

_DIGITS = 12
"""Decimals: a kilometer to the nanometer, and sums and products of short numbers stay short."""


def rounded(values: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    """Return numbers to twelve significant digits; not for those that a file states itself."""
    short = [float(f"{value:.{_DIGITS}g}") for value in values.ravel()]
    return np.array(short).reshape(values.shape)
