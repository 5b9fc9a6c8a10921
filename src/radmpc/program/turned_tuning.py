"""The numbers that directions of half-spaces are sought with, in one record."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType

__all__ = ["TUNING", "Tuning"]


@dataclass(frozen=True, slots=True)
class Tuning:
    """How finely directions of half-spaces are tried.

    A value that was measured names the scenes; of the others no measurement is recorded.

    Attributes
    ----------
    coarse : mapping of int to int
        Number of directions tried first, by dimension [-]: 7.5 degrees apart in the plane, some 16
        in space. More find the better of two valleys more often and take time in proportion.
    spacing : mapping of int to float
        Angle between neighbors among them, by dimension [rad]: the refinement starts at half of it.
    levels : int
        Refinements around the best direction [-], each at a third of the angle: the last is at an
        eightieth of the first.
    """

    coarse: Mapping[int, int] = field(default_factory=lambda: MappingProxyType({2: 48, 3: 162}))
    spacing: Mapping[int, float] = field(
        default_factory=lambda: MappingProxyType({2: 0.13, 3: 0.28})
    )
    levels: int = 5


TUNING = Tuning()
"""The values in use."""
