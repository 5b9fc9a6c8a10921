"""Temporal obstacles: where a vehicle's plan will have it, step by step (paper, same section)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from radmpc.arrays import Matrix, Tensor, Vector
from radmpc.geometry import Polytope, box, hull
from radmpc.model.vehicle import Vehicle

__all__ = ["TemporalObstacle", "make_temporal_obstacle", "standing_obstacle"]

_SIGMAS = 3.0


@dataclass(frozen=True, slots=True, eq=False)
class TemporalObstacle:
    """One convex piece per absolute step, not yet grown by whoever avoids it.

    Attributes
    ----------
    name : str
        The vehicle it stands for.
    first_step : int
        Absolute step of the first piece.
    pieces : tuple of Polytope
        Up to the horizon.
    """

    name: str
    first_step: int
    pieces: tuple[Polytope, ...]

    def at(self, step: int) -> Polytope:
        """Return the piece at an absolute step; it also covers the way to the next one."""
        return self.pieces[step - self.first_step]


def make_temporal_obstacle(
    vehicle: Vehicle, means: Matrix, covariances: Tensor, first_step: int
) -> TemporalObstacle:
    """Bound a plan's 3σ regions (paper, section Temporal Obstacles).

    Parameters
    ----------
    vehicle : Vehicle
        Whose plan.
    means : (s+1, n) array
        Mean states from ``first_step`` to the horizon.
    covariances : (s+1, n, n) array
        State covariances at these steps.
    first_step : int
        Absolute step of the first entry.

    Returns
    -------
    TemporalObstacle
        The hull of the squares at k and k+1; a square alone at k = 0, at the horizon and where
        the vehicle is in its goal.
    """
    axes = list(vehicle.system.position)
    positions = means[:, axes]
    halves = _half_sides(vehicle, covariances)
    speeds = None if vehicle.system.velocity is None else means[:, list(vehicle.system.velocity)]
    pieces = []
    last = len(positions) - 1
    for i, position in enumerate(positions):
        arrived = vehicle.goal.contains(position, None if speeds is None else speeds[i])
        if i == last or arrived or first_step + i == 0:
            pieces.append(box(position - halves[i], position + halves[i]))
        else:
            corners = np.concatenate(
                [_corners(position, halves[i]), _corners(positions[i + 1], halves[i + 1])]
            )
            pieces.append(hull(corners))
    return TemporalObstacle(vehicle.name, first_step, tuple(pieces))


def standing_obstacle(vehicle: Vehicle, covariances: Tensor) -> TemporalObstacle:
    """Return the square around a vehicle that has no plan yet: at its start, for all steps."""
    half = _half_sides(vehicle, covariances[:1])[0]
    square = box(vehicle.start_position - half, vehicle.start_position + half)
    return TemporalObstacle(vehicle.name, 0, (square,) * len(covariances))


def _half_sides(vehicle: Vehicle, covariances: Tensor) -> Vector:
    """Return ``3 √λmax(Σ_position) + radius`` of each step [m]."""
    axes = list(vehicle.system.position)
    largest = np.linalg.eigvalsh(covariances[:, axes, :][:, :, axes])[:, -1]
    return np.asarray(_SIGMAS * np.sqrt(np.maximum(largest, 0.0)) + vehicle.radius)


def _corners(center: Vector, half: float) -> Matrix:
    """Return the corners of a square or cube."""
    signs = np.array(np.meshgrid(*[[-1.0, 1.0]] * center.size)).reshape(center.size, -1).T
    return np.asarray(center + half * signs)
