"""A moving obstacle between two steps, as solids at rest in frames that move along."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial import ConvexHull

from radmpc.arrays import Matrix, Vector
from radmpc.geometry import Polytope
from radmpc.referee.contact import Solid, solid_of

__all__ = ["SweepPart", "resting", "swept"]

# What a turning outline may be too large by, and how often an interval is split for it.
_FINENESS = 1e-3
_MOST_PARTS = 200


@dataclass(frozen=True, slots=True, eq=False)
class SweepPart:
    """A solid that moves with constant velocity during a share of an interval.

    Attributes
    ----------
    begin, end : float
        From where to where in the interval, 0 to 1.
    drift : (d,) array
        How far it would move in the whole interval [m].
    solid : Solid
        Its shape, at the place it has at ``begin`` less ``begin * drift``.
    """

    begin: float
    end: float
    drift: Vector
    solid: Solid


def resting(piece: Polytope) -> tuple[SweepPart, ...]:
    """Return an obstacle that stands still."""
    return (SweepPart(0.0, 1.0, np.zeros(piece.dimension), solid_of(piece)),)


def swept(before: Polytope, after: Polytope) -> tuple[SweepPart, ...]:
    """Return the Minkowski interpolation of two outlines.

    A mere shift is exact. What turns or changes its shape is split until each part changes by
    less than a millimeter (at most 200 parts); a part is the hull of its two ends and so never
    too small.

    Parameters
    ----------
    before, after : Polytope
        The outline at the start and at the end of the interval.
    """
    drift = after.vertices.mean(axis=0) - before.vertices.mean(axis=0)
    back = after.vertices - drift
    directions = np.vstack([before.normals, after.normals])
    change = (directions @ before.vertices.T).max(axis=1) - (directions @ back.T).max(axis=1)
    largest = float(np.abs(change).max())
    if largest <= 1e-9:
        return (SweepPart(0.0, 1.0, drift, solid_of(before)),)
    count = int(min(np.ceil(largest / _FINENESS), _MOST_PARTS))
    ends = np.linspace(0.0, 1.0, count + 1)
    outlines = [_between(before.vertices, back, t) for t in ends]
    return tuple(
        SweepPart(
            float(ends[p]),
            float(ends[p + 1]),
            drift,
            _solid_around(np.vstack([outlines[p], outlines[p + 1]])),
        )
        for p in range(count)
    )


def _between(before: Matrix, after: Matrix, t: float) -> Matrix:
    """Return the corners of ``(1 - t) P + t P'``, and points inside."""
    d = before.shape[1]
    points = (1.0 - t) * before[:, None] + t * after[None]
    cloud = points.reshape(-1, d)
    corners: Matrix = cloud[ConvexHull(cloud).vertices]
    return corners


def _solid_around(points: Matrix) -> Solid:
    """Return the hull of points."""
    qhull = ConvexHull(points)
    equations = np.unique(qhull.equations.round(12), axis=0)
    sides = np.concatenate([np.delete(qhull.simplices, i, axis=1) for i in range(points.shape[1])])
    pairs = qhull.simplices if points.shape[1] == 2 else sides
    return Solid(
        normals=equations[:, :-1],
        offsets=-equations[:, -1],
        vertices=points[qhull.vertices],
        edges=points[pairs],
    )
