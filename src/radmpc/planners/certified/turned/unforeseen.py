"""What paths came near once they were planned, and had no half-space between."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from radmpc.arrays import Indices, Tensor
from radmpc.planners.certified.turned.half_spaces import HalfSpaces, half_spaces
from radmpc.planners.certified.turned.linear.margins import far_of
from radmpc.planners.certified.turned.near import Near
from radmpc.planners.certified.turned.paths import Paths
from radmpc.planners.certified.turned.tuning import TUNING
from radmpc.program.hazards import Hazards

__all__ = ["unforeseen"]

_SURELY = 0.99
"""Share of a reach that paths may move by without another look [-]: rounding."""


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
        Who moved, ascending.
    before : (N, T+1, d) array
        Where everybody was [m].
    had : tuple of ((w,) int array, float)
        Keys of the half-spaces turned to where they were, and how far beyond what counts as near
        these were sought [m].

    Returns
    -------
    HalfSpaces or None
        None where nobody moved so far that there can be any.
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
