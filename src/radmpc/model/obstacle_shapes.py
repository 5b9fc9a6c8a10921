"""How obstacles are described: what files keep of them."""

from __future__ import annotations

from dataclasses import dataclass

from radmpc.arrays import Frozen, Matrix, Vector
from radmpc.model.obstacle_track import TrackShape

__all__ = [
    "BoxShape",
    "HalfspaceShape",
    "LineShape",
    "MovingShape",
    "PolygonShape",
    "Shape",
]


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
