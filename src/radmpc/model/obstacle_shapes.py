"""How obstacles are described: what files keep of them."""

from __future__ import annotations

from collections.abc import Sequence, Sized

import numpy.typing as npt

from radmpc.arrays import Frozen, Matrix, Vector, as_matrix
from radmpc.errors import ScenarioError
from radmpc.geometry import Polytope, hull
from radmpc.model.obstacle_track import TrackShape
from radmpc.records import dataclass

__all__ = [
    "BoxShape",
    "Concerns",
    "HalfspaceShape",
    "LineShape",
    "MovingShape",
    "PolygonShape",
    "Shape",
    "hulls_of",
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
        If there is none.
    """
    if isinstance(value, Sized) and not len(value):
        raise ScenarioError("needs at least one point, got none", path)
    return as_matrix(value, path=path)
