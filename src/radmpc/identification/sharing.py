"""What part of the noise is common to vehicles at equal times."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import combinations

import numpy as np

from radmpc.arrays import Indices, Matrix
from radmpc.identification.intervals import Interval, normal_interval
from radmpc.records import dataclass

__all__ = ["Shared", "nearest_covariance", "own_part", "shared_part"]

_LEAST_STEPS = 20
"""Steps at equal times below which nothing is said."""

_SURE = 2.58
"""Standard deviations [-] beyond which a common part is taken for real: 1 % by chance."""


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
        Whether chance hardly makes it.
    """

    vehicles: tuple[str, ...]
    num_steps: int
    share: Interval
    covariance: Interval
    is_sure: bool


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
    return Shared(names, len(products), share, covariance, bool(score > _SURE))


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
