"""How far vehicles stray relative to each other: less where both answer the same disturbance."""

from __future__ import annotations

import numpy as np

from radmpc.arrays import Tensor
from radmpc.model.noise.positions import side_by_side, without_common
from radmpc.program.condensed import CondensedModel

__all__ = ["relative_bent_covariances", "relative_covariances"]


def relative_covariances(one: CondensedModel, two: CondensedModel) -> Tensor:
    """Return the covariances of one vehicle's position relative to another's, (T+1, d, d) [m²].

    Parameters
    ----------
    one, two : CondensedModel
        Over the same steps.
    """
    total = one.position_covariances + two.position_covariances
    if one.common is None or two.common is None:
        return total
    both = one.common, two.common
    mine, other = side_by_side([r.columns for r in both], [r.positions for r in both])
    return without_common(total, mine, other)


def relative_bent_covariances(one: CondensedModel, two: CondensedModel) -> Tensor | None:
    """Return what feedback held over a step makes of relative deviations at its start.

    Parameters
    ----------
    one, two : CondensedModel
        Over the same steps.

    Returns
    -------
    (T, d, d) array or None
        Covariances [m²], with a vehicle's own where its path does not bend; None where no path
        does.
    """
    if one.bent_covariances is None and two.bent_covariances is None:
        return None
    parts = [
        model.position_covariances[:-1]
        if model.bent_covariances is None
        else model.bent_covariances
        for model in (one, two)
    ]
    total = np.asarray(np.sum(parts, axis=0))
    if one.common is None or two.common is None:
        return total
    both = one.common, two.common
    mine, other = side_by_side([r.columns for r in both], [r.bent for r in both])
    return without_common(total, mine, other)
