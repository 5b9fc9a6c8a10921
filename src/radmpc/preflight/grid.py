"""Cells of which a vehicle crosses at most one per tick: speed limits as a rule for neighbors."""

from __future__ import annotations

from collections.abc import Iterator
from math import ceil

import numpy as np
import numpy.typing as npt

from radmpc.arrays import Indices, Matrix, Vector
from radmpc.records import dataclass

__all__ = ["Field", "Grid", "grid_of", "widened"]

Field = npt.NDArray[np.float32]

_FINE = 0.75
"""Size of a cell that is aimed at [hull radii]: gaps are known to a tenth of a radius before the
narrowest of them is measured."""

_COARSE = 1.3
"""Size of a cell beyond which nothing is said [hull radii]: at 1.4 walls have holes."""


@dataclass(frozen=True, slots=True, eq=False)
class Grid:
    """Boxes in rows and columns, and when a vehicle may go on to the next.

    Attributes
    ----------
    origin : (d,) array
        Center of the first cell [m].
    size : (d,) array
        Edges of a cell [m]: what is crossed in a tick at full speed.
    shape : tuple of int
        Cells per axis.
    steps : (n+1,) int array
        The step at or before each tick.
    is_step : (n+1,) bool array
        Whether the tick is the first of its step.
    """

    origin: Vector
    size: Vector
    shape: tuple[int, ...]
    steps: Indices
    is_step: npt.NDArray[np.bool_]

    @property
    def centers(self) -> Matrix:
        """Centers of all cells, the last axis fastest, (c, d) [m]."""
        axes = [a + h * np.arange(n) for a, h, n in zip(*self._rows, strict=True)]
        return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, len(axes))

    @property
    def _rows(self) -> tuple[list[float], list[float], tuple[int, ...]]:
        """Return origin, size and shape axis by axis."""
        return self.origin.tolist(), self.size.tolist(), self.shape

    def box(self, lower: Vector, upper: Vector) -> tuple[slice, ...]:
        """Return the cells that a box meets.

        Parameters
        ----------
        lower, upper : (d,) array
            Its corners [m].

        Returns
        -------
        tuple of slice
            Empty along an axis where the box is crossed or aside.
        """
        first = np.ceil((lower - self.origin) / self.size - 0.5 - 1e-9)
        last = np.floor((upper - self.origin) / self.size + 0.5 + 1e-9)
        most = np.array(self.shape)
        begin = np.clip(first, 0, most).astype(int).tolist()
        end = np.clip(last + 1, 0, most).astype(int).tolist()
        return tuple(slice(a, max(a, b)) for a, b in zip(begin, end, strict=True))

    def within(self, lower: Vector, upper: Vector) -> Indices:
        """Return the cells that a box meets, by their places among `centers`.

        Parameters
        ----------
        lower, upper : (d,) array
            Its corners [m].

        Returns
        -------
        (k,) int array
            In ascending order.
        """
        chosen = [np.arange(part.start, part.stop) for part in self.box(lower, upper)]
        return np.asarray(np.ravel_multi_index(np.ix_(*chosen), self.shape).ravel())


def grid_of(
    lower: Vector, upper: Vector, step: Vector, radius: float, horizon: int, work: float
) -> Grid | None:
    """Return the grid of one vehicle.

    Parameters
    ----------
    lower, upper : (d,) array
        Corners of the box that holds all its positions [m].
    step : (d,) array
        What it crosses in a step at full speed [m].
    radius : float
        Hull radius [m].
    horizon : int
        Number of steps T.
    work : float
        Cells times ticks at most [-].

    Returns
    -------
    Grid or None
        None where cells would be too large beside the hull.
    """
    # Along an axis on which it does not move one cell is enough.
    step = np.maximum(step, 1e-9 * radius)
    longest, extent = float(step.max()), upper - lower
    for share in _shares(_FINE * radius / longest, _COARSE * radius / longest):
        counts = np.floor(extent / (share * step)) + 2.0
        num_ticks = ceil(horizon / share - 1e-9)
        if float(np.prod(counts)) * num_ticks <= work:
            break
    else:
        return None
    size = share * step
    times = share * np.arange(num_ticks + 1)
    steps = np.minimum(np.floor(times + 1e-9), horizon).astype(np.int64)
    is_step = (np.diff(steps, prepend=-1) > 0) | (share >= 1.0)
    shape = tuple(int(n) for n in counts)
    return Grid(lower + 0.5 * (extent - size * (counts - 1.0)), size, shape, steps, is_step)


def _shares(finest: float, coarsest: float) -> Iterator[float]:
    """Yield steps per tick, or parts of a step, from about the finest to the coarsest."""
    if finest < 1.0:
        fewest = max(ceil(1.0 / coarsest - 1e-9), 1)
        # By a quarter each, or by one tick a step.
        num = ceil(1.0 / finest)
        while num > fewest:
            yield 1.0 / num
            num = min(num - 1, ceil(num / 1.25))
        yield 1.0 / fewest
        finest = 2.0
    share = max(int(finest), 1)
    while share <= coarsest:
        yield float(share)
        share = max(share + 1, int(1.25 * share))


def widened(field: Field) -> Field:
    """Return the largest value within one cell along each axis, diagonals included."""
    for axis in range(field.ndim):
        along = np.swapaxes(field, 0, axis)
        grown = along.copy()
        np.maximum(grown[1:], along[:-1], out=grown[1:])
        np.maximum(grown[:-1], along[1:], out=grown[:-1])
        field = np.swapaxes(grown, 0, axis)
    return field
