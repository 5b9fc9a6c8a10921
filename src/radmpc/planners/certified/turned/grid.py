"""A grid of points over everything that stands, and how far each is from obstacles."""

from __future__ import annotations

import itertools
import math

import numpy as np

from radmpc.arrays import Indices, Matrix, Tensor, Vector
from radmpc.program.hazards import Hazards
from radmpc.records import dataclass

__all__ = ["COARSE", "FREE", "Grid", "finest"]

_POINTS = {2: 80, 3: 26}
"""Points of the grid along its longest axis, by dimension [-]: 100 boxes take 10 ms to lay out."""

_MOST_POINTS = {2: 700_000, 3: 150_000}
"""Points of a grid as fine as hulls are at most, by dimension [-]: in the plane they take 140 MB
and 0.6 s, and 0.4 s for each route over all of them; in space 130 MB and 0.3 s."""

COARSE = 1.5
"""Spacing of a grid up to which it tells corners and doors apart [radii of the smallest]."""

_THINNED = np.array([0.1, 0.3, 0.7])
"""Distances of planes beside each other that are tried, one after the other [radii]."""

_BORDER = 3.0
"""Width of the border around starts, goals and obstacles [radii]."""

_BESIDE = 3
"""Points on each side among which the nearest one is looked for first [-]."""

_TINY = 1e-9
"""Least spacing of any grid [m]."""

_PLANE = 2
"""Dimension in which corners are looked at."""

_RIGHT = 1e-6
"""Cosine up to which a corner counts as a right angle [-]."""

FREE = 3.0
"""Standard deviations from an obstacle from which on a route counts as free [-]."""


@dataclass(frozen=True, slots=True, eq=False)
class Grid:
    """Points spread evenly, and how far each is from the nearest obstacle.

    Attributes
    ----------
    points : (p, d) array
        The points [m].
    shape : tuple of int
        Number of points along each axis.
    spacing : float
        Their distance along an axis [m].
    distances : (p,) array
        Largest distance of a face of the nearest obstacle, negative inside; inf far away [m].
    axes : tuple of arrays or None
        Their coordinates along each axis where they are spread unevenly [m]; the spacing is the
        radius of the smallest hull then.
    """

    points: Matrix
    shape: tuple[int, ...]
    spacing: float
    distances: Vector
    axes: tuple[Vector, ...] | None = None

    @classmethod
    def of(cls, hazards: Hazards, count: int | None = None) -> Grid:
        """Lay out a grid over everything that stands, from starts to goals.

        Parameters
        ----------
        hazards : Hazards
            The fleet.
        count : int or None
            Points along the longest axis, distances past corners exact in the plane; None for the
            usual number, and distances of faces alone.
        """
        d, (lower, upper) = hazards.dimension, _extent(hazards)
        spacing = float((upper - lower).max()) / (count or _POINTS[d])
        axes = tuple(np.arange(lower[a], upper[a] + 1e-9, spacing) for a in range(d))
        mesh, distances = _laid_out(hazards, axes, spacing, is_exact=count is not None)
        return cls(mesh.reshape(-1, d), distances.shape, spacing, distances.ravel())

    @classmethod
    def beside_faces(cls, hazards: Hazards, clearance: float) -> Grid | None:
        """Lay out a grid whose planes are beside obstacles and amid the gaps between them.

        Large halls are told apart from their windows with few points.

        Parameters
        ----------
        hazards : Hazards
            The fleet.
        clearance : float
            Standard deviations that planes keep from obstacles, beside the largest radius [-].

        Returns
        -------
        Grid or None
            None where it would have too many points.
        """
        radius, d = max(float(hazards.radii.min()), _TINY), hazards.dimension
        lower, upper = _extent(hazards)
        fill = float((upper - lower).max()) / _POINTS[d]
        for apart in radius * _THINNED:
            axes = tuple(
                _filled(_thinned(_planes(hazards, a, clearance), apart), lower[a], upper[a], fill)
                for a in range(d)
            )
            if math.prod(axis.size for axis in axes) <= _MOST_POINTS[d]:
                mesh, distances = _laid_out(hazards, axes, fill, is_exact=True)
                return cls(mesh.reshape(-1, d), distances.shape, radius, distances.ravel(), axes)
        return None

    def edges(self, one: Indices, two: Indices, step: Indices) -> Vector:
        """Return how far points are from their neighbors, (e,) [m].

        Parameters
        ----------
        one, two : (e,) int array
            The points and their neighbors.
        step : (d,) int array
            How many points these are farther along each axis.
        """
        if self.axes is None:
            return np.full(len(one), self.spacing * float(np.linalg.norm(step)))
        return np.asarray(np.linalg.norm(self.points[one] - self.points[two], axis=1))

    def nearest(self, place: Vector, open_points: np.ndarray) -> int:
        """Return the number of the open point next to a place; -1 where none is open.

        Parameters
        ----------
        place : (d,) array
            Anywhere [m].
        open_points : (p,) bool array
            Which points may be taken.
        """
        every = np.arange(len(self.points))
        if self.axes is not None:
            return self._nearest_of(place, every[open_points])
        at = np.floor((place - self.points[0]) / self.spacing).astype(np.int64)
        beside = tuple(slice(max(k - _BESIDE, 0), max(k + _BESIDE + 2, 0)) for k in at.tolist())
        for numbers, reach in (
            (every.reshape(self.shape)[beside].ravel(), _BESIDE * self.spacing),
            (every, np.inf),
        ):
            is_open = numbers[open_points[numbers]]
            away = np.linalg.norm(self.points[is_open] - place, axis=1)
            if is_open.size and float(away.min()) < reach:
                return int(is_open[away.argmin()])
        return -1

    def _nearest_of(self, place: Vector, numbers: Indices) -> int:
        """Return that of several points which is next to a place; -1 of none."""
        if not numbers.size:
            return -1
        away = np.linalg.norm(self.points[numbers] - place, axis=1)
        return int(numbers[away.argmin()])


def _laid_out(
    hazards: Hazards, axes: tuple[Vector, ...], spacing: float, *, is_exact: bool
) -> tuple[Tensor, Tensor]:
    """Return the points between coordinates along each axis, and how far each is from obstacles."""
    shapes = hazards.shapes
    mesh = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)
    distances = np.full(mesh.shape[:-1], np.inf)
    spread = float(np.sqrt(hazards.variances.max(initial=0.0)))
    far = float(hazards.radii.max()) + FREE * spread + spacing
    for piece in _standing(hazards):
        near = shapes.lower[piece, 0] - far, shapes.upper[piece, 0] + far
        part = tuple(
            slice(*np.searchsorted(axis, (near[0][a], near[1][a]))) for a, axis in enumerate(axes)
        )
        faces = shapes.faces[piece, 0]
        faces = faces[faces.any(axis=1)]
        offsets = (faces @ shapes.vertices[piece, 0].T).max(axis=1)
        outside = (mesh[part] @ faces.T - offsets).max(axis=-1)
        if is_exact or _is_sharp(faces, shapes.vertices[piece, 0]):
            outside = np.maximum(outside, _from_corners(mesh[part], shapes.vertices[piece, 0]))
        distances[part] = np.minimum(distances[part], outside)
    return mesh, distances


def _planes(hazards: Hazards, axis: int, clearance: float) -> Vector:
    """Return where planes stand across an axis: on faces, beside them, and amid gaps [m]."""
    standing, radii = _standing(hazards), hazards.radii
    lower = np.unique(hazards.shapes.lower[standing, 0, axis])
    upper = np.unique(hazards.shapes.upper[standing, 0, axis])
    spread = float(np.sqrt(hazards.variances.max(initial=0.0) / hazards.dimension))
    beside = float(radii.max()) + clearance * spread
    gaps = lower[None, :] - upper[:, None]
    above, below = np.nonzero((gaps >= 2.0 * float(radii.min())) & (gaps <= 2.0 * beside))
    amid = 0.5 * (upper[above] + lower[below])
    return np.unique(np.concatenate([amid, lower, upper, lower - beside, upper + beside]))


def _thinned(planes: Vector, apart: float) -> Vector:
    """Return planes that are some distance apart, of those nearer to each other the first [m]."""
    kept: list[float] = []
    for plane in planes.tolist():
        if not kept or plane >= kept[-1] + apart:
            kept.append(plane)
    return np.array(kept)


def _filled(planes: Vector, lower: float, upper: float, fill: float) -> Vector:
    """Return the planes between two ends, and these, with others where they are far apart [m]."""
    inner = planes[(planes > lower + _TINY) & (planes < upper - _TINY)]
    every = np.concatenate([[lower], inner, [upper]])
    parts = [
        np.linspace(a, b, math.ceil((b - a) / fill) + 1)[:-1]
        for a, b in itertools.pairwise(every.tolist())
    ]
    return np.concatenate([*parts, [upper]])


def finest(hazards: Hazards) -> tuple[int, float]:
    """Return points along the longest axis of a grid as fine as hulls, or as may be; and spacing.

    Parameters
    ----------
    hazards : Hazards
        The fleet.

    Returns
    -------
    int
        For `Grid.of` [-].
    float
        Distance of the points [m].
    """
    lower, upper = _extent(hazards)
    sides, d = upper - lower, hazards.dimension
    least = float(sides.prod() / _MOST_POINTS[d]) ** (1.0 / d)
    spacing = max(float(hazards.radii.min()), least, _TINY)
    return math.ceil(float(sides.max()) / spacing), spacing


def _standing(hazards: Hazards) -> Indices:
    """Return the numbers of the obstacles' pieces that stand."""
    vertices = hazards.shapes.vertices
    return np.flatnonzero((vertices == vertices[:, :1]).all(axis=(1, 2, 3)))


def _extent(hazards: Hazards) -> tuple[Vector, Vector]:
    """Return the corners of the box around everything that stands, from starts to goals."""
    corners = [hazards.shapes.vertices[_standing(hazards), 0].reshape(-1, hazards.dimension)]
    for model in hazards.models:
        goal = model.vehicle.goal
        corners.append(np.array([model.drift_position[0], goal.lower, goal.upper]))
    every = np.concatenate(corners)
    border = _BORDER * float(hazards.radii.max())
    lower, upper = every.min(axis=0) - border, every.max(axis=0) + border
    if hazards.workspace is not None:
        lower = np.maximum(lower, hazards.workspace[0])
        upper = np.minimum(upper, hazards.workspace[1])
    return lower, upper


def _is_sharp(faces: Matrix, corners: Matrix) -> bool:
    """Whether two faces in the plane meet at less than a right angle.

    Past such a corner the distance of faces may be any small part of that of the corner.
    """
    if corners.shape[1] != _PLANE:
        return False
    normals = faces[np.argsort(np.arctan2(faces[:, 1], faces[:, 0]))]
    turns = np.einsum("fd,fd->f", normals, np.roll(normals, -1, axis=0))
    return bool(turns.min(initial=1.0) < -_RIGHT)


def _from_corners(points: Tensor, corners: Matrix) -> Tensor:
    """Return the largest distance of points from a shape along directions from its corners [m]."""
    best = np.full(points.shape[:-1], -np.inf)
    for corner in corners:
        away = points - corner
        length = np.linalg.norm(away, axis=-1)
        reach = (away @ corners.T).max(axis=-1)
        along = np.einsum("...d,...d->...", away, points) - reach
        best = np.maximum(
            best, np.where(length > 0.0, along / np.where(length > 0.0, length, 1.0), 0.0)
        )
    return best
