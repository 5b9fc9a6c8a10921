"""Positions of vehicles and obstacles between steps. No matplotlib."""

from __future__ import annotations

import numpy as np

from radmpc.arrays import Matrix, Tensor
from radmpc.geometry import hull
from radmpc.model.obstacle import Obstacle
from radmpc.model.plan import Trajectory
from radmpc.model.vehicle import Vehicle
from radmpc.plotting.curves import mean_path, positions
from radmpc.records import dataclass

__all__ = ["InterpolatedPath", "interpolated_path", "moving_outline"]


@dataclass(frozen=True, slots=True, eq=False)
class InterpolatedPath:
    """A vehicle's mean path and spread, frame by frame.

    Attributes
    ----------
    positions : (f, d) array
        Mean position at each frame [m].
    roots : (f, d, d) array
        Square root of the position covariance at each frame, principal axes as columns [m].
    boxes : tuple of ((c, d) array, ...)
        Corners of the temporal obstacle of each step 0..T [m] (paper, section Temporal
        Obstacles): the hull of the squares around the means at k and k+1, with three standard
        deviations along the longest axis plus the radius as half-side, and of those along the
        curve between where intervals count; at T the square alone.
    """

    positions: Matrix
    roots: Tensor
    boxes: tuple[Matrix, ...]


def interpolated_path(
    vehicle: Vehicle, trajectory: Trajectory, per_step: int, *, intervals: bool = True
) -> InterpolatedPath:
    """Return a vehicle's path at ``per_step`` frames per step, and the last one.

    Parameters
    ----------
    vehicle : Vehicle
        The vehicle.
    trajectory : Trajectory
        Its part of a plan.
    per_step : int
        Frames per step.
    intervals : bool
        Whether the path between steps counts.

    Returns
    -------
    InterpolatedPath
        Covariances are interpolated between steps.
    """
    axes = list(vehicle.system.position)
    at_steps = positions(vehicle, trajectory)
    steps = len(at_steps) - 1
    path = mean_path(vehicle, trajectory)
    frames = np.linspace(0.0, 1.0, steps * per_step + 1)
    drawn = np.linspace(0.0, 1.0, len(path))
    means = np.column_stack([np.interp(frames, drawn, column) for column in path.T])
    coarse = trajectory.covariances[:, axes][:, :, axes]
    share = frames * steps
    low = np.minimum(share.astype(int), steps - 1)
    part = (share - low)[:, None, None]
    values, vectors = np.linalg.eigh((1.0 - part) * coarse[low] + part * coarse[low + 1])
    roots = vectors * np.sqrt(np.maximum(values, 0.0))[:, None, :]
    largest = np.sqrt(np.maximum(np.linalg.eigvalsh(coarse)[:, -1], 0.0))
    halves = 3.0 * largest + vehicle.radius
    cube = np.array(np.meshgrid(*[[-1.0, 1.0]] * len(axes))).reshape(len(axes), -1).T
    along = path if intervals else at_steps
    spaced = (len(along) - 1) // steps
    sides = np.interp(np.linspace(0.0, steps, len(along)), np.arange(steps + 1), halves)
    squares = along[:, None, :] + sides[:, None, None] * cube
    boxes = tuple(
        hull(np.vstack(squares[k * spaced : (k + 1) * spaced + 1])).vertices
        for k in range(steps + 1)
    )
    return InterpolatedPath(means, np.asarray(roots), boxes)


def moving_outline(obstacle: Obstacle, time: float) -> Matrix:
    """Return the corners of a moving obstacle at a moment, counted in steps, (c, d) [m].

    Between steps it is the Minkowski interpolation of its outlines, as the certificate has it.

    Parameters
    ----------
    obstacle : Obstacle
        With one convex outline per step.
    time : float
        Time since the start [steps].
    """
    last = len(obstacle.steps) - 1
    before = min(int(time), last)
    here, ahead = (obstacle.steps[min(k, last)][0].vertices for k in (before, before + 1))
    share = min(max(time - before, 0.0), 1.0)
    between = (1.0 - share) * here[:, None, :] + share * ahead[None, :, :]
    return hull(between.reshape(-1, here.shape[1])).vertices
