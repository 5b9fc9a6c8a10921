"""The lattice of positions and displacements that is searched for a path."""

from __future__ import annotations

import numpy as np

from radmpc.arrays import Indices, Matrix, Vector
from radmpc.planners.certified.lattice.half_planes import (
    AvoidanceHalfPlanes,
    gap_middles,
    limits_at,
)
from radmpc.planners.certified.lattice.tuning import TUNING
from radmpc.program.condensed import CondensedModel
from radmpc.records import dataclass, replace

__all__ = ["Box", "Lattice", "coarse_lattice", "finer_lattice", "snapped_lattice"]

Box = tuple[int, int, int, int]
"""Positions from a row to below another, and from a column to below another."""


@dataclass(frozen=True, slots=True, eq=False)
class Lattice:
    """Positions and displacements around a reference path.

    Attributes
    ----------
    stride : (2,) array
        Size of a cell [m].
    start : (2,) array
        Where the vehicle starts [m].
    reference : (T+1, 2) int array
        Cell around which positions are counted at each step, relative to the start.
    first : (2,) int array
        First position along each axis, relative to the reference.
    shape : (int, int)
        Positions along each axis.
    reach : int
        Cells, either way, by which a displacement may differ from the reference's.
    lines : pair of array or None
        Where the positions are along each axis [m], if they are not evenly spaced.
    """

    stride: Vector
    start: Vector
    reference: Indices
    first: Indices
    shape: tuple[int, int]
    reach: int
    lines: tuple[Vector, Vector] | None = None

    def positions(self, cells: Indices) -> Matrix:
        """Return where cells, counted from the start, are [m]."""
        if self.lines is None:
            return np.asarray(self.start + cells * self.stride)
        indices = (cells - self.first).T
        return np.column_stack([line[p] for line, p in zip(self.lines, indices, strict=True)])

    def axes(self, reference: Indices) -> list[Vector]:
        """Return the coordinates of positions around a reference along each axis [m]."""
        if self.lines is not None:
            return list(self.lines)
        counts = [reference[a] + self.first[a] + np.arange(self.shape[a]) for a in (0, 1)]
        return [self.start[a] + self.stride[a] * counts[a] for a in (0, 1)]

    @property
    def everywhere(self) -> Box:
        """All positions."""
        return 0, self.shape[0], 0, self.shape[1]

    def box(self, k: int, lower: Vector, upper: Vector) -> Box:
        """Return which positions at a step lie in a box, up to half a cell.

        Parameters
        ----------
        k : int
            The step.
        lower, upper : (2,) array
            Corners of the box [m].
        """
        found = []
        for axis in (0, 1):
            cells = self.reference[k, axis] + self.first[axis]
            points = (cells + np.arange(self.shape[axis])) * self.stride[axis]
            points = points + self.start[axis]
            half = 0.5 * self.stride[axis]
            inside = np.flatnonzero((points >= lower[axis] - half) & (points <= upper[axis] + half))
            found += [int(inside[0]), int(inside[-1]) + 1] if inside.size else [0, 0]
        return found[0], found[1], found[2], found[3]

    def axes_ahead(self, reference: Indices, displacement: Indices) -> list[Vector]:
        """Return where displacements lead to along each axis, the least from the first position on.

        Parameters
        ----------
        reference, displacement : (2,) array
            Where the lattice lies, and by how much it moves in this window [cells].

        Returns
        -------
        list of (a + w - 1,) array
            Coordinates [m]: from position i by displacement j that at i + j.
        """
        found = []
        for axis, count in enumerate(self.shape):
            ahead = np.arange(count + 2 * self.reach) - self.reach + displacement[axis]
            if self.lines is not None:
                found.append(self.lines[axis][np.clip(ahead, 0, count - 1)])
            else:
                cells = reference[axis] + self.first[axis] + ahead
                found.append(self.start[axis] + self.stride[axis] * cells)
        return found


def coarse_lattice(
    model: CondensedModel, avoidances: list[list[AvoidanceHalfPlanes]], longest: Vector, reach: int
) -> Lattice:
    """Return the lattice over everything within reach and borders.

    Parameters
    ----------
    model : CondensedModel
        The vehicle.
    avoidances : list of list of AvoidanceHalfPlanes
        Those of each window.
    longest : (2,) array
        Its longest displacement along each axis [m].
    reach : int
        Cells that it is long.
    """
    start = model.drift_position[0]
    lower, upper = limits_at(avoidances)
    low = np.maximum(model.reach_lower, lower).min(axis=0)
    high = np.minimum(model.reach_upper, upper).max(axis=0)
    low, high = np.minimum(low - start, 0.0), np.maximum(high - start, 0.0)
    stride = longest / reach
    while np.prod(np.floor(high / stride) - np.ceil(low / stride) + 1) > TUNING.max_cells:
        stride = stride * 1.25
    first = np.ceil(low / stride).astype(np.int64)
    last = np.floor(high / stride).astype(np.int64)
    shape = (int(last[0] - first[0]) + 1, int(last[1] - first[1]) + 1)
    still = np.zeros((model.horizon + 1, 2), dtype=np.int64)
    return Lattice(stride, start, still, first, shape, reach)


def finer_lattice(lattice: Lattice, cells: Indices) -> Lattice:
    """Return a lattice of half the stride, in a tube around a path.

    Parameters
    ----------
    lattice : Lattice
        The coarser one.
    cells : (T+1, 2) int array
        The path, in its cells from the start.
    """
    return Lattice(
        0.5 * lattice.stride,
        lattice.start,
        2 * cells,
        np.full(2, -TUNING.tube, dtype=np.int64),
        (2 * TUNING.tube + 1, 2 * TUNING.tube + 1),
        TUNING.displacements_around,
    )


def snapped_lattice(lattice: Lattice, avoidances: list[list[AvoidanceHalfPlanes]]) -> Lattice:
    """Return a lattice whose lines run through the middles of gaps between parallel half-planes.

    Parameters
    ----------
    lattice : Lattice
        One with evenly spaced lines.
    avoidances : list of list of AvoidanceHalfPlanes
        Those of each window.
    """
    lines = []
    for axis, line in enumerate(lattice.axes(lattice.reference[0])):
        stride = float(lattice.stride[axis])
        for middle in gap_middles(avoidances, axis, TUNING.narrow * stride):
            nearest = int(np.abs(line - middle).argmin())
            if abs(line[nearest] - middle) <= 0.5 * stride:
                line[nearest] = middle
        lines.append(line)
    return replace(lattice, lines=(lines[0], lines[1]))
