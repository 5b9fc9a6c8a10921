"""What part of the noise is common to vehicles at equal times."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import combinations
from typing import NamedTuple

import numpy as np
from scipy.special import chdtrc, ndtri

from radmpc.arrays import Indices, Matrix
from radmpc.identification.intervals import Interval, normal_interval
from radmpc.records import dataclass

__all__ = ["Shared", "against_others", "nearest_covariance", "own_part", "shared_part"]

_LEAST_STEPS = 20
"""Steps at equal times below which nothing is said."""

_SURE = 2.58
"""Standard deviations [-] beyond which a common part is taken for real: 1 % by chance."""

_DOUBT = 0.01
"""Probability [-] of such differences between pairs, or of any such pair, that counts as none."""

_LEAST_SPREAD = 0.1
"""Difference of shares [-] between pairs below which they count as alike, however sure it is."""


@dataclass(frozen=True, slots=True, eq=False)
class Shared:
    """What vehicles have in common.

    Attributes
    ----------
    vehicles : tuple of str
        Whose noise was compared.
    num_steps : int
        Steps at which two or more were there.
    share : Interval
        Mean correlation between vehicles [-]: the share of the variance that is common.
    covariance : Interval
        Covariance D of the common part, (n, n).
    is_sure : bool
        Whether chance hardly makes it, and it is the same for all pairs.
    is_mixed : bool
        Whether pairs differ beyond chance, so that no common part describes all.
    alike, opposed : tuple of pairs of str
        Vehicles whose noise goes together, and goes against each other, beyond chance.
    opposition : float
        By what share of its variance noise goes against that of another vehicle at most [-].
    """

    vehicles: tuple[str, ...]
    num_steps: int
    share: Interval
    covariance: Interval
    is_sure: bool
    is_mixed: bool = False
    alike: tuple[tuple[str, str], ...] = ()
    opposed: tuple[tuple[str, str], ...] = ()
    opposition: float = 0.0


class _Pair(NamedTuple):
    """Two vehicles: the share they have in common, its deviation, and how far they oppose."""

    names: tuple[str, str]
    share: float
    deviation: float
    opposition: float


def shared_part(
    noise: Mapping[str, tuple[Indices, Matrix]], color: float, spread: Matrix
) -> Shared | None:
    """Return the part of the noise that vehicles share.

    Parameters
    ----------
    noise : mapping
        Steps and residuals with mean zero, by vehicle, all of one clock.
    color : float
        Autocorrelation of the residuals from step to step [-].
    spread : (n, n) array
        Covariance of one vehicle's noise.

    Returns
    -------
    Shared or None
        None where vehicles were not there at equal times often enough.
    """
    if len(noise) < 2:
        return None
    names = tuple(noise)
    first = min(int(steps[0]) for steps, _ in noise.values() if steps.size)
    last = max(int(steps[-1]) for steps, _ in noise.values() if steps.size)
    if (last - first) > 100 * max(steps.size for steps, _ in noise.values()):
        return None
    n = spread.shape[0]
    table = np.full((len(names), last - first + 1, n), np.nan)
    for row, (steps, residuals) in zip(table, noise.values(), strict=True):
        row[steps - first] = residuals
    products = _products(table)
    if len(products) < _LEAST_STEPS:
        return None
    # Neighboring products are as alike as the noise is, squared.
    worth = len(products) * (1.0 - color**2) / (1.0 + color**2)
    scale = _unit(spread)
    shares = np.einsum("kij,ij->k", products, scale) / max(np.linalg.matrix_rank(scale), 1)
    share = normal_interval(shares.mean(), shares.std() / np.sqrt(worth))
    covariance = normal_interval(products.mean(axis=0), products.std(axis=0) / np.sqrt(worth))
    score = shares.mean() / max(float(shares.std()) / np.sqrt(worth), 1e-300)
    pairs = _pairs(names, table, color, spread)
    is_mixed = _are_mixed(pairs)
    limit = float(ndtri(1.0 - 0.5 * _DOUBT / max(len(pairs), 1)))
    opposed = [one for one in pairs if one.share < -limit * one.deviation]
    return Shared(
        names,
        len(products),
        share,
        covariance,
        is_sure=bool(score > _SURE) and not is_mixed,
        is_mixed=is_mixed,
        alike=tuple(one.names for one in pairs if one.share > limit * one.deviation),
        opposed=tuple(one.names for one in opposed),
        opposition=max((one.opposition for one in opposed), default=0.0),
    )


def _pairs(names: Sequence[str], table: Matrix, color: float, spread: Matrix) -> list[_Pair]:
    """Return what each two vehicles have in common that were there at equal times often enough."""
    found, scale = [], _unit(spread)
    rank = max(np.linalg.matrix_rank(scale), 1)
    for (one, first), (other, second) in combinations(zip(names, table, strict=True), 2):
        products = _products(np.stack([first, second]))
        if len(products) < _LEAST_STEPS:
            continue
        worth = len(products) * (1.0 - color**2) / (1.0 + color**2)
        shares = np.einsum("kij,ij->k", products, scale) / rank
        deviation = max(float(shares.std()) / np.sqrt(worth), 1e-300)
        relative = np.linalg.eigvals(products.mean(axis=0) @ scale).real
        least = min(max(-float(relative.min()), 0.0), 1.0)
        found.append(_Pair((one, other), float(shares.mean()), deviation, least))
    return found


def _are_mixed(pairs: Sequence[_Pair]) -> bool:
    """Whether pairs differ beyond chance, and by so much that it matters."""
    if len(pairs) < 2:
        return False
    shares = np.array([one.share for one in pairs])
    weights = np.array([one.deviation for one in pairs]) ** -2.0
    mean = float(np.average(shares, weights=weights))
    chance = float(chdtrc(len(pairs) - 1, float(weights @ (shares - mean) ** 2)))
    return chance < _DOUBT and float(np.ptp(shares)) > _LEAST_SPREAD


def _products(table: Matrix) -> Matrix:
    """Return the mean symmetric product of two vehicles' residuals, at each step with two."""
    total = np.zeros((table.shape[1], table.shape[2], table.shape[2]))
    pairs = np.zeros(table.shape[1])
    for one, other in combinations(table, 2):
        is_there = np.isfinite(one[:, 0]) & np.isfinite(other[:, 0])
        product = one[is_there, :, None] * other[is_there, None, :]
        total[is_there] += 0.5 * (product + product.transpose(0, 2, 1))
        pairs += is_there
    has_pair = pairs > 0
    return np.asarray(total[has_pair] / pairs[has_pair, None, None])


def _unit(spread: Matrix) -> Matrix:
    """Return the pseudo-inverse of a covariance, by shares of the axes' own scales."""
    scale = np.sqrt(np.maximum(np.diag(spread), 1e-200))
    relative = spread / np.outer(scale, scale)
    return np.asarray(np.linalg.pinv(relative, rcond=1e-9, hermitian=True) / np.outer(scale, scale))


def own_part(covariance: Matrix, shared: Shared | None) -> Matrix:
    """Return what remains of a covariance without the common part; no variance is negative.

    Parameters
    ----------
    covariance : (n, n) array
        Of one vehicle's noise.
    shared : Shared or None
        The common part; None leaves the covariance as it is.
    """
    return (
        covariance if shared is None else nearest_covariance(covariance - shared.covariance.value)
    )


def against_others(vehicles: Sequence[str], shared: Shared | None) -> float:
    """Return by what factor noise of their own is as bad as noise that opposes others' [-].

    Two vehicles whose noise is opposite come closer to each other than independent ones; with
    variances that are larger by the opposite share, independent noise is no better.

    Parameters
    ----------
    vehicles : sequence of str
        Those with the same noise.
    shared : Shared or None
        What was found of all.
    """
    if shared is None or not any(set(pair) & set(vehicles) for pair in shared.opposed):
        return 1.0
    return 1.0 + shared.opposition


def nearest_covariance(matrix: Matrix) -> Matrix:
    """Return the nearest positive semi-definite matrix, axes weighed by their own scales.

    Parameters
    ----------
    matrix : (n, n) array
        Symmetric.
    """
    kept = np.flatnonzero(matrix.any(axis=1))
    if kept.size < len(matrix):
        # States without any noise stay so, to the last digit.
        found = np.zeros_like(matrix)
        if kept.size:
            found[np.ix_(kept, kept)] = nearest_covariance(matrix[np.ix_(kept, kept)])
        return found
    sizes = np.abs(np.diag(matrix))
    scale = np.sqrt(np.maximum(sizes, max(1e-12 * float(sizes.max()), 1e-200)))
    values, vectors = np.linalg.eigh(matrix / np.outer(scale, scale))
    if values[0] >= 0.0:
        return matrix
    found = (vectors * np.maximum(values, 0.0)) @ vectors.T * np.outer(scale, scale)
    return np.asarray(0.5 * (found + found.T))
