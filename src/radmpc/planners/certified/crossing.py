"""Which sets get into each other's way: a quick estimate that proposes, the referee decides."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.spatial import cKDTree

from radmpc.arrays import Indices, Tensor
from radmpc.gaussian import tail_probability
from radmpc.model.scenario import Scenario

__all__ = ["cross_risks"]

_FAR = 8.0
"""Standard deviations beyond which a pair's risk is nothing (6e-16)."""


def cross_risks(
    scenario: Scenario, means: Tensor, covariances: Tensor, owners: Indices
) -> dict[tuple[int, int], float]:
    """Estimate the collision risk of every two sets.

    At steps it is the bound of the half-space between the two means; between steps the same at
    the closest point of the straight relative motion, counted twice.

    Parameters
    ----------
    scenario : Scenario
        The fleet.
    means : (N, T+1, d) array
        Mean positions [m].
    covariances : (N, T+1, d, d) array
        Position covariances [m²].
    owners : (N,) int array
        The set of each vehicle.

    Returns
    -------
    dict
        Risk of the pairs of sets, lower number first, that run any.
    """
    radii = np.array([v.radius for v in scenario.vehicles])
    one, two = _neighbors(scenario, means, covariances, radii)
    apart = owners[one] != owners[two]
    one, two = one[apart], two[apart]
    if one.size == 0:
        return {}
    start, relative = means[one] - means[two], covariances[one] + covariances[two]
    if scenario.avoidance == "intervals":
        start = _closest(start)
        relative = np.maximum(relative[:, :-1], relative[:, 1:])
        weight = 2.0
    else:
        start, relative, weight = start[:, 1:], relative[:, 1:], 1.0
    distance = np.linalg.norm(start, axis=2)
    along = start / np.maximum(distance, 1e-12)[:, :, None]
    deviation = np.sqrt(np.maximum(np.einsum("pka,pkab,pkb->pk", along, relative, along), 1e-24))
    clearance = (distance - (radii[one] + radii[two])[:, None]) / deviation
    risks = weight * np.asarray(tail_probability(clearance)).sum(axis=1)
    found: dict[tuple[int, int], float] = {}
    for i, j, risk in zip(owners[one].tolist(), owners[two].tolist(), risks.tolist(), strict=True):
        if risk > 1e-15:
            key = (min(i, j), max(i, j))
            found[key] = found.get(key, 0.0) + risk
    return found


def _closest(relative: Tensor) -> Tensor:
    """Return the point nearest to the origin on each chord, (p, T, d)."""
    start, step = relative[:, :-1], np.diff(relative, axis=1)
    length = np.maximum(np.einsum("pka,pka->pk", step, step), 1e-24)
    share = np.clip(-np.einsum("pka,pka->pk", start, step) / length, 0.0, 1.0)
    return np.asarray(start + share[:, :, None] * step)


def _neighbors(
    scenario: Scenario, means: Tensor, covariances: Tensor, radii: np.ndarray
) -> tuple[Indices, Indices]:
    """Return the pairs of vehicles that come near each other at any step."""
    steps = np.linalg.norm(np.diff(means, axis=1), axis=2).max(initial=0.0)
    path = float(steps) if scenario.avoidance == "intervals" else 0.0
    found: set[tuple[int, int]] = set()
    for k in range(means.shape[1]):
        spread = float(np.sqrt(np.linalg.eigvalsh(covariances[:, k])[:, -1].max()))
        near = 2.0 * radii.max() + _FAR * np.sqrt(2.0) * spread + path
        found |= cKDTree(means[:, k]).query_pairs(near)
    pairs = np.array(sorted(found), dtype=np.int64).reshape(-1, 2)
    return pairs[:, 0], pairs[:, 1]
