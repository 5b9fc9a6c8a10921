"""Other vehicles on their way, as half-planes that a lattice search keeps a vehicle in."""

from __future__ import annotations

import numpy as np

from radmpc.arrays import Indices, Matrix, Tensor, Vector
from radmpc.planners.certified.lattice.half_planes import AvoidanceHalfPlanes
from radmpc.program.hazards import Hazards

__all__ = ["around_others"]

_DIRECTIONS = 8
"""Half-planes around each of them [-]: the lattice is coarser than what more of them would tell."""

_LEAST = 1e-9
"""Standard deviation where there is no noise [m]."""


def around_others(
    hazards: Hazards, vehicle: int, others: Indices, means: Tensor
) -> list[list[AvoidanceHalfPlanes]]:
    """Return what keeps a vehicle out of the way of others, window by window.

    Parameters
    ----------
    hazards : Hazards
        The fleet, in the plane.
    vehicle : int
        Its number.
    others : (n,) int array
        Numbers of those that it is kept apart from.
    means : (N, T+1, 2) array
        Where everyone is at each step [m].

    Returns
    -------
    list of list of AvoidanceHalfPlanes
        Those of each of T windows.
    """
    angles = 2.0 * np.pi * np.arange(_DIRECTIONS) / _DIRECTIONS
    normals = np.column_stack([np.cos(angles), np.sin(angles)])
    # Half of the traces: what both deviate by along an axis, in the mean over both.
    variances = 0.5 * (hazards.variances[vehicle] + hazards.variances[others])
    deviations = np.sqrt(np.maximum(variances, _LEAST**2))
    reaches = hazards.radii[vehicle] + hazards.radii[others]
    anywhere = np.tile([0.0, 0.0, np.inf], (_DIRECTIONS, 1))
    return [
        [
            AvoidanceHalfPlanes(
                _beside(normals, places[k], reach) if hazards.intervals else anywhere,
                _beside(normals, places[k + 1], reach),
                float(spread[k]),
            )
            for places, reach, spread in zip(means[others], reaches, deviations, strict=True)
        ]
        for k in range(means.shape[1] - 1)
    ]


def _beside(normals: Matrix, center: Vector, reach: float) -> Matrix:
    """Return half-planes beside a disc: normal [-] and offset [m] of each."""
    return np.column_stack([-normals, -(normals @ center) - reach])
