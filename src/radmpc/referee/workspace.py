"""Probability of leaving the workspace, face by face."""

from __future__ import annotations

import numpy as np

from radmpc.arrays import Vector
from radmpc.model.scenario import Workspace
from radmpc.referee.halfspace import Sites, end_risks
from radmpc.referee.motion import FleetMotion

__all__ = ["workspace_risks"]


def workspace_risks(workspace: Workspace, motion: FleetMotion, *, intervals: bool) -> Vector:
    """Return an upper bound on the probability that each center is outside, step by step.

    The box is convex: a chord whose ends keep the bow of the mean curve in reserve stays inside.
    A step between two intervals keeps the larger of their reserves, and is charged once.

    Parameters
    ----------
    workspace : Workspace
        The box.
    motion : FleetMotion
        Where the vehicles are.
    intervals : bool
        Whether the path between the steps counts.

    Returns
    -------
    (N, T+1) array
        Summed over faces.
    """
    count, steps, d = motion.positions.shape
    risks = np.zeros((count, steps))
    bows = np.zeros((count, steps + 1, d))
    if intervals:
        bows[:, 1:-1] = motion.bows
    for axis in range(d):
        # Staying above `lower` along n = +axis, below `upper` along n = -axis.
        for sign, face in ((1.0, workspace.lower), (-1.0, -workspace.upper)):
            normal = np.zeros((count * steps, 1, d))
            normal[:, 0, axis] = sign
            sag = np.maximum(bows[:, :-1] * sign, bows[:, 1:] * sign).clip(min=0.0)
            sites = Sites(
                means=motion.positions.reshape(-1, 1, d),
                covariances=motion.position_covariances.reshape(-1, 1, d, d),
                bows=sign * sag.reshape(-1, d),
                radii=np.zeros(count * steps),
                vertices=np.broadcast_to(sign * face, (count * steps, 1, 1, d)),
                edges=np.zeros((count * steps, 1, 0, 2, d)),
            )
            risks += end_risks(sites, normal)[:, 0, 0].reshape(count, steps)
    return risks
