"""What counts as near a path."""

from __future__ import annotations

from radmpc.records import dataclass

__all__ = ["Near"]


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
