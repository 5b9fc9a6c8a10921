r"""What a chain of half-spaces fails with, each charged for what the one before did not.

For events in any order, and a tree that joins each to an earlier one (Hunter 1976, Worsley 1982),

.. math:: \Pr\Bigl[\bigcup_e V_e\Bigr] \le \Pr[V_0] + \sum_{e > 0} \Pr[V_e \setminus V_{e-1}].

A deviation that is too large at one moment mostly is at the next: what is charged for the next is
only the part that is new. Along an interval the order is near end, bent near end, far end, and the
far end of one part stands at the near end of the next.
"""

from __future__ import annotations

import numpy as np

from radmpc.arrays import Indices, Matrix, Tensor, Vector
from radmpc.records import dataclass
from radmpc.referee.bound.mixture import exceeds_alone_under
from radmpc.referee.reserve import held, in_deviations
from radmpc.referee.sites import Chords, Sites, chords
from radmpc.referee.tails import exceeding

__all__ = ["TELLING", "Crossed", "best_shares", "least_risks", "path_charges"]

TELLING = 1e-4
"""Share of an encounter's sum, spread over its parts, below which an event is charged whole."""


_Link = tuple[tuple[int, slice], tuple[int, slice], Tensor]
"""An end and its parts, the end that follows it and its parts, and their covariances."""


@dataclass(frozen=True, slots=True, eq=False)
class Crossed:
    """Covariances between the ends of each part.

    Attributes
    ----------
    near_with_bent : (S, d, d) array
        Of the near end with the bent one [m²]; not looked at where there is no bent one.
    bent_with_far : (S, d, d) array
        Of the bent near end, or of the near one where there is no bent one, with the far end [m²].
    """

    near_with_bent: Tensor
    bent_with_far: Tensor

    def take(self, chosen: Indices) -> Crossed:
        """Return those of some parts."""
        return Crossed(self.near_with_bent[chosen], self.bent_with_far[chosen])


def best_shares(sites: Sites, directions: Matrix) -> Vector:
    """Return the near ends' share of the reserve for the sagitta that costs least, (S,).

    Parameters
    ----------
    sites : Sites
        S of them.
    directions : (S, d) array
        Unit normal of each site's half-space.
    """
    return _held(sites, chords(sites, directions[:, None]))[1][:, 0]


def least_risks(sites: Sites, directions: Matrix) -> Matrix:
    """Return the probability that each end fails at the shares that cost least, (S, E).

    Parameters
    ----------
    sites : Sites
        S of E ends each.
    directions : (S, d) array
        Unit normal of each site's half-space.
    """
    levels, _ = _held(sites, chords(sites, directions[:, None]))
    return exceeding(levels[:, 0], sites.samples)


def _held(sites: Sites, seen: Chords) -> tuple[Tensor, Matrix]:
    """Return the clearances of all ends, (S, C, E), with the cheapest shares, (S, C)."""
    levels = in_deviations(seen.margins, seen.deviations)
    shares = np.full(seen.sagittas.shape, 0.5)
    bowed = seen.sagittas > 0.0
    if bowed.any():
        ends = seen.margins[bowed], seen.deviations[bowed], seen.sagittas[bowed]
        levels[bowed], shares[bowed] = held(sites.is_near, *ends, sites.samples)
    return levels, shares


def path_charges(sites: Sites, directions: Tensor, crossed: Crossed, parts: int) -> Tensor:
    """Return what one half-space per part costs at every step, for several choices of them.

    Parameters
    ----------
    sites : Sites
        The parts of B encounters in order, ``K M`` of each.
    directions : (B, K M, C, d) array
        The half-spaces of each part: C choices, each held with its like on the other parts.
    crossed : Crossed
        Covariances between the ends of each part.
    parts : int
        M, parts of each interval.

    Returns
    -------
    (B, C, K + 1) array
        Sums over the steps bound the probability that any of an encounter's half-spaces fails.
    """
    count, width, num, d = directions.shape
    seen = chords(sites, directions.reshape(-1, num, d))
    levels, spread = (
        each.transpose(2, 0, 1).reshape(-1, count, width, num)
        for each in (_held(sites, seen)[0], seen.deviations)
    )
    charged = exceeding(levels, sites.samples)
    least = TELLING * charged.sum(axis=(0, 2))[:, None] / width
    found, limits = [], []
    for (end, since), (other, until), covariances in _links(sites, crossed, charged.shape):
        before, after = charged[end][:, since], charged[other][:, until]
        telling = (after > least) & (before > 1e-3 * after)
        scale = (spread[end][:, since] * spread[other][:, until])[telling]
        shared = _along(directions[:, since], covariances, directions[:, until])[telling]
        rho = np.clip(shared / np.where(scale > 0.0, scale, 1.0), -1.0, 1.0)
        found.append((after, telling))
        limits.append((levels[end][:, since][telling], levels[other][:, until][telling], rho))
    # All in one call, and charged only when all risks have been compared.
    before, after, rho = (np.concatenate(each) for each in zip(*limits, strict=True))
    alone = exceeds_alone_under(sites.samples, before, after, rho)
    for after, telling in found:
        after[telling], alone = np.split(alone, [np.count_nonzero(telling)])
    return _by_step(charged, parts)


def _links(sites: Sites, crossed: Crossed, shape: tuple[int, ...]) -> list[_Link]:
    """Return which event follows which at which parts, and the covariances between them."""
    ends, count, width, _ = shape
    d = sites.means.shape[2]
    bent = ends - 2
    everywhere, early, late = slice(None), slice(None, -1), slice(1, None)
    # The far end's deviation of one part and the near end's of the next are those of one moment.
    own = sites.covariances[:, 0].reshape(count, width, d, d)[:, 1:]
    links: list[_Link] = [
        ((bent, everywhere), (-1, everywhere), crossed.bent_with_far),
        ((-1, early), (0, late), own),
    ]
    if bent:
        links.append(((0, everywhere), (1, everywhere), crossed.near_with_bent))
    return links


def _along(before: Tensor, covariances: Tensor, after: Tensor) -> Tensor:
    """Return covariances between components along two directions, (B, W, C)."""
    d = before.shape[-1]
    square = covariances.reshape(*before.shape[:2], d, d)
    turned = np.einsum("bwcd,bwde->bwce", before, square)
    return np.asarray(np.einsum("bwce,bwce->bwc", turned, after))


def _by_step(charged: Tensor, parts: int) -> Tensor:
    """Sum charges of ends, (E, B, K M, C), to the step that is closest, (B, C, K + 1)."""
    width = charged.shape[2]
    near = (np.arange(width) + parts // 2) // parts
    far = (np.arange(1, width + 1) + (parts - 1) // 2) // parts
    steps = np.arange(width // parts + 1)[:, None]
    sums = (near == steps).astype(np.float64) @ charged[:-1].sum(axis=0)
    sums += (far == steps).astype(np.float64) @ charged[-1]
    return np.asarray(sums.transpose(0, 2, 1))
