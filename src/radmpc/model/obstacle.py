"""Fixed and moving obstacles as convex pieces: bodies, plates, walls, wires and posts."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
import numpy.typing as npt

from radmpc.arguments import field_parts, field_text
from radmpc.arrays import Frozen
from radmpc.geometry import Polytope, box, halfspaces, hull
from radmpc.model.obstacle_shapes import (
    BoxShape,
    Concerns,
    HalfspaceShape,
    LineShape,
    MovingShape,
    PolygonShape,
    Shape,
    corners_of,
    faces_of,
    hulls_of,
    outlines_of,
    pieces_of,
    points_of,
)
from radmpc.model.obstacle_track import TrackShape, TrackSpread, check_step
from radmpc.records import dataclass, replace

__all__ = [
    "BoxShape",
    "HalfspaceShape",
    "LineShape",
    "MovingShape",
    "Obstacle",
    "PolygonShape",
    "Shape",
    "TrackShape",
]


@dataclass(frozen=True, slots=True, eq=False)
class Obstacle(Frozen):
    """A named region to avoid.

    Between steps a moving obstacle's points move linearly: its path lies within the Minkowski
    interpolation of its pieces. One on a track is laid out by its scenario, which knows the steps.

    Attributes
    ----------
    name : str
        Unique within its scenario.
    shape : Shape
        The description it was made from; files keep this one.
    steps : tuple of tuple of Polytope
        Convex pieces: one entry if it stands still, else one per step 0..T; of a track the mean.
    spread : TrackSpread or None
        How far the true place is from these; None where they are exact.
    dt : float or None
        Step that its track is laid out for [s]; None for all other shapes, and before that.
    concerns : Concerns or None
        Whom it concerns, see `radmpc.model.relations.concerns.only_for`; None is everybody.
    """

    name: str
    shape: Shape
    steps: tuple[tuple[Polytope, ...], ...]
    spread: TrackSpread | None = None
    dt: float | None = None
    concerns: Concerns | None = None

    def __post_init__(self) -> None:
        """Refuse a name that is no text."""
        field_text(self.name, ("name",))

    @property
    def is_moving(self) -> bool:
        """Whether the obstacle changes with time."""
        return isinstance(self.shape, MovingShape | TrackShape)

    @property
    def dimension(self) -> int:
        """Number of coordinates."""
        return self.steps[0][0].dimension

    def at(self, step: int) -> tuple[Polytope, ...]:
        """Return the convex pieces at a step.

        Parameters
        ----------
        step : int
            0..T; what stands still is the same at all.

        Returns
        -------
        tuple of Polytope
            Their union is the obstacle.

        Raises
        ------
        ArgumentError
            If it moves and has no such step: one on a track has 0 alone before its scenario.
        """
        if not self.is_moving:
            return self.steps[0]
        is_early = self.dt is None and isinstance(self.shape, TrackShape)
        check_step(step, len(self.steps) - 1, is_early=is_early)
        return self.steps[step]

    def laid_out(self, dt: float, horizon: int) -> Obstacle:
        """Return the obstacle at every step of a scenario; itself unless it is on a track.

        Parameters
        ----------
        dt : float
            Step [s].
        horizon : int
            Number of steps T.

        Returns
        -------
        Obstacle
            With its mean outlines at steps 0..T, and how far it strays from them.
        """
        is_done = self.dt == dt and len(self.steps) == horizon + 1
        if is_done or not isinstance(self.shape, TrackShape):
            return self
        pieces = tuple((hull(outline),) for outline in self.shape.outlines(dt, horizon))
        return replace(self, steps=pieces, spread=self.shape.spread(dt, horizon), dt=dt)

    @classmethod
    def polygon(
        cls, name: str, vertices: npt.ArrayLike, holes: Iterable[npt.ArrayLike] = ()
    ) -> Obstacle:
        """Make an obstacle of a simple polygon, perhaps with holes; in 3-D of the hull of points.

        Parameters
        ----------
        name : str
            Unique within its scenario.
        vertices : (v, d) array
            Corners [m], either way round; in the plane the outline need not be convex. Corners
            on one line make a wall, in space those in one plane a plate; one is a post.
        holes : iterable of (h, 2) array
            Corners of parts of it that are free, such as a basin within a mole [m]; in the plane
            alone. They lie within the outline and apart from one another.

        Returns
        -------
        Obstacle
            Split into convex pieces.

        Raises
        ------
        ScenarioError
            If there is no corner, an outline crosses itself, or holes are not within it.
        """
        points = points_of(vertices, ("vertices",))
        inner: tuple[Any, ...] = field_parts(holes, "a list of outlines", ("holes",))
        free = tuple(points_of(hole, ("holes", i)) for i, hole in enumerate(inner))
        return cls(name, PolygonShape(points, free), (pieces_of(points, free),))

    @classmethod
    def line(cls, name: str, points: npt.ArrayLike) -> Obstacle:
        """Make an obstacle of a line without thickness: a fence, a boom, in space a wire.

        Parameters
        ----------
        name : str
            Unique within its scenario.
        points : (p, d) array
            Points in order [m]; the line may cross itself, and is closed if it ends where it began.

        Returns
        -------
        Obstacle
            One piece per straight part.

        Raises
        ------
        ScenarioError
            If there is no point.
        """
        places = points_of(points, ("line",))
        moves = np.any(places[1:] != places[:-1], axis=1)
        parts = [places[i : i + 2] for i in np.flatnonzero(moves)] or [places[:1]]
        return cls(name, LineShape(places), (tuple(hull(part) for part in parts),))

    @classmethod
    def box(cls, name: str, lower: npt.ArrayLike, upper: npt.ArrayLike) -> Obstacle:
        """Make an obstacle of an axis-parallel box.

        Parameters
        ----------
        name : str
            Unique within its scenario.
        lower, upper : (d,) array
            Corners [m], ``lower <= upper``; a box flat along some axis is a wall or plate.

        Returns
        -------
        Obstacle
            One piece.

        Raises
        ------
        ScenarioError
            If min is above max on some axis.
        """
        low, high = corners_of(lower, upper)
        return cls(name, BoxShape(low, high), ((box(low, high),),))

    @classmethod
    def halfspaces(cls, name: str, normals: npt.ArrayLike, offsets: npt.ArrayLike) -> Obstacle:
        """Make an obstacle of the set ``normals @ x <= offsets``.

        Parameters
        ----------
        name : str
            Unique within its scenario.
        normals, offsets : (f, d) and (f,) array
            Outward normals of the faces, of any length but 0; right-hand sides [m at length 1].

        Returns
        -------
        Obstacle
            One piece.

        Raises
        ------
        ScenarioError
            If the set is empty or unbounded.
        """
        rows, rhs = faces_of(normals, offsets)
        return cls(name, HalfspaceShape(rows, rhs), ((halfspaces(rows, rhs),),))

    @classmethod
    def moving(cls, name: str, outlines: Iterable[npt.ArrayLike]) -> Obstacle:
        """Make an obstacle of one convex outline per step 0..T.

        Parameters
        ----------
        name : str
            Unique within its scenario.
        outlines : iterable of (v, d) array_like
            Corners at each step [m], T + 1 of them; of each the hull counts, which may be flat.

        Returns
        -------
        Obstacle
            One piece per step; between steps its points move linearly.

        Raises
        ------
        ScenarioError
            If there is no outline, or one has no point.
        """
        points = outlines_of(outlines)
        return cls(name, MovingShape(points), tuple((one,) for one in hulls_of(points)))

    @classmethod
    def tracked(
        cls,
        name: str,
        outline: npt.ArrayLike,
        start: npt.ArrayLike,
        covariance: npt.ArrayLike = 0.0,
        disturbance_covariance: npt.ArrayLike = 0.0,
    ) -> Obstacle:
        """Make an obstacle of a convex outline that moves at constant velocity, more or less.

        Parameters
        ----------
        name : str
            Unique within its scenario.
        outline : (v, d) array
            Corners relative to the place on the track [m], as they lie: the outline does not turn.
        start : (2 d,) array
            Place [m] and velocity [m/s] at k = 0, their means.
        covariance : (2 d, 2 d) array
            Of both at k = 0; one number or a diagonal is taken as well. 0 is known exactly.
        disturbance_covariance : (2 d, 2 d) array
            Of what every step adds to both, likewise; 0 is a velocity that never changes.

        Returns
        -------
        Obstacle
            Its position error is the same random variable for every vehicle.

        Raises
        ------
        ScenarioError
            If there is no point, or an array does not fit.
        """
        shape = TrackShape(outline, start, covariance, disturbance_covariance)
        return cls(name, shape, ((hull(shape.outline + shape.start[: shape.dimension]),),))
