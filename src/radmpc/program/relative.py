"""How far vehicles stray relative to each other: less where both answer the same disturbance."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from radmpc.arrays import Tensor
from radmpc.model.noise.positions import side_by_side, without_common
from radmpc.model.obstacle_track import TrackSpread
from radmpc.program.avoidance import Body, Part
from radmpc.program.condensed import CondensedModel

__all__ = [
    "are_isotropic",
    "own_body",
    "relative_bent_covariances",
    "relative_body",
    "relative_covariances",
]

_SAME = 1e-12
"""Share of a variance by which those of isotropic noise may differ [-]."""


def own_body(model: CondensedModel, part: Part, spread: TrackSpread | None) -> Body:
    """Return the position of a vehicle, as seen from something whose own place spreads.

    Parameters
    ----------
    model : CondensedModel
        The vehicle.
    part : Part
        Its place among the outputs.
    spread : TrackSpread or None
        How the other's place spreads; None is not at all.
    """
    covariances, bent = model.position_covariances, model.bent_covariances
    if spread is not None:
        covariances = covariances + spread.positions
        bent = None if bent is None else bent + spread.positions[:-1]
    return Body(model.reach_lower, model.reach_upper, covariances, bent, (part,))


def relative_body(models: tuple[CondensedModel, CondensedModel], first: Part, second: Part) -> Body:
    """Return the position of one vehicle relative to another's.

    Parameters
    ----------
    models : tuple of CondensedModel
        The two, over the same steps.
    first, second : Part
        Their places among the outputs.
    """
    one, two = models
    return Body(
        one.reach_lower - two.reach_upper,
        one.reach_upper - two.reach_lower,
        relative_covariances(one, two),
        relative_bent_covariances(one, two),
        (first, replace(second, sign=-1.0)),
    )


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


def are_isotropic(covariances: Tensor | None) -> bool:
    """Return whether noise is the same in all directions.

    Parameters
    ----------
    covariances : (…, d, d) array or None
        Of the noise [m²]; None is that there is none.
    """
    if covariances is None:
        return True
    d = covariances.shape[-1]
    mean = np.trace(covariances, axis1=-2, axis2=-1)[..., None, None] / d
    return bool(np.all(np.abs(covariances - mean * np.eye(d)) <= _SAME * np.abs(mean)))
