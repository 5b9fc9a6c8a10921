"""Probability of leaving the workspace, face by face."""

from __future__ import annotations

import numpy as np

from radmpc.arrays import Matrix, Vector
from radmpc.model.scenario import Workspace
from radmpc.referee.bound.halfspace import end_risks
from radmpc.referee.bound.parts import NUM_PARTS, part_sites
from radmpc.referee.bound.persistence import path_charges
from radmpc.referee.encounters import Encounters, instant_sites, interval_sites
from radmpc.referee.motion import FleetMotion

__all__ = ["WORTH", "face_risks", "faces_of", "workspace_risks"]

WORTH = 1e-13
"""Sum of a vehicle at a face below which its intervals are not looked at in parts [-]."""


def faces_of(workspace: Workspace, motion: FleetMotion) -> list[tuple[Matrix, Encounters]]:
    """Return every vehicle's center against every face of the box.

    The box is convex: each face is a half-space to stay in, whatever the others do.

    Parameters
    ----------
    workspace : Workspace
        The box.
    motion : FleetMotion
        Of the fleet.

    Returns
    -------
    list of ((d,) array, Encounters)
        The unit normal into the box, and all vehicles against the half-space behind the face.
    """
    count, _, d = motion.positions.shape
    everyone, none = np.arange(count), np.zeros(count, dtype=np.int64)
    nobody = none - 1
    faces = []
    for axis in range(d):
        # Staying above `lower` along n = +axis, below `upper` along n = −axis.
        for sign, corner in ((1.0, workspace.lower), (-1.0, workspace.upper)):
            normal = np.zeros(d)
            normal[axis] = sign
            batch = Encounters(
                kind="workspace",
                first=everyone,
                other=none,
                piece=none,
                partner=nobody,
                track=nobody,
                means=motion.positions,
                covariances=motion.position_covariances,
                bent_covariances=motion.bent_covariances if motion.is_bent else None,
                sagittas=motion.sagittas,
                radii=np.zeros(count),
                vertices=np.broadcast_to(corner, (count, 1, 1, d)),
                directions=np.broadcast_to(normal, (count, 1, d)),
                edges=np.zeros((count, 1, 0, 2, d)),
                samples=motion.samples,
            )
            faces.append((normal, batch))
    return faces


def workspace_risks(workspace: Workspace, motion: FleetMotion, *, intervals: bool) -> Vector:
    """Return an upper bound on the probability that each center is outside, step by step.

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
    faces = faces_of(workspace, motion)
    return np.asarray(
        np.sum([face_risks(*face, motion, intervals=intervals) for face in faces], axis=0)
    )


def face_risks(
    normals: Matrix, batch: Encounters, motion: FleetMotion, *, intervals: bool
) -> Vector:
    """Return an upper bound on the probability of being behind a face, step by step.

    Parameters
    ----------
    normals : (d,) or (B, d) array
        Unit normals, away from what is behind: one for all or each its own.
    batch : Encounters
        (Relative) motions against the half-spaces behind faces, B of them.
    motion : FleetMotion
        What they were gathered from.
    intervals : bool
        Whether the path between the steps counts.

    Returns
    -------
    (B, T+1) array
        Risks [-].
    """
    count, steps, d = batch.means.shape
    each = np.broadcast_to(normals, (count, d))
    if not intervals:
        sites = instant_sites(batch)
        along = np.repeat(each, steps, axis=0)[:, None]
        return np.asarray(end_risks(sites, along)[:, 0, 0].reshape(count, steps))
    sites = interval_sites(batch)
    along = np.repeat(each, steps - 1, axis=0)[:, None]
    ends = end_risks(sites, along)[:, 0].reshape(count, steps - 1, -1)
    near = np.flatnonzero(ends.sum(axis=(1, 2)) > WORTH)
    # Far from the face, both ends of every interval are charged as they are.
    found: Vector = np.zeros((count, steps))
    found[:, :-1] = ends[:, :, :-1].sum(axis=2)
    found[:, 1:] += ends[:, :, -1]
    if near.size:
        parts, crossed = part_sites(batch.take(near), motion, NUM_PARTS)
        shape = near.size, NUM_PARTS * (steps - 1), 1, d
        held = np.broadcast_to(each[near, None, None], shape)
        found[near] = path_charges(parts, held, crossed, NUM_PARTS)[:, 0]
    return found
