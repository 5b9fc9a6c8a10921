"""Which half-spaces curves may come closer to than their chords."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from radmpc.arrays import Indices
from radmpc.planners.certified.turned.linear.given import Places
from radmpc.planners.certified.turned.normals.spaces import HalfSpaces
from radmpc.program.condensed import CondensedModel

__all__ = ["can_bend"]

_LITTLE = 1e-9
"""Length below which a curve counts as its chord [m]."""


def can_bend(
    models: Sequence[CondensedModel], slots: Indices, spaces: HalfSpaces, paths: Places
) -> npt.NDArray[np.bool_]:
    """Return whether any controls of the members bring the curve closer than its chord.

    Parameters
    ----------
    models : sequence of CondensedModel
        The members.
    slots : (N,) int array
        The place of every vehicle among them; -1 of all others.
    spaces : HalfSpaces
        Turned to the latest paths.
    paths : Places
        Those paths.

    Returns
    -------
    (w,) bool array
        For each half-space.
    """
    most = np.zeros(spaces.count)
    for sign, vehicles in ((1.0, spaces.first), (-1.0, spaces.second)):
        mine_at = np.where(vehicles >= 0, slots[vehicles], -1)
        for slot, model in enumerate(models):
            mine = mine_at == slot
            bounds = np.maximum(model.control_bounds, 0.0)[spaces.windows[mine]]
            pulls = np.abs(spaces.normals[mine] @ model.vehicle.system.sagitta)
            most[mine] += np.einsum("wm,wm->w", pulls, bounds)
        still = (vehicles >= 0) & (mine_at < 0)
        hang = paths.sagittas[vehicles[still], spaces.windows[still]]
        most[still] += sign * np.einsum("wd,wd->w", spaces.normals[still], hang)
    return np.asarray(most > _LITTLE)
