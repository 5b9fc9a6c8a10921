"""Half-spaces beside paths: what they ask for, and what the latest paths keep of it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from radmpc.arrays import Indices, Matrix, Vector, field_names
from radmpc.planners.certified.turned.normals.encounter import Encounter
from radmpc.planners.certified.turned.normals.nearest import nearest_shares
from radmpc.records import dataclass

__all__ = ["HalfSpaces", "laid_out"]

_TINY = 1e-12
"""Stands for a length of 0 where one divides by it [m]."""


@dataclass(frozen=True, slots=True, eq=False)
class HalfSpaces:
    """Half-spaces ``normal @ (position of first - position of second) >= offset``, w of them.

    Attributes
    ----------
    first, second : (w,) int array
        Vehicles; the second is -1 where the half-space is that of an obstacle or the workspace.
    windows : (w,) int array
        Window k: the interval [k, k+1], or step k+1 alone.
    normals : (w, d) array
        Unit normals, away from what is avoided.
    offsets : (w, 2) array
        Right sides without noise at the window's start and end [m].
    deviations : (w, 2) array
        Standard deviations along the normals there [m].
    shares : (w,) array
        Share θ of the start in the reserve for the sagitta: ``4θ²`` of it there, ``4(1 - θ)²`` at
        the end [-].
    heights : (w, 2) array
        Left sides on the latest paths, less the reserve [m].
    keys : (w,) int array
        The same for the same hazard at the same window, whatever the paths.
    nearest : (w,) array
        After which share of the window the path is nearest, where that alone is asked to keep
        clear; nan where both ends are [-].
    """

    first: Indices
    second: Indices
    windows: Indices
    normals: Matrix
    offsets: Matrix
    deviations: Matrix
    shares: Vector
    heights: Matrix
    keys: Indices
    nearest: Vector

    @classmethod
    def joined(cls, parts: Sequence[HalfSpaces]) -> HalfSpaces:
        """Return all of several parts, in order."""
        columns = ([getattr(part, name) for part in parts] for name in _NAMES)
        return cls(*(np.concatenate(each) for each in columns))

    @property
    def count(self) -> int:
        """Number of half-spaces w."""
        return len(self.first)

    def of(self, chosen: npt.NDArray[np.bool_]) -> HalfSpaces:
        """Return some of them, (w,) bool array."""
        return HalfSpaces(*(getattr(self, name)[chosen] for name in _NAMES))

    @property
    def clearances(self) -> Matrix:
        """Standard deviations that the latest paths keep, (w, 2); large without noise."""
        room: Matrix = self.heights - self.offsets
        return room / np.maximum(self.deviations, _TINY)


_NAMES = field_names(HalfSpaces)


def laid_out(
    encounter: Encounter,
    normals: Matrix,
    who: tuple[Indices, Indices, Indices],
    keys: Indices,
    is_nearest_asked: bool = False,
    is_start_given: npt.NDArray[np.bool_] | None = None,
) -> HalfSpaces:
    """Return the half-spaces of an encounter along given normals.

    Parameters
    ----------
    encounter : Encounter
        Paths past something, at w windows.
    normals : (w, d) array
        Unit normals.
    who : tuple of (w,) int array
        First and second vehicles, and windows, see `HalfSpaces`.
    keys : (w,) int array
        The same for the same hazard at the same window.
    is_nearest_asked : bool
        Whether paths keep clear of corners, and of each other, where they are nearest alone.
    is_start_given : (w,) bool array or None
        Where nothing is asked of the start.
    """
    offsets, deviations, shares = encounter.along(normals)
    nearest = np.full(len(normals), np.nan)
    if is_nearest_asked and len(encounter.ends) == 2:
        nearest = nearest_shares(encounter, normals)
    if is_start_given is not None:
        shares[is_start_given], nearest[is_start_given] = 0.0, np.nan
    heights = [np.einsum("wd,wd->w", normals, end) for end in encounter.ends]
    if len(heights) == 2:
        reserve = 4.0 * np.maximum(np.einsum("wd,wd->w", normals, encounter.sagittas), 0.0)
        heights[0] = heights[0] - np.square(shares) * reserve
        heights[1] = heights[1] - np.square(1.0 - shares) * reserve
    both = np.stack([heights[0], heights[-1]], axis=1)
    return HalfSpaces(*who, normals, offsets, deviations, shares, both, keys, nearest)
