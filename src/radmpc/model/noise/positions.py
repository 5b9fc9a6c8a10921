"""What disturbances that others meet, too, make of a vehicle's position."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence

import numpy as np

from radmpc.arrays import Matrix, Tensor
from radmpc.model.dynamics import LinearSystem
from radmpc.model.noise.response import response_of
from radmpc.model.noise.spread import Noise
from radmpc.records import dataclass

__all__ = ["PositionResponse", "position_response", "side_by_side", "without_common"]

_CANCELED = 1e-13
"""Share of the sum of two variances below which what is left of it is rounding [-]."""


@dataclass(frozen=True, slots=True, eq=False)
class PositionResponse:
    """What the normals behind shared disturbances make of a vehicle's position.

    Attributes
    ----------
    columns : mapping of str to slice
        Those of each source.
    positions : (T+1, d, E) array
        Of the position at every step [m].
    bent : (T, d, E) array
        Of what feedback held over a step makes of the deviation at its start [m]; that deviation's
        own where the path does not bend.
    """

    columns: Mapping[str, slice]
    positions: Tensor
    bent: Tensor


def position_response(
    system: LinearSystem, noise: Noise, gain: Matrix | None, horizon: int
) -> PositionResponse | None:
    """Return how a vehicle's position answers the disturbances that it shares, None without any.

    Parameters
    ----------
    system : LinearSystem
        The vehicle's dynamics.
    noise : Noise
        What shakes it, and what it knows of that.
    gain : (m, n) array or None
        Feedback K; None is open loop.
    horizon : int
        Number of steps T.
    """
    if not noise.shared:
        return None
    response = response_of(system, noise, gain, horizon)
    picked = np.eye(system.num_states)[list(system.position)]
    none = np.zeros_like(picked)
    bend = none
    if gain is not None and system.is_double_integrator:
        bend = picked @ system.B @ gain
    return PositionResponse(
        response.columns,
        response.of_sums(slice(None), picked, none),
        response.of_sums(slice(0, horizon), picked, -bend),
    )


def side_by_side(
    columns: Sequence[Mapping[str, slice] | None], responses: Sequence[Tensor | None]
) -> list[Tensor | None]:
    """Return responses with equal columns for equal sources, zeros for those of others.

    Noise that only one vehicle responds to correlates no vehicles, and is left out.

    Parameters
    ----------
    columns : sequence of (mapping of str to slice, or None)
        Those of each source in each response.
    responses : sequence of ((..., E) array or None)
        As many; None answers nothing.
    """
    holders = Counter(name for one in columns if one is not None for name in one)
    widths: dict[str, int] = {}
    for one in columns:
        for name, place in ({} if one is None else one).items():
            if holders[name] > 1:
                widths[name] = place.stop - place.start
    found: list[Tensor | None] = []
    for one, response in zip(columns, responses, strict=True):
        if one is None or response is None:
            found.append(None)
            continue
        none = {name: np.zeros((*response.shape[:-1], width)) for name, width in widths.items()}
        parts = [response[..., one[name]] if name in one else none[name] for name in widths]
        found.append(np.concatenate([response[..., :0], *parts], axis=-1))
    return found


def without_common(total: Tensor, mine: Tensor | None, other: Tensor | None) -> Tensor:
    """Return covariances of differences of which responses are correlated.

    Parameters
    ----------
    total : (..., d, d) array
        Sums of both covariances [m²].
    mine, other : (..., d, E) array or None
        What the same normals make of both [m]; None is nothing.
    """
    if mine is None or other is None:
        return total
    common = mine @ np.swapaxes(other, -1, -2)
    found = total - common - np.swapaxes(common, -1, -2)
    before, left = (np.trace(each, axis1=-2, axis2=-1) for each in (total, found))
    # Two that answer alike and have no noise of their own stay as they are to each other, as far as
    # digits tell.
    most = (_CANCELED * before)[..., None, None]
    return np.where(left[..., None, None] <= most, most * np.eye(total.shape[-1]), found)
