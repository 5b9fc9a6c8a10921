"""The curves of a picture, as points. No matplotlib."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from radmpc.arrays import Matrix, Vector
from radmpc.model.plan import Trajectory
from radmpc.model.vehicle import Vehicle

__all__ = [
    "ABOVE",
    "SIDE",
    "Plane",
    "confidence_ellipses",
    "ellipsoid_rings",
    "mean_path",
    "point_along",
    "positions",
    "stays",
]

Plane = tuple[int, int]
"""The two coordinates that a flat picture shows; the others are looked along."""

ABOVE: Plane = (0, 1)
SIDE: Plane = (0, 2)

_POINTS_PER_STEP = 10
"""Points that a curved path is drawn with per step."""

_POINTS_PER_RING = 48
"""Points that an ellipse is drawn with."""


def positions(vehicle: Vehicle, trajectory: Trajectory) -> Matrix:
    """Return the mean positions at the steps, (T+1, d) [m].

    Parameters
    ----------
    vehicle : Vehicle
        Whose dynamics.
    trajectory : Trajectory
        Its part of the plan.
    """
    return trajectory.means[:, list(vehicle.system.position)]


def stays(vehicle: Vehicle, trajectory: Trajectory) -> bool:
    """Whether a vehicle moves by no more than its radius along any axis.

    Parameters
    ----------
    vehicle : Vehicle
        The vehicle.
    trajectory : Trajectory
        Its part of the plan.
    """
    return bool(np.ptp(positions(vehicle, trajectory), axis=0).max() <= vehicle.radius)


def mean_path(vehicle: Vehicle, trajectory: Trajectory) -> Matrix:
    """Return the mean path with the points between steps.

    Double integrators fly the parabola of constant acceleration, all others count as flying
    straight from step to step.

    Parameters
    ----------
    vehicle : Vehicle
        Whose dynamics.
    trajectory : Trajectory
        Its means and controls.

    Returns
    -------
    (p, d) array
        Points in order [m].
    """
    at_steps = positions(vehicle, trajectory)
    system = vehicle.system
    if not system.is_double_integrator:
        return at_steps
    share = np.linspace(0.0, 1.0, _POINTS_PER_STEP, endpoint=False)[:, None]
    hanging = trajectory.controls @ system.sagitta.T
    pieces = [
        before + share * (after - before) - 4.0 * share * (1.0 - share) * sagitta
        for (before, after), sagitta in zip(pairwise(at_steps), hanging, strict=True)
    ]
    return np.vstack([*pieces, at_steps[-1:]])


def confidence_ellipses(
    vehicle: Vehicle, trajectory: Trajectory, sigmas: float = 3.0, plane: Plane = ABOVE
) -> tuple[Matrix, ...]:
    """Return the outline of the position's confidence ellipse at every step, each (p, 2) [m].

    In space it is the outline of the ellipsoid as it is seen along the third coordinate.

    Parameters
    ----------
    vehicle : Vehicle
        Whose dynamics.
    trajectory : Trajectory
        Its part of the plan.
    sigmas : float
        Half axes [standard deviations].
    plane : (int, int)
        The two coordinates that are drawn.
    """
    angles = np.linspace(0.0, 2.0 * np.pi, _POINTS_PER_RING, endpoint=False)
    circle = np.stack([np.cos(angles), np.sin(angles)])
    roots = _roots(vehicle, trajectory, plane)
    centers = positions(vehicle, trajectory)[:, list(plane)]
    return tuple(
        center + sigmas * (root @ circle).T for center, root in zip(centers, roots, strict=True)
    )


def ellipsoid_rings(
    vehicle: Vehicle, trajectory: Trajectory, sigmas: float = 3.0
) -> tuple[Matrix, ...]:
    """Return the three principal rings of the confidence ellipsoid at every step [m].

    Parameters
    ----------
    vehicle : Vehicle
        Whose dynamics, in space.
    trajectory : Trajectory
        Its part of the plan.
    sigmas : float
        Half axes [standard deviations].
    """
    angles = np.linspace(0.0, 2.0 * np.pi, _POINTS_PER_RING)
    circle = np.stack([np.cos(angles), np.sin(angles)])
    roots = _roots(vehicle, trajectory, (0, 1, 2))
    return tuple(
        center + sigmas * (root[:, list(plane)] @ circle).T
        for center, root in zip(positions(vehicle, trajectory), roots, strict=True)
        for plane in ((0, 1), (1, 2), (0, 2))
    )


def point_along(path: Matrix, share: float) -> tuple[Vector, Vector] | None:
    """Return the point at a share of the path's length and the direction there.

    Parameters
    ----------
    path : (p, d) array
        Points of a path [m].
    share : float
        Share of its length, from 0 to 1.

    Returns
    -------
    tuple or None
        Point and unit direction; None for a path that does not move.
    """
    pieces = np.diff(path, axis=0)
    lengths = np.linalg.norm(pieces, axis=1)
    total = float(lengths.sum())
    if total < 1e-9:
        return None
    ends = np.cumsum(lengths)
    i = min(int(np.searchsorted(ends, share * total)), len(lengths) - 1)
    # A piece may be a standstill: searchsorted never stops at one unless share is 0.
    direction = pieces[i] / max(float(lengths[i]), 1e-12)
    point = path[i] + direction * (share * total - (ends[i] - lengths[i]))
    return point, direction


def _roots(vehicle: Vehicle, trajectory: Trajectory, coordinates: tuple[int, ...]) -> Matrix:
    """Return square roots of the position covariances, principal axes as columns, (T+1, c, c)."""
    axes = [vehicle.system.position[i] for i in coordinates]
    covariances = trajectory.covariances[:, axes][:, :, axes]
    values, vectors = np.linalg.eigh(covariances)
    return np.asarray(vectors * np.sqrt(np.maximum(values, 0.0))[:, None, :])
