"""How far points are from convex pieces and from the workspace's border, and in which direction."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence

import numpy as np

from radmpc.arrays import Indices, Matrix, Vector
from radmpc.geometry import Polytope
from radmpc.model.scenario import Scenario
from radmpc.model.workspace import Workspace
from radmpc.records import dataclass

__all__ = ["Nearness", "Side", "Surroundings", "Within", "side_of"]

Within = Callable[[Vector, Vector], Indices]


@dataclass(frozen=True, slots=True, eq=False)
class Nearness:
    """What is nearest to points; written to until all is known.

    Attributes
    ----------
    distances : (c,) array
        Distance of the hull there, negative where it overlaps [m].
    normals : (c, d) array
        Unit direction away from what is nearest [-].
    """

    distances: Vector
    normals: Matrix

    def put(self, places: Indices, distances: Vector, normals: Matrix) -> None:
        """Write down what is nearer than all before it, at some of the points.

        Parameters
        ----------
        places : (k,) int array
            The points.
        distances : (k,) array
            Distances there [m].
        normals : (k, d) array
            Directions there [-].
        """
        is_nearer = distances < self.distances[places]
        chosen = places[is_nearer]
        self.distances[chosen] = distances[is_nearer]
        self.normals[chosen] = normals[is_nearer]


@dataclass(frozen=True, slots=True, eq=False)
class Side:
    """One thing to keep clear of, as seen from hulls at some points.

    Attributes
    ----------
    name : str or None
        The obstacle; None for the workspace's border.
    places : (k,) int array
        The points that are near it.
    distances : (k,) array
        Distance of the hull, negative where it overlaps [m].
    normals : (k, d) array
        Unit direction away from it [-].
    heights : (k, f) array
        The same above each of its faces: at most the distance, but past a corner there may be
        fewer deviations across a face [m].
    faces : (f, d) array
        Normals of the faces [-].
    """

    name: str | None
    places: Indices
    distances: Vector
    normals: Matrix
    heights: Matrix
    faces: Matrix

    def clearances(self, covariance: Matrix, least: float) -> Vector:
        """Return clearances in standard deviations, across the best of these half-spaces.

        Parameters
        ----------
        covariance : (d, d) array
            Of the position [m²].
        least : float
            Standard deviation that stands for less [m].

        Returns
        -------
        (k,) array
            Clearances.
        """
        toward = self.distances / _spread(self.normals, covariance, least)
        across = (self.heights / _spread(self.faces, covariance, least)).max(axis=1)
        return np.asarray(np.maximum(toward, across))

    def best(self, place: int, covariance: Matrix, least: float) -> tuple[float, float]:
        """Return clearance and deviation across the best half-space at one of its points [m].

        Parameters
        ----------
        place : int
            Which of `places`, by its order.
        covariance : (d, d) array
            Of the position [m²].
        least : float
            Standard deviation that stands for less [m].
        """
        normals = np.vstack([self.normals[place], self.faces])
        slacks = np.append(self.distances[place], self.heights[place])
        k = int((slacks / _spread(normals, covariance, least)).argmax())
        return float(slacks[k]), float(_spread(normals[k : k + 1], covariance, 0.0)[0])


def _spread(normals: Matrix, covariance: Matrix, least: float) -> Vector:
    """Return standard deviations along directions, (k,) [m]."""
    variances = np.sum((normals @ covariance) * normals, axis=1)
    return np.asarray(np.sqrt(np.maximum(variances, least**2)))


@dataclass(frozen=True, slots=True, eq=False)
class Surroundings:
    """All that a vehicle has to keep clear of at a step.

    Attributes
    ----------
    names : tuple of str
        The obstacle of each piece.
    pieces : tuple of Polytope
        The pieces.
    workspace : Workspace or None
        The workspace; the mean stays within.
    radius : float
        Hull radius [m].
    """

    names: tuple[str, ...]
    pieces: tuple[Polytope, ...]
    workspace: Workspace | None
    radius: float

    @classmethod
    def of(cls, scenario: Scenario, radius: float, step: int) -> Surroundings:
        """Collect what is there at a step.

        Parameters
        ----------
        scenario : Scenario
            The scenario.
        radius : float
            Hull radius [m].
        step : int
            The step, 0 to T.
        """
        found = [(o.name, piece) for o in scenario.obstacles for piece in o.at(step)]
        names, pieces = tuple(n for n, _ in found), tuple(p for _, p in found)
        return cls(names, pieces, scenario.workspace, radius)

    @property
    def is_empty(self) -> bool:
        """Whether there is nothing to keep clear of."""
        return not self.pieces and self.workspace is None

    def sides(
        self, points: Matrix, far: float = np.inf, within: Within | None = None
    ) -> Iterator[Side]:
        """Yield pieces, and faces of the border, as seen from points near them.

        Parameters
        ----------
        points : (c, d) array
            Where the vehicle's center may be [m].
        far : float
            Distance of the hull beyond which a piece does not matter [m].
        within : callable or None
            Finds the points in a box, given its corners, without looking at all of them; it may
            find some beside it.
        """
        reach = self.radius + far
        for name, piece in zip(self.names, self.pieces, strict=True):
            low = piece.vertices.min(axis=0) - reach
            high = piece.vertices.max(axis=0) + reach
            if within is None:
                close = np.flatnonzero(np.all((points >= low) & (points <= high), axis=1))
            else:
                close = within(low, high)
            yield side_of(name, piece, points, close, self.radius)
        if self.workspace is None:
            return
        for axis, normal in enumerate(np.eye(points.shape[1])):
            for inward, slack in (
                (normal, points[:, axis] - self.workspace.lower[axis]),
                (-normal, self.workspace.upper[axis] - points[:, axis]),
            ):
                close = np.flatnonzero(slack <= far)
                normals = np.broadcast_to(inward, (len(close), len(inward)))
                yield Side(None, close, slack[close], normals, slack[close, None], inward[None])

    def nearest(
        self, points: Matrix, far: float = np.inf, within: Within | None = None
    ) -> Nearness:
        """Return how far a hull at points is from the nearest of all.

        Parameters
        ----------
        points : (c, d) array
            Where the vehicle's center may be [m].
        far : float
            Distance of the hull beyond which it does not matter [m]; inf there.
        within : callable or None
            See `sides`.
        """
        best = Nearness(np.full(len(points), np.inf), np.zeros(points.shape))
        for side in self.sides(points, far, within):
            best.put(side.places, side.distances, side.normals)
        return best


def side_of(
    name: str | None, piece: Polytope, points: Matrix, places: Indices, radius: float
) -> Side:
    """Return a convex piece as seen from hulls at points.

    In space distances are exact for boxes, and for other bodies where a face is nearest; where an
    edge or a corner is, they are heights above a face, which are less.

    Parameters
    ----------
    name : str or None
        The obstacle.
    piece : Polytope
        The piece.
    points : (c, d) array
        Any points [m].
    places : (k,) int array
        Which of them count.
    radius : float
        Hull radius [m].

    Returns
    -------
    Side
        Where a point is within, its distance is minus the depth below the nearest face.
    """
    points = points[places]
    heights = points @ piece.normals.T - piece.offsets
    depth = heights.max(axis=1)
    normals = piece.normals[heights.argmax(axis=1)]
    feet = _feet(points, piece)
    distances = depth
    if feet is not None:
        away = points - feet
        lengths = np.sqrt(np.square(away).sum(axis=1))
        is_away = (depth > 0.0) & (lengths > 0.0)
        directions = away / np.where(is_away, lengths, 1.0)[:, None]
        distances = np.where(is_away, lengths, depth)
        normals = np.where(is_away[:, None], directions, normals)
    return Side(name, places, distances - radius, normals, heights - radius, piece.normals)


def _feet(points: Matrix, piece: Polytope) -> Matrix | None:
    """Return the nearest points on a piece to points outside; None where that takes more."""
    if points.shape[1] == 2:
        return _feet_in_plane(points, piece.vertices)
    if np.all(np.count_nonzero(piece.normals, axis=1) == 1):
        return np.clip(points, piece.vertices.min(axis=0), piece.vertices.max(axis=0))
    return None


def _feet_in_plane(points: Matrix, corners: Matrix) -> Matrix:
    """Return the nearest points on the outline of a polygon, a segment or a point."""
    best = np.full(len(points), np.inf)
    feet = np.zeros_like(points)
    for begin, end in _sides(corners):
        along = end - begin
        length2 = float(along @ along)
        share = (points - begin) @ along / (length2 if length2 > 0.0 else 1.0)
        foot = begin + np.clip(share, 0.0, 1.0)[:, None] * along
        distance = np.square(points - foot).sum(axis=1)
        is_nearer = distance < best
        best = np.where(is_nearer, distance, best)
        feet = np.where(is_nearer[:, None], foot, feet)
    return feet


def _sides(corners: Matrix) -> Sequence[tuple[Vector, Vector]]:
    """Return the sides of a polygon; of a point it and itself."""
    after = np.roll(np.arange(len(corners)), -1)
    sides = list(zip(corners, corners[after], strict=True))
    return sides[:1] if len(corners) < 3 else sides
