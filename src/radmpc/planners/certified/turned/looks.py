"""Checks of given paths: which keep clear of everything, and pairs without a half-space."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from radmpc.arrays import Indices, Tensor
from radmpc.planners.certified.turned.half_spaces import half_spaces
from radmpc.planners.certified.turned.linear.margins import far_of
from radmpc.planners.certified.turned.near import Near
from radmpc.planners.certified.turned.normals.spaces import HalfSpaces
from radmpc.planners.certified.turned.paths import Paths
from radmpc.planners.certified.turned.tuning import TUNING
from radmpc.program.hazards import Hazards
from radmpc.records import replace

__all__ = ["keep_clear", "unforeseen"]

_SURELY = 0.99
"""Share of a reach that paths may move by without another look [-]: rounding."""

_TOGETHER = 32
"""Vehicles that are looked at in one go [-]: of eight that takes a quarter of the time that one by
one take, and of more than these arrays grow and nothing is gained."""


def keep_clear(
    hazards: Hazards, paths: Paths, vehicles: Sequence[int], near: Near
) -> npt.NDArray[np.bool_]:
    """Return which vehicles keep a clearance from everything, (N,); False of all others.

    Parameters
    ----------
    hazards, paths : Hazards and Paths
        The fleet, and everyone's paths.
    vehicles : sequence of int
        Vehicles that are asked for, ascending.
    near : Near
        The clearance, and what counts as near; one looks around as far as each vehicle reaches.
    """
    is_clear = np.zeros(hazards.count, dtype=bool)
    for begin in range(0, len(vehicles), _TOGETHER):
        group = list(vehicles[begin : begin + _TOGETHER])
        near = replace(near, reach=float(hazards.reaches[group].max()))
        spaces = half_spaces(hazards, paths, group, near)
        is_tight = np.any(spaces.clearances < near.clearance, axis=1)
        others = spaces.second[is_tight]
        is_clear[group] = True
        is_clear[spaces.first[is_tight]] = False
        is_clear[others[others >= 0]] = False
    return is_clear


def unforeseen(
    hazards: Hazards,
    paths: Paths,
    members: Sequence[int],
    before: Tensor,
    had: tuple[Indices, float],
) -> HalfSpaces | None:
    """Return half-spaces between paths and what they came near without any.

    Parameters
    ----------
    hazards : Hazards
        The fleet.
    paths : Paths
        Everyone's latest paths.
    members : sequence of int
        Vehicles that moved, ascending.
    before : (N, T+1, d) array
        Where everybody was [m].
    had : tuple of ((w,) int array, float)
        Keys of the half-spaces turned to where they were, and how far beyond what counts as near
        these were sought [m].

    Returns
    -------
    HalfSpaces or None
        None where no vehicle moved so far that there can be any.
    """
    keys, reach = had
    some = list(members)
    furthest = float(np.abs(paths.means[some] - before[some]).max(initial=0.0))
    # Two that move come closer by as much as both do, whatever they are to each other.
    if 2.0 * math.sqrt(hazards.dimension) * furthest < _SURELY * reach:
        return None
    far = far_of(hazards.tail, TUNING.compared)
    latest = half_spaces(hazards, paths, members, Near(far, 0.0, is_refined=False))
    return latest.of((latest.clearances < far).any(axis=1) & ~np.isin(latest.keys, keys))
