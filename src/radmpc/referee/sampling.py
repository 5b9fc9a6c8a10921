"""Random trajectories of a fleet, drawn in chunks whose numbers depend on nothing but the seed."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from radmpc.arrays import Matrix, Tensor
from radmpc.referee.motion import FleetMotion, Group

__all__ = ["NoiseFactors", "deviations", "noise_factors"]


@dataclass(frozen=True, slots=True, eq=False)
class NoiseFactors:
    """What turns standard normals into the noise of one group.

    Attributes
    ----------
    group : Group
        Whose noise.
    initial, disturbance : (g, n, n) or (g, n, 1) array
        Factors L with ``L Lᵀ`` the covariance; a column of deviations where all are diagonal.
    """

    group: Group
    initial: Tensor
    disturbance: Tensor


def noise_factors(motion: FleetMotion) -> tuple[NoiseFactors, ...]:
    """Return the factors of every group."""
    return tuple(
        NoiseFactors(group, _factor(group.initial), _factor(group.disturbance))
        for group in motion.groups
    )


def _factor(covariances: Tensor) -> Tensor:
    """Return factors of covariances that may be singular."""
    diagonals = np.diagonal(covariances, axis1=1, axis2=2)
    if np.array_equal(covariances, diagonals[:, :, None] * np.eye(covariances.shape[1])):
        column: Tensor = np.sqrt(diagonals.clip(min=0.0))[:, :, None]
        return column
    values, vectors = np.linalg.eigh(covariances)
    return np.asarray(vectors * np.sqrt(values.clip(min=0.0))[:, None, :])


def deviations(
    factors: NoiseFactors, horizon: int, size: int, rng: np.random.Generator
) -> Iterator[Tensor]:
    """Yield ``x − x̄`` at k = 0..T, (g, n, size), the same array overwritten at every step.

    ``e⁺ = (A + BK) e + w`` keeps the whole correlation in time.
    """
    group = factors.group
    shape = (*group.initial.shape[:2], size)
    normals, state, turned = np.empty(shape), np.empty(shape), np.empty(shape)
    rng.standard_normal(out=normals)
    _scaled(factors.initial, normals, state)
    yield state
    for _ in range(horizon):
        rng.standard_normal(out=normals)
        np.matmul(group.transitions, state, out=turned)
        _scaled(factors.disturbance, normals, state)
        state += turned
        yield state


def _scaled(factor: Tensor, normals: Tensor, out: Matrix) -> None:
    """Apply a factor to standard normals."""
    if factor.shape[2] == 1:
        np.multiply(factor, normals, out=out)
    else:
        np.matmul(factor, normals, out=out)
