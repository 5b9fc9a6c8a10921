"""What a linear program of a group of vehicles answers."""

from __future__ import annotations

from radmpc.arrays import Matrix
from radmpc.records import dataclass

__all__ = ["GroupPlan"]


@dataclass(frozen=True, slots=True, eq=False)
class GroupPlan:
    """What a group does between half-spaces.

    Attributes
    ----------
    controls : tuple of (T, m) array
        Of its members.
    shortfall : float
        How far half-spaces are missed in all [m].
    risk : float
        What the risks given up to sum to [-].
    """

    controls: tuple[Matrix, ...]
    shortfall: float
    risk: float
