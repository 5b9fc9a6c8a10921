"""What a linear program of some vehicles takes of a fleet: the planned ones, and where all are."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Protocol

from radmpc.arrays import Tensor
from radmpc.program.condensed import CondensedModel

__all__ = ["Layout", "Places"]


class Layout(Protocol):
    """A fleet laid out, see `Hazards`, or as much of it as some vehicles need."""

    @property
    def models(self) -> Mapping[int, CondensedModel] | tuple[CondensedModel, ...]:
        """Those planned at least, by their numbers."""

    @property
    def count(self) -> int:
        """Vehicles of the fleet N."""

    @property
    def dimension(self) -> int:
        """Number of coordinates d."""

    @property
    def intervals(self) -> bool:
        """Whether collisions count between steps."""


class Places(Protocol):
    """Where everybody is, see `Paths`."""

    @property
    def means(self) -> Tensor:
        """Mean positions, (N, T+1, d) [m]."""

    @property
    def sagittas(self) -> Tensor:
        """How far each path hangs off its chords at mid-step, (N, T, d) [m]."""
