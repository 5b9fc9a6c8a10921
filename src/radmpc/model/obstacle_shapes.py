"""How obstacles are described: what files keep of them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy.typing as npt

from radmpc.arguments import field_parts
from radmpc.arrays import Frozen, Matrix, Vector, as_matrix, as_vector
from radmpc.errors import ScenarioError
from radmpc.geometry import Polytope, convex_pieces, hull
from radmpc.model.obstacle_track import TrackShape, is_empty
from radmpc.ranges import sized
from radmpc.records import dataclass

__all__ = [
    "BoxShape",
    "Concerns",
    "HalfspaceShape",
    "LineShape",
    "MovingShape",
    "PolygonShape",
    "Shape",
    "corners_of",
    "faces_of",
    "hulls_of",
    "outlines_of",
    "pieces_of",
    "points_of",
]


@dataclass(frozen=True, slots=True)
class Concerns:
    """Some vehicles, or all others.

    Attributes
    ----------
    names : tuple of str
        The vehicles named.
    are_exempt : bool
        Whether these pass freely and all others do not.
    """

    names: tuple[str, ...]
    are_exempt: bool = False


@dataclass(frozen=True, slots=True, eq=False)
class PolygonShape(Frozen):
    """A simple polygon (2-D, convex or not) or the hull of points (3-D).

    Attributes
    ----------
    vertices : (v, d) array
        Corners in order, or points [m].
    holes : tuple of (h, 2) array
        Outlines of what is left out of it [m].
    """

    vertices: Matrix
    holes: tuple[Matrix, ...] = ()


@dataclass(frozen=True, slots=True, eq=False)
class LineShape(Frozen):
    """A wall or wire without thickness along an open line.

    Attributes
    ----------
    points : (p, d) array
        Points that the line runs through, in order [m].
    """

    points: Matrix


@dataclass(frozen=True, slots=True, eq=False)
class BoxShape(Frozen):
    """An axis-parallel box; it may be flat.

    Attributes
    ----------
    lower, upper : (d,) array
        Opposite corners, ``lower <= upper`` [m].
    """

    lower: Vector
    upper: Vector


@dataclass(frozen=True, slots=True, eq=False)
class HalfspaceShape(Frozen):
    """The set ``normals @ x <= offsets``, as given.

    Attributes
    ----------
    normals : (f, d) array
        Outward normals, of any length.
    offsets : (f,) array
        In meters where normals have length one.
    """

    normals: Matrix
    offsets: Vector


@dataclass(frozen=True, slots=True, eq=False)
class MovingShape(Frozen):
    """One convex outline per step.

    Attributes
    ----------
    outlines : tuple of (v, d) array
        Points whose hull is the outline at k = 0..T [m].
    """

    outlines: tuple[Matrix, ...]


Shape = PolygonShape | LineShape | BoxShape | HalfspaceShape | MovingShape | TrackShape


def hulls_of(outlines: Sequence[Matrix]) -> list[Polytope]:
    """Return the hulls of outlines, one per step.

    Parameters
    ----------
    outlines : sequence of (v, d) array
        Points [m].

    Raises
    ------
    ScenarioError
        If one has none; its path says which.
    """
    found = []
    for k, outline in enumerate(outlines):
        try:
            found.append(hull(outline))
        except ScenarioError as error:
            raise error.under("moving", k) from error
    return found


def points_of(value: npt.ArrayLike, path: tuple[str | int, ...]) -> Matrix:
    """Return points (p, d) [m], at least one.

    Parameters
    ----------
    value : (p, d) array_like
        What was given.
    path : tuple of str or int
        Where it stands, for the message.

    Raises
    ------
    ScenarioError
        If there is none, or a number is too large.
    """
    if is_empty(value):
        raise ScenarioError("needs at least one point, got none", path)
    return sized(as_matrix(value, path=path), path)


def corners_of(lower: npt.ArrayLike, upper: npt.ArrayLike) -> tuple[Vector, Vector]:
    """Return the corners of a box, (d,) each [m].

    Parameters
    ----------
    lower, upper : (d,) array_like
        What was given.

    Raises
    ------
    ScenarioError
        If they have different numbers of coordinates, or a number is too large.
    """
    low = sized(as_vector(lower, path=("min",)), ("min",))
    high = sized(as_vector(upper, path=("max",)), ("max",))
    if low.size != high.size:
        raise ScenarioError(f"must have {low.size} coordinates, got {high.size}", ("max",))
    return low, high


def faces_of(normals: npt.ArrayLike, offsets: npt.ArrayLike) -> tuple[Matrix, Vector]:
    """Return the faces of half-spaces, (f, d) and (f,).

    Parameters
    ----------
    normals, offsets : (f, d) and (f,) array_like
        What was given.

    Raises
    ------
    ScenarioError
        If there are not as many of both, or a number is too large.
    """
    rows = sized(as_matrix(normals, path=("normals",)), ("normals",))
    return rows, sized(as_vector(offsets, len(rows), ("offsets",)), ("offsets",))


def outlines_of(given: object) -> tuple[Matrix, ...]:
    """Return outlines step by step, (v, d) each [m], at least one.

    Parameters
    ----------
    given : iterable of (v, d) array_like
        What was given.

    Raises
    ------
    ScenarioError
        If there is no outline, or one has no point.
    """
    parts = field_parts(given, "one outline per step", ("moving",))
    points = tuple(
        points_of(part, ("moving", k))  # type: ignore[arg-type] # checked there
        for k, part in enumerate(parts)
    )
    if not points:
        raise ScenarioError("needs one outline per step, got none", ("moving",))
    return points


def pieces_of(points: Matrix, holes: tuple[Matrix, ...]) -> tuple[Polytope, ...]:
    """Return the convex pieces of a polygon, in space the hull.

    Parameters
    ----------
    points : (v, d) array
        Corners [m].
    holes : tuple of (h, 2) array
        Outlines of parts that are free [m].

    Raises
    ------
    ScenarioError
        If an outline crosses itself, or holes are not within it or in space.
    """
    if holes and points.shape[1] != 2:
        raise ScenarioError("must be left out in space: only polygons have holes", ("holes",))
    try:
        return convex_pieces(points, holes) if points.shape[1] == 2 else (hull(points),)
    except ScenarioError as error:
        raise error.under("vertices") from error
