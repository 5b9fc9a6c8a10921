r"""Covariances between two vehicles at moments between the steps (`radmpc.referee.bound.moments`).

At shares s and t of the same step positions have, by noise that both meet,

.. math:: \operatorname{cov}(y_i(s), y_j(t)) =
    C_i(s)\,\Sigma_{ij}\,C_j(t)^\top + s\,t\,P_i M_i M_j^\top P_j^\top.
"""

from __future__ import annotations

import numpy as np

from radmpc.arrays import Indices, Tensor
from radmpc.records import dataclass
from radmpc.referee.common import FleetCommon

__all__ = ["CrossCovariances", "cross_covariances"]


@dataclass(frozen=True, slots=True, eq=False)
class CrossCovariances:
    """What is taken off the moments of differences, once for ``own`` and ``bent``, else in all.

    Attributes
    ----------
    own : (P, T M + 1, d, d) array
        Covariance of the first position with the second [m²].
    bent : (P, T M, d, d) array
        Of the first bent near end of each part with the second.
    near_with_bent, bent_with_far : (P, T M, d, d) array
        Of both ends with those of the other, both ways round.
    """

    own: Tensor
    bent: Tensor
    near_with_bent: Tensor
    bent_with_far: Tensor


def cross_covariances(
    common: FleetCommon, first: Indices, other: Indices, parts: int
) -> CrossCovariances:
    """Return the covariances between pairs of vehicles at the ends of parts of steps.

    Parameters
    ----------
    common : FleetCommon
        What the fleet has in common.
    first, other : (P,) int array
        The pairs.
    parts : int
        M, parts of each step, >= 1.
    """
    count, d = len(first), common.picks.shape[1]
    horizon = common.horizon
    own = np.empty((count, horizon * parts + 1, d, d))
    pieces = [np.empty((count, horizon * parts, d, d)) for _ in range(3)]
    for block in common.blocks(count):
        i, j = first[block], other[block]
        crossed = common.crossed(i, j)
        own[block, -1] = common.picks[i] @ crossed[:, -1] @ _turned(common.picks[j])
        for k in range(horizon):
            now = slice(k * parts, (k + 1) * parts)
            found = _step(common, (i, j), crossed[:, k], k, parts)
            own[block, now] = found[0]
            for piece, values in zip(pieces, found[1:], strict=True):
                piece[block, now] = values
    return CrossCovariances(own, *pieces)


def _step(
    common: FleetCommon, pair: tuple[Indices, Indices], crossed: Tensor, k: int, parts: int
) -> tuple[Tensor, Tensor, Tensor, Tensor]:
    """Return the covariances of a step's parts, (P, M, d, d) each, as in `CrossCovariances`."""
    i, j = pair
    s = (np.arange(parts + 1) / parts)[:, None, None]
    (near_i, bent_i, far_i), (near_j, bent_j, far_j) = (
        _seen(common, vehicles, k, parts) for vehicles in pair
    )
    pushes = common.at(common.pushes, k)
    noise = common.picks[i] @ pushes[i] @ _turned(common.picks[j] @ pushes[j])
    noise, back = noise[:, None], _turned(noise)[:, None]
    here, there = crossed[:, None], _turned(crossed)[:, None]
    fresh, onward = s[:-1] ** 2, s[:-1] * s[1:]
    return (
        near_i @ here @ _turned(near_j) + fresh * noise,
        bent_i @ here @ _turned(bent_j) + fresh * noise,
        near_i @ here @ _turned(bent_j) + near_j @ there @ _turned(bent_i) + fresh * (noise + back),
        bent_i @ here @ _turned(far_j) + bent_j @ there @ _turned(far_i) + onward * (noise + back),
    )


def _seen(common: FleetCommon, vehicles: Indices, k: int, parts: int) -> tuple[Tensor, ...]:
    """Return C at near ends, at bent near ends, and at far ends of a step's parts, (P, M, d, Q)."""
    s = (np.arange(parts + 1) / parts)[:, None, None]
    picked = common.picks[vehicles][:, None]
    bend = picked - common.turns[vehicles][:, None]
    moved = picked @ common.at(common.transitions, k)[vehicles][:, None]
    C = (1.0 - s) * picked + s * moved - s * (1.0 - s) * bend
    return C[:, :-1], C[:, :-1] - bend / parts**2, C[:, 1:]


def _turned(tensor: Tensor) -> Tensor:
    """Return transposes over the last two axes."""
    return np.swapaxes(tensor, -1, -2)
