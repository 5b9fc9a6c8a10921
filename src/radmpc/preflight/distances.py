"""How far points are from convex pieces and from the workspace's border, and in which direction."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from radmpc.arrays import Indices, Matrix, Vector
from radmpc.geometry import Polytope
from radmpc.model.scenario import Scenario
from radmpc.model.workspace import Workspace

__all__ = ["Nearness", "Surroundings", "distances", "keep_nearer", "nearer"]


@dataclass(frozen=True, slots=True, eq=False)
class Nearness:
    """What is nearest to points.

    Attributes
    ----------
    distances : (c,) array
        Distance of the point from it, negative within [m].
    normals : (c, d) array
        Unit direction away from it [-].
    """

    distances: Vector
    normals: Matrix


@dataclass(frozen=True, slots=True, eq=False)
class Surroundings:
    """All that a vehicle has to keep clear of at a step.

    Attributes
    ----------
    names : tuple of str or None
        The obstacle of each piece; None for the workspace's border.
    pieces : tuple of Polytope or None
        The pieces; None for a face of the border.
    workspace : Workspace or None
        The workspace; the mean stays within.
    radius : float
        Hull radius [m].
    """

    names: tuple[str | None, ...]
    pieces: tuple[Polytope, ...]
    workspace: Workspace | None
    radius: float

    @classmethod
    def of(cls, scenario: Scenario, radius: float, step: int, *, moving: bool) -> Surroundings:
        """Collect what stands still, with the workspace, or what moves.

        Parameters
        ----------
        scenario : Scenario
            The scenario.
        radius : float
            Hull radius [m].
        step : int
            The step, 0 to T.
        moving : bool
            What moves, rather than what stands still.
        """
        found = [
            (o.name, piece)
            for o in scenario.obstacles
            if o.is_moving == moving
            for piece in o.at(step)
        ]
        workspace = None if moving else scenario.workspace
        return cls(tuple(n for n, _ in found), tuple(p for _, p in found), workspace, radius)

    @property
    def is_empty(self) -> bool:
        """Whether there is nothing to keep clear of."""
        return not self.pieces and self.workspace is None

    def slacks(self, points: Matrix) -> list[tuple[str | None, Nearness]]:
        """Return how far a hull at points is from each thing.

        Parameters
        ----------
        points : (c, d) array
            Where the vehicle's center may be [m].

        Returns
        -------
        list of (str or None, Nearness)
            By piece, and by face of the border, whose distance is the center's.
        """
        found: list[tuple[str | None, Nearness]] = []
        for name, piece in zip(self.names, self.pieces, strict=True):
            near = distances(points, piece)
            found.append((name, Nearness(near.distances - self.radius, near.normals)))
        for distance, normal in self._borders(points):
            found.append((None, Nearness(distance, np.broadcast_to(normal, points.shape))))
        return found

    def nearest(self, points: Matrix, far: float = np.inf) -> Nearness:
        """Return how far a hull at points is from the nearest of all.

        Parameters
        ----------
        points : (c, d) array
            Where the vehicle's center may be [m].
        far : float
            Distance of the hull beyond which it does not matter [m]; inf there.
        """
        best = Nearness(np.full(len(points), np.inf), np.zeros_like(points))
        for piece in self.pieces:
            low, high = piece.vertices.min(axis=0), piece.vertices.max(axis=0)
            reach = self.radius + far
            is_close = np.all((points >= low - reach) & (points <= high + reach), axis=1)
            close = np.flatnonzero(is_close)
            near = distances(points[close], piece)
            keep_nearer(best, close, near.distances - self.radius, near.normals)
        for distance, normal in self._borders(points):
            close = np.flatnonzero(distance <= far)
            normals = np.broadcast_to(normal, (len(close), len(normal)))
            keep_nearer(best, close, distance[close], normals)
        return best

    def _borders(self, points: Matrix) -> Iterator[tuple[Vector, Vector]]:
        """Yield the distance of points from each face of the border, and its inner normal."""
        if self.workspace is None:
            return
        for axis, normal in enumerate(np.eye(points.shape[1])):
            yield points[:, axis] - self.workspace.lower[axis], normal
            yield self.workspace.upper[axis] - points[:, axis], -normal


def keep_nearer(
    best: Nearness, places: Indices, slack: Vector, normals: Matrix, *, farther: bool = False
) -> None:
    """Put down what is nearer than all before it, at some of the points.

    Parameters
    ----------
    best : Nearness
        Written to.
    places : (k,) int array
        The points.
    slack : (k,) array
        Distances there [m].
    normals : (k, d) array
        Directions [-].
    farther : bool
        Put down what is farther instead.
    """
    before = best.distances[places]
    is_better = slack > before if farther else slack < before
    chosen = places[is_better]
    best.distances[chosen] = slack[is_better]
    best.normals[chosen] = normals[is_better]


def nearer(one: Nearness, other: Nearness) -> Nearness:
    """Return the nearer of two things, point by point."""
    is_other = other.distances < one.distances
    return Nearness(
        np.where(is_other, other.distances, one.distances),
        np.where(is_other[:, None], other.normals, one.normals),
    )


def distances(points: Matrix, piece: Polytope) -> Nearness:
    """Return the signed distance of points from a convex piece.

    In space exact for boxes, and for other bodies where a face is nearest; where an edge or a
    corner is, the height above a face, which is less.

    Parameters
    ----------
    points : (c, d) array
        Any points [m].
    piece : Polytope
        The piece.

    Returns
    -------
    Nearness
        Within the piece the depth below the nearest face, negative.
    """
    heights = points @ piece.normals.T - piece.offsets
    face = heights.argmax(axis=1)
    depth, normals = heights.max(axis=1), piece.normals[face]
    outside = depth > 0.0
    if points.shape[1] == 2:
        feet = _feet_in_plane(points, piece.vertices)
    elif _is_box(piece):
        feet = np.clip(points, piece.vertices.min(axis=0), piece.vertices.max(axis=0))
    else:
        return Nearness(depth, normals)
    away = points - feet
    lengths = np.sqrt(np.square(away).sum(axis=1))
    directions = away / np.where(lengths > 0.0, lengths, 1.0)[:, None]
    is_away = outside & (lengths > 0.0)
    return Nearness(
        np.where(is_away, lengths, depth), np.where(is_away[:, None], directions, normals)
    )


def _is_box(piece: Polytope) -> bool:
    """Whether all faces are across an axis."""
    return bool(np.all(np.count_nonzero(piece.normals, axis=1) == 1))


def _feet_in_plane(points: Matrix, corners: Matrix) -> Matrix:
    """Return the nearest points on the outline of a polygon, a segment or a point."""
    best = np.full(len(points), np.inf)
    feet = np.zeros_like(points)
    for begin, end in _sides(corners):
        along = end - begin
        length2 = float(along @ along)
        share = np.clip((points - begin) @ along / length2, 0.0, 1.0) if length2 > 0.0 else 0.0
        foot = begin + np.multiply.outer(np.broadcast_to(share, len(points)), along)
        distance = np.square(points - foot).sum(axis=1)
        is_nearer = distance < best
        best = np.where(is_nearer, distance, best)
        feet = np.where(is_nearer[:, None], foot, feet)
    return feet


def _sides(corners: Matrix) -> Sequence[tuple[Vector, Vector]]:
    """Return the sides of a polygon; of a point it and itself."""
    after: Indices = np.roll(np.arange(len(corners)), -1)
    sides = list(zip(corners, corners[after], strict=True))
    return sides[:1] if len(corners) < 3 else sides
