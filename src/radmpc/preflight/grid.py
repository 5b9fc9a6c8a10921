"""Cells of which a vehicle crosses at most one per tick: speed limits as a rule for neighbors."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import product
from math import ceil

import numpy as np
import numpy.typing as npt

from radmpc.arrays import Indices, Matrix, Vector
from radmpc.geometry import Polytope
from radmpc.geometry.through import leads_through
from radmpc.records import dataclass

__all__ = ["Field", "Grid", "Walls", "grid_of", "widened"]

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


@dataclass(frozen=True, slots=True, eq=False)
class Walls:
    """Moves between neighbors that pieces stand in, and what leads around these in the same tick.

    Places within pieces count as none: whoever uses these keeps vehicles from their cells.

    Attributes
    ----------
    targets : (m,) int array
        Cells, by their places among `Grid.centers`, to which some neighbor has no straight way.
    sources : (m, 3^d) int array
        Neighbors that have one, the cell itself included; the number of cells stands for none.
    detours : (k, 3) int array
        Of moves that have none: the row of their target, a neighbor of both ends with a straight
        way to either, and where they begin.
    """

    targets: Indices
    sources: Indices
    detours: Indices

    @classmethod
    def of(cls, grid: Grid, places: Matrix, pieces: Sequence[Polytope]) -> Walls:
        """Find them.

        Parameters
        ----------
        grid : Grid
            The grid.
        places : (c, d) array
            Where in each cell the vehicle is [m].
        pieces : sequence of Polytope
            What stands there.
        """
        shape, count = grid.shape, len(places)
        offsets = np.array(list(product((-1, 0, 1), repeat=len(shape))))
        found = [np.zeros(0, dtype=np.int64)]
        for piece in pieces:
            corners = piece.vertices
            near = grid.within(
                corners.min(axis=0) - 2.5 * grid.size, corners.max(axis=0) + 2.5 * grid.size
            )
            # Within a piece there is nowhere to be, and no move is needed to say so.
            heights = places[near] @ piece.normals.T - piece.offsets
            near = near[heights.max(axis=1) > 0.0]
            around = _neighbors(near, offsets[len(offsets) // 2 + 1 :], shape)
            begins, ends = np.repeat(near, around.shape[1]), around.ravel()
            is_pair = np.isin(ends, near)
            begins, ends = begins[is_pair], ends[is_pair]
            is_shut = leads_through(piece, places[begins], places[ends])
            one, other = begins[is_shut], ends[is_shut]
            found += [one * count + other, other * count + one]
        shut = np.unique(np.concatenate(found))
        begins, ends = np.divmod(shut, count)
        targets, rows = np.unique(ends, return_inverse=True)
        sources = _open(targets, _neighbors(targets, offsets, shape), shut, count)
        # By way of a common neighbor: corners are rounded in a tick as if they were cut.
        between = _open(ends, _neighbors(ends, offsets, shape), shut, count)
        moves, which = np.nonzero(between < count)
        vias, firsts = between[moves, which], begins[moves]
        apart = np.stack(np.unravel_index(vias, shape)) - np.stack(np.unravel_index(firsts, shape))
        is_way = np.all(np.abs(apart) <= 1, axis=0) & ~np.isin(firsts * count + vias, shut)
        detours = np.stack([rows[moves], vias, firsts], axis=1)[is_way]
        return cls(targets, sources, detours)

    def widened(self, field: Field, here: Field) -> Field:
        """Return the largest value within one cell along each axis that has a way there.

        Parameters
        ----------
        field : array
            A value per cell.
        here : array
            What no value exceeds on a detour.
        """
        after = np.ascontiguousarray(widened(field))
        if self.targets.size:
            values = np.append(field.ravel(), np.float32(-np.inf))
            best = values[self.sources].max(axis=1)
            rows, vias, firsts = self.detours.T
            np.maximum.at(best, rows, np.minimum(values[firsts], here.ravel()[vias]))
            after.reshape(-1)[self.targets] = best
        return after

    def before(
        self, cell: tuple[int, ...], field: Field, here: Field
    ) -> tuple[tuple[int, ...], tuple[int, ...]]:
        """Return from which cell the largest value comes that `widened` gives one, and by which.

        Parameters
        ----------
        cell : tuple of int
            The cell.
        field, here : array
            As for `widened`.
        """
        shape, flat = field.shape, int(np.ravel_multi_index(cell, field.shape))
        values, most = field.ravel(), here.ravel()
        row = int(np.searchsorted(self.targets, flat))
        if row == len(self.targets) or self.targets[row] != flat:
            offsets = np.array(list(product((-1, 0, 1), repeat=len(shape))))
            around = _neighbors(np.array([flat]), offsets, shape)[0]
            ways = np.zeros((0, 2), dtype=np.int64)
        else:
            around = self.sources[row]
            ways = self.detours[self.detours[:, 0] == row, 1:]
        around = around[around < values.size]
        vias, firsts = (
            np.append(np.full(len(around), flat), ways[:, 0]),
            np.append(around, ways[:, 1]),
        )
        passed = np.where(vias == flat, values[firsts], np.minimum(values[firsts], most[vias]))
        best = int(passed.argmax())
        first, via = (np.unravel_index(k, shape) for k in (firsts[best], vias[best]))
        return tuple(int(i) for i in first), tuple(int(i) for i in via)


def _neighbors(cells: Indices, offsets: Indices, shape: tuple[int, ...]) -> Indices:
    """Return what is beside cells, (k, o); the number of cells where there is nothing."""
    found = np.stack(np.unravel_index(cells, shape), axis=1)[:, None] + offsets
    is_there = np.all((found >= 0) & (found < shape), axis=2)
    flat = np.ravel_multi_index(tuple(np.moveaxis(found, 2, 0)), shape, mode="clip")
    return np.where(is_there, flat, int(np.prod(shape)))


def _open(targets: Indices, neighbors: Indices, shut: Indices, count: int) -> Indices:
    """Return neighbors from which there is a straight way, the number of cells for the others."""
    return np.where(np.isin(neighbors * count + targets[:, None], shut), count, neighbors)
