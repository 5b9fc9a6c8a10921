"""How much room letters take."""

from __future__ import annotations

import warnings

import numpy as np
from matplotlib.font_manager import FontProperties
from matplotlib.textpath import text_to_path

from radmpc.arrays import Vector

__all__ = ["LETTER", "shortened", "text_size"]

LETTER = (0.62, 1.25)
"""Width and height of a usual letter in units of the font size: most are a little narrower [-]."""

_GAP = 0.15
"""What is left free at both ends of a text together, in units of the font size [-]."""


def shortened(text: str, letters: int) -> str:
    """Return a text without its middle where it has more letters: both ends tell it from others.

    Parameters
    ----------
    text : str
        One line.
    letters : int
        How many there may be.
    """
    if len(text) <= letters:
        return text
    end = letters // 2
    return f"{text[: letters - end - 1]}…{text[-end:]}"


def text_size(text: str, size: float) -> Vector:
    """Return what a text takes at most, width and height, (2,) [pt].

    Parameters
    ----------
    text : str
        One line.
    size : float
        Of the font [pt].
    """
    width = max(LETTER[0] * len(text), _measured(text) + _GAP)
    return size * np.array([width, LETTER[1]])


def _measured(text: str) -> float:
    """Return the width of a text in the usual font, in units of the font's size [-].

    Capitals and letters that the font lacks are wider than `LETTER`.
    """
    usual = FontProperties(size=1.0)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of signs that the font lacks drawing tells, once
        width, _, _ = text_to_path.get_text_width_height_descent(text, usual, False)
    return float(width)
