"""A moving obstacle between two steps: at rest in a frame that moves along, or turning."""

from __future__ import annotations

import numpy as np

from radmpc.arrays import Vector
from radmpc.geometry import Polytope
from radmpc.records import dataclass
from radmpc.referee.contact import Solid, solid_of
from radmpc.referee.simulation.turning import TurningSolid, turning

__all__ = ["SweepPart", "resting", "swept"]

_SAME = 1e-9
"""Difference of supports below which two outlines have the same shape [m]."""


@dataclass(frozen=True, slots=True, eq=False)
class SweepPart:
    """A solid during an interval.

    Attributes
    ----------
    drift : (d,) array
        How far the frame moves in which the solid stands or turns [m].
    solid : Solid or TurningSolid
        Its shape, at the place it has at the start.
    """

    drift: Vector
    solid: Solid | TurningSolid


def resting(piece: Polytope) -> tuple[SweepPart, ...]:
    """Return an obstacle that stands still."""
    return (SweepPart(np.zeros(piece.dimension), solid_of(piece)),)


def swept(before: Polytope, after: Polytope) -> tuple[SweepPart, ...]:
    """Return the Minkowski interpolation of two outlines, exactly.

    Parameters
    ----------
    before, after : Polytope
        The outline at the start and at the end of the interval.
    """
    drift = after.vertices.mean(axis=0) - before.vertices.mean(axis=0)
    back = after.vertices - drift
    directions = np.vstack([before.normals, after.normals])
    change = (directions @ before.vertices.T).max(axis=1) - (directions @ back.T).max(axis=1)
    if float(np.abs(change).max()) <= _SAME:
        return (SweepPart(drift, solid_of(before)),)
    return (SweepPart(drift, turning(before.vertices, back)),)
