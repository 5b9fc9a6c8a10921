"""Random obstacles of every kind: thick, thin, without thickness, moving and turning."""

from __future__ import annotations

import numpy as np

from radmpc.arrays import Matrix, Vector
from radmpc.geometry import hull
from radmpc.model.obstacle import Obstacle

__all__ = ["random_obstacle"]

_THIN = (0.0, 1e-9, 1e-6, 1e-3, 0.05)
"""Half thickness of walls [m]."""


def random_obstacle(
    rng: np.random.Generator,
    name: str,
    place: Vector,
    horizon: int,
    beside: tuple[Vector, float] | None = None,
) -> Obstacle:
    """Return an obstacle.

    Parameters
    ----------
    rng : Generator
        Decides everything.
    name : str
        For the obstacle.
    place : (d,) array
        Its middle [m]; with `beside`, what it stands beside.
    horizon : int
        Number of steps T.
    beside : pair of (d,) array and float, optional
        Unit direction from the place to the obstacle, and how far away that begins [m].

    Returns
    -------
    Obstacle
        Of a random kind; one in four moves.
    """
    points = _points(rng, place.size)
    if beside is not None:
        # Its nearest corner or face toward the place is put at the distance.
        away, distance = beside
        place = place + (distance - float((points @ away).min())) * away
    points = points + place
    kind = rng.random()
    if kind < 0.25:
        return Obstacle.moving(name, _course(rng, points, place, horizon))
    if kind < 0.45:
        piece = hull(points)
        scale = rng.uniform(0.5, 3.0)
        return Obstacle.halfspaces(name, scale * piece.normals, scale * piece.offsets)
    if kind < 0.65:
        return Obstacle.box(name, points.min(axis=0), points.max(axis=0))
    if kind < 0.72:
        return Obstacle.line(name, points)
    if place.size == 2 and kind < 0.8:
        hook = [[-1, -1], [1, -1], [1, 1], [0.6, 1], [0.6, -0.6], [-1, -0.6]]
        return Obstacle.polygon(name, place + 0.5 * np.array(hook))
    return Obstacle.polygon(name, hull(points).vertices)


def _points(rng: np.random.Generator, dimension: int) -> Matrix:
    """Return corners about the origin: of a box, thick or thin, straight or turned, or any."""
    half = rng.uniform(0.1, 0.8, dimension)
    kind = rng.random()
    if kind < 0.2:
        return np.asarray(rng.normal(0.0, 0.4, (dimension + 1 + int(rng.integers(3)), dimension)))
    if kind < 0.65:
        half[rng.permutation(dimension)[: int(rng.integers(1, dimension))]] = rng.choice(_THIN)
    grid = np.meshgrid(*[[-1.0, 1.0]] * dimension, indexing="ij")
    corners = np.stack([axis.ravel() for axis in grid], axis=1) * half
    if rng.random() < 0.3:
        return np.asarray(corners @ _turn(float(rng.uniform(0.0, np.pi)), dimension).T)
    return corners


def _turn(angle: float, dimension: int) -> Matrix:
    """Return a turn by an angle [rad] in the plane of the first two axes."""
    matrix = np.eye(dimension)
    cos, sin = np.cos(angle), np.sin(angle)
    matrix[:2, :2] = [[cos, -sin], [sin, cos]]
    return matrix


def _course(rng: np.random.Generator, points: Matrix, center: Vector, horizon: int) -> list[Matrix]:
    """Return where corners are at every step: carried along, and half of the time turned."""
    drift = rng.uniform(-0.4, 0.4, center.size)
    rate = float(rng.uniform(-0.8, 0.8)) if rng.random() < 0.5 else 0.0
    return [
        center + (points - center) @ _turn(k * rate, center.size).T + k * drift
        for k in range(horizon + 1)
    ]
