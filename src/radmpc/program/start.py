"""Risk between vehicles that is there before anyone moves."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.spatial import cKDTree

from radmpc.arrays import Tensor
from radmpc.gaussian import tail_probability
from radmpc.geometry import sphere_directions
from radmpc.model.scenario import Scenario

__all__ = ["start_pair_risk"]

_FAR = 8.0
"""Standard deviations beyond which a pair's start risk is nothing (6e-16)."""


def start_pair_risk(scenario: Scenario, covariances: Sequence[Tensor]) -> float:
    """Return the sum over pairs of the least face risk at k = 0.

    Parameters
    ----------
    scenario : Scenario
        The fleet.
    covariances : sequence of (T+1, n, n) array
        State covariances of every vehicle.

    Returns
    -------
    float
        At most what the programme of the whole fleet charges for its pairs at k = 0.
    """
    positions = np.array([v.start_position for v in scenario.vehicles])
    noises = []
    for vehicle, covariance in zip(scenario.vehicles, covariances, strict=True):
        axes = list(vehicle.system.position)
        noises.append(covariance[0][axes][:, axes])
    radii = np.array([v.radius for v in scenario.vehicles])
    widest = max(float(np.linalg.eigvalsh(noise)[-1]) for noise in noises)
    # Along its best face a pair is at least this share of its distance apart.
    share = np.sqrt(scenario.dimension)
    near = share * (2.0 * radii.max() + _FAR * np.sqrt(2.0 * max(widest, 0.0)) + 1e-9)
    faces = sphere_directions(scenario.num_pair_faces, scenario.dimension)
    total = 0.0
    for i, j in sorted(cKDTree(positions).query_pairs(float(near))):
        slack = faces @ (positions[i] - positions[j]) - radii[i] - radii[j]
        variances = np.einsum("fa,ab,fb->f", faces, noises[i] + noises[j], faces)
        deviations = np.sqrt(np.maximum(variances, 0.0))
        noisy = deviations > 0.0
        certain = np.where(slack >= -1e-9, np.inf, -np.inf)
        clearances = np.where(noisy, slack / np.where(noisy, deviations, 1.0), certain)
        total += float(tail_probability(clearances).min())
    return total
