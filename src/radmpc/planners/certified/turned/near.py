"""What counts as near a path."""

from __future__ import annotations

import math

from radmpc.records import dataclass

__all__ = ["Near", "may_have_left"]

_SURELY = 0.99
"""Share of a reach that paths may move by without another look [-]: rounding."""


@dataclass(frozen=True, slots=True)
class Near:
    """Which windows get a half-space, and how carefully it is turned.

    Attributes
    ----------
    clearance : float
        Standard deviations that are kept in any case [-].
    reach : float
        Room beyond them up to which something counts as near [m].
    is_refined : bool
        Whether directions are refined to the best by clearance, or the line of closest approach
        will do.
    is_start_given : bool
        Whether in the first window only those count between vehicles that keep the clearance where
        they start: nothing changes that end. The last window is turned to goals alike.
    """

    clearance: float
    reach: float
    is_refined: bool
    is_start_given: bool = False


def may_have_left(moved: float, dimension: int, reach: float) -> bool:
    """Tell whether paths may have come near what had no half-space, since it was beyond a reach.

    Parameters
    ----------
    moved : float
        How far any of them moved along an axis, at most [m].
    dimension : int
        Number of coordinates d.
    reach : float
        How far beyond what counts as near half-spaces were sought [m].
    """
    # Two that move come closer by as much as both do, whatever they are to each other.
    return 2.0 * math.sqrt(dimension) * moved >= _SURELY * reach
