"""Risk between vehicles at the start, before anyone moves."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from radmpc.arrays import Matrix, Tensor, Vector
from radmpc.gaussian import Tail, clearance
from radmpc.geometry import sphere_directions
from radmpc.model.scenario import Scenario
from radmpc.nearby import near_pairs
from radmpc.program.avoidance import Body
from radmpc.program.openings import best_clearance

__all__ = ["risks_at_start", "start_pair_risk"]

_FAR = 8.0
"""Clearance beyond which a pair's risk at the start is left out [standard deviations]: 6e-16."""


def start_pair_risk(scenario: Scenario, covariances: Sequence[Tensor]) -> float:
    """Return the sum over pairs of the least risk of any half-space at k = 0.

    Parameters
    ----------
    scenario : Scenario
        The fleet.
    covariances : sequence of (T+1, n, n) array
        State covariances of every vehicle.

    Returns
    -------
    float
        At most what the program of the whole fleet charges for its pairs at k = 0.
    """
    positions = np.array([v.start_position for v in scenario.vehicles])
    noises = []
    for vehicle, covariance in zip(scenario.vehicles, covariances, strict=True):
        axes = list(vehicle.system.position)
        noises.append(covariance[0][axes][:, axes])
    radii = np.array([v.radius for v in scenario.vehicles])
    widest = max(float(np.linalg.eigvalsh(noise)[-1]) for noise in noises)
    tail = Tail(scenario.covariance_samples)
    near = 2.0 * radii.max() + tail.beyond(_FAR) * np.sqrt(2.0 * max(widest, 0.0)) + 1e-9
    faces = sphere_directions(scenario.num_pair_faces, scenario.dimension)
    origin = np.zeros((1, scenario.dimension))
    total = 0.0
    for i, j in near_pairs(positions, float(near)).tolist():
        kept, _ = best_clearance(
            positions[i] - positions[j],
            noises[i] + noises[j],
            faces,
            origin,
            float(radii[i] + radii[j]),
        )
        total += float(tail.probability(kept))
    return total


def risks_at_start(body: Body, normals: Tensor, offsets: Matrix, tail: Tail) -> Vector:
    """Return the least risk at k = 0 of any face of each of n things, which no control changes.

    Parameters
    ----------
    body : Body
        What avoids.
    normals : (n, f, d) array
        Of the faces.
    offsets : (n, f) array
        Their right sides: ``normals @ position <= offsets`` [m].
    tail : Tail
        Of what the position deviates by.

    Returns
    -------
    (n,) array
        Probabilities [-].
    """
    slack = offsets - normals @ body.lower[0]
    variances = np.einsum("nfa,ab,nfb->nf", normals, body.covariances[0], normals)
    deviations = np.sqrt(np.maximum(variances, 0.0))
    least: Vector = tail.probability(clearance(slack, deviations)).min(axis=1)
    return least
