r"""What a chain of half-spaces fails with, each charged for what the one before did not.

For events in any order, and a tree that joins each to an earlier one (Hunter 1976, Worsley 1982),

.. math:: \Pr\Bigl[\bigcup_e V_e\Bigr] \le \Pr[V_0] + \sum_{e > 0} \Pr[V_e \setminus V_{e-1}].

A deviation that is too large at one moment mostly is at the next: what is charged for the next is
only the part that is new. Along an interval the order is near end, bent near end, far end, and the
far end of one part stands at the near end of the next.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.special import ndtr

from radmpc.arrays import Indices, Matrix, Tensor, Vector
from radmpc.referee.bound.bivariate import exceeds_alone
from radmpc.referee.bound.halfspace import chord_margins, deviations, sags
from radmpc.referee.reserve import held, in_deviations
from radmpc.referee.sites import Sites

__all__ = ["Crossed", "best_shares", "path_charges"]

_TELLING = 1e-4
"""Share of an encounter's sum, spread over its parts, below which an event is charged whole."""


@dataclass(frozen=True, slots=True, eq=False)
class Crossed:
    """Covariances between the ends of each part, (S, d, d) each [m²].

    ``bent_with_far`` is that of the near end where there is no bent one, and ``near_with_bent``
    is not looked at.
    """

    near_with_bent: Tensor
    bent_with_far: Tensor

    def take(self, chosen: Indices) -> Crossed:
        """Return those of some parts."""
        return Crossed(self.near_with_bent[chosen], self.bent_with_far[chosen])


def best_shares(sites: Sites, directions: Matrix) -> Vector:
    """Return the near ends' share of the reserve for the bow that costs least, (S,)."""
    along = directions[:, None]
    margins, spread = chord_margins(sites, along), deviations(sites, along)
    return _held(sites, margins, spread, sags(sites, along))[1]


def _held(sites: Sites, margins: Tensor, spread: Tensor, sag: Matrix) -> tuple[Matrix, Vector]:
    """Return the clearances of each site's ends, (S, E), with the cheapest shares, (S,)."""
    levels = in_deviations(margins[:, 0], spread[:, 0])
    shares = np.full(len(margins), 0.5)
    bowed = np.flatnonzero(sag[:, 0] > 0.0)
    if bowed.size:
        ends = margins[bowed, 0], spread[bowed, 0], sag[bowed, 0]
        levels[bowed], shares[bowed] = held(sites.is_near, *ends)
    return levels, shares


def path_charges(sites: Sites, directions: Matrix, crossed: Crossed, parts: int) -> Tensor:
    """Return what one half-space per part costs at every step.

    Parameters
    ----------
    sites : Sites
        The parts of B encounters in order, ``K M`` of each.
    directions : (B, K M, d) array
        The half-space of each part.
    crossed : Crossed
        Covariances between the ends of each part.
    parts : int
        M, parts of each interval.

    Returns
    -------
    (B, K + 1) array
        Sums over the steps bound the probability that any of an encounter's half-spaces fails.
    """
    count, width, d = directions.shape
    flat = directions.reshape(-1, 1, d)
    spread = deviations(sites, flat)
    held, _ = _held(sites, chord_margins(sites, flat), spread, sags(sites, flat))
    levels, spread = held.reshape(count, width, -1), spread.reshape(count, width, -1)
    risks: Tensor = ndtr(-levels)
    boole = risks.sum(axis=(1, 2))
    least = _TELLING * boole[:, None] / width
    charged = risks.copy()

    def alone(before: Matrix, after: Matrix, covariance: Matrix, scale: Matrix) -> Matrix:
        """Return what ``after`` is exceeded with while ``before`` is not."""
        result: Matrix = ndtr(-after)
        telling = (result > least) & (ndtr(-before) > 1e-3 * result)
        rho = covariance[telling] / np.where(scale[telling] > 0.0, scale[telling], 1.0)
        result[telling] = exceeds_alone(before[telling], after[telling], np.clip(rho, -1.0, 1.0))
        return result

    bent = levels.shape[2] - 2
    if bent:
        covariance = _along(directions, crossed.near_with_bent, directions)
        charged[:, :, 1] = alone(
            levels[:, :, 0], levels[:, :, 1], covariance, spread[:, :, 0] * spread[:, :, 1]
        )
    covariance = _along(directions, crossed.bent_with_far, directions)
    charged[:, :, -1] = alone(
        levels[:, :, bent], levels[:, :, -1], covariance, spread[:, :, bent] * spread[:, :, -1]
    )
    own = sites.covariances[:, 0].reshape(count, width, d, d)[:, 1:]
    covariance = _along(directions[:, :-1], own, directions[:, 1:])
    # The far end's deviation of one part and the near end's of the next are those of one moment.
    scale = spread[:, :-1, -1] * spread[:, 1:, 0]
    least = least[:, :1]
    charged[:, 1:, 0] = alone(levels[:, :-1, -1], levels[:, 1:, 0], covariance, scale)
    return _by_step(charged, parts)


def _along(before: Tensor, covariances: Tensor, after: Tensor) -> Matrix:
    """Return covariances between components along two directions, (B, W)."""
    shape = (*before.shape, before.shape[-1])
    first = np.einsum("bwd,bwde->bwe", before, covariances.reshape(shape))
    return np.asarray(np.einsum("bwe,bwe->bw", first, after))


def _by_step(charged: Tensor, parts: int) -> Tensor:
    """Sum charges of near and far ends, (B, K M, E), to the step that is closest, (B, K + 1)."""
    count, width, _ = charged.shape
    near = (np.arange(width) + parts // 2) // parts
    far = (np.arange(1, width + 1) + (parts - 1) // 2) // parts
    steps = np.zeros((count, width // parts + 1))
    np.add.at(steps.T, near, charged[:, :, :-1].sum(axis=2).T)
    np.add.at(steps.T, far, charged[:, :, -1].T)
    return steps
