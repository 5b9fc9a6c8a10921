"""Values of a lattice search as arrays: tails from a table, changes of displacement, and moves.

Of the values of a search eight or nine tenths are infeasible, blocked or out of reach. What is kept
of each window is a bit for all and a value for the others (of a map of 32 x 32 cells 3 MB, not 26).
"""

from __future__ import annotations

from functools import cache
from itertools import product

import numpy as np
import numpy.typing as npt

from radmpc.gaussian import Tail
from radmpc.planners.certified.lattice.positions import Box
from radmpc.planners.certified.lattice.slacks import Slacks
from radmpc.records import dataclass
from radmpc.solvers.compiled_code import is_compiled

if is_compiled():
    from radmpc.solvers import _compiled

__all__ = [
    "INFEASIBLE",
    "FeasibleValues",
    "Float32",
    "WindowCosts",
    "add_tails",
    "changed",
    "moved",
]

INFEASIBLE = 1e9
"""Value of what is not allowed: large beside any plan's cost, finite when summed over a path."""

_FINENESS = 64
"""Entries of the table of tails per standard deviation [-]."""

_FAR = 10
"""Clearance beyond which there is no risk (8e-24) [standard deviations]."""

_LIMIT = 0.5 * INFEASIBLE
"""Sums from which on one of what was added is infeasible."""

Bits = npt.NDArray[np.uint8]
Float32 = npt.NDArray[np.float32]


@dataclass(frozen=True, slots=True, eq=False)
class FeasibleValues:
    """Values by displacement and position, of which most are infeasible.

    Attributes
    ----------
    bits : (ceil(n / 8),) array
        A bit per value: whether it is feasible.
    values : (m,) array
        Those that are.
    shape : tuple of int
        Of all values.
    corner : tuple of int
        The first position, along each axis.
    """

    bits: Bits
    values: Float32
    shape: tuple[int, ...]
    corner: tuple[int, int]

    @classmethod
    def of(cls, values: Float32, box: Box) -> FeasibleValues:
        """Return the values of an array at the positions of a box.

        Parameters
        ----------
        values : (w, w, a, b) array
            By displacement and position.
        box : Box
            The positions.
        """
        inside = values[:, :, box[0] : box[1], box[2] : box[3]]
        is_feasible = inside < _LIMIT
        return cls(np.packbits(is_feasible), inside[is_feasible], inside.shape, (box[0], box[2]))

    @property
    def cheapest(self) -> tuple[int, int, int, int]:
        """The displacement and the position of the least value."""
        number = np.flatnonzero(self._is_feasible)[self.values.argmin()]
        i, j, row, column = (int(place) for place in np.unravel_index(number, self.shape))
        return i, j, row + self.corner[0], column + self.corner[1]

    def at(self, row: int, column: int) -> Float32:
        """Return the values of a position by displacement, (w, w), infeasible ones all the same.

        Parameters
        ----------
        row, column : int
            The position, in the box.
        """
        by_move = self._is_feasible.reshape(-1, self.shape[2] * self.shape[3])
        cell = (row - self.corner[0]) * self.shape[3] + column - self.corner[1]
        before = by_move.sum(axis=1).cumsum() - by_move[:, cell:].sum(axis=1)
        found = np.full(len(by_move), INFEASIBLE, dtype=np.float32)
        is_feasible = by_move[:, cell]
        found[is_feasible] = self.values[before[is_feasible]]
        return found.reshape(self.shape[:2])

    @property
    def _is_feasible(self) -> npt.NDArray[np.bool_]:
        """Whether each value is feasible."""
        return np.unpackbits(self.bits, count=int(np.prod(self.shape))).view(np.bool_)


@dataclass(frozen=True, slots=True, eq=False)
class WindowCosts:
    """What displacements from positions cost in a window besides the effort.

    Attributes
    ----------
    risks : (n,) array
        By displacement and position [-].
    blocked : (ceil(n / 8),) array
        A bit for each: whether it is not allowed.
    weight : float
        Cost of risk, per unit of probability.
    most : float
        Risk that is allowed [-].
    late : float
        Cost of ending elsewhere than in `in_time`.
    in_time : Box
        Positions.
    """

    risks: Float32
    blocked: Bits
    weight: float
    most: float
    late: float
    in_time: Box


@cache
def _tails(tail: Tail) -> Float32:
    """Return the tail probability at every sixty-fourth of a standard deviation."""
    entries = np.arange(-_FAR * _FINENESS, _FAR * _FINENESS + 1)
    return tail.probability(entries / _FINENESS).astype(np.float32)


def add_tails(risks: Float32, slacks: Slacks, deviation: float, tail: Tail) -> None:
    """Add tail probabilities to risks, rounded to the clearances of a table.

    Parameters
    ----------
    risks : (n,) array
        By displacement and position; what is added to.
    slacks : Slacks
        Of some of them [m].
    deviation : float
        Standard deviation [m].
    tail : Tail
        Whose probabilities.
    """
    tails, scale = _tails(tail), _FINENESS / deviation
    if is_compiled():
        _compiled.lattice_add_tails(risks, slacks.numbers, slacks.values, tails, scale)
        return
    most = _FAR * _FINENESS
    entries = (slacks.values * np.float32(scale)).clip(-most, most).astype(np.int64) + most
    risks[slacks.numbers] += tails[entries]


def changed(values: Float32, tables: tuple[Float32, Float32], box: Box) -> Float32:
    """Return the least value over all last displacements, for each position and *next* one.

    Parameters
    ----------
    values : (w, w, a, b) array
        Values by last displacement and position.
    tables : pair of (w, w) array
        Effort from one displacement to the next along each axis, [next, last].
    box : Box
        Positions that are looked at.

    Returns
    -------
    (w, w, a, b) array
        Values by next displacement and position; anything beside the box.
    """
    width, _, rows, columns = values.shape
    for axis, table in enumerate(tables):
        result = np.empty_like(values)
        if is_compiled():
            parts = values, table, axis, result
            _compiled.lattice_change((width, rows, columns), INFEASIBLE, box, *parts)
        else:
            _change(values, table, axis, box, result)
        values = result
    return values


def _change(values: Float32, table: Float32, axis: int, box: Box, into: Float32) -> None:
    """Change displacements along an axis, without compiled code."""
    into.fill(INFEASIBLE)
    inside = slice(None), slice(box[0], box[1]), slice(box[2], box[3])
    source, target = np.moveaxis(values, axis, 0), np.moveaxis(into, axis, 0)
    for after, before in zip(*np.nonzero(table < INFEASIBLE), strict=True):
        least = target[after][inside]
        np.minimum(least, source[before][inside] + table[after, before], out=least)


def moved(values: Float32, costs: WindowCosts, source: Box, target: Box) -> Float32:
    """Return values by displacement and position, (w, w, a, b), at the positions they lead to.

    Parameters
    ----------
    values : (w, w, a, b) array
        Values by next displacement and position.
    costs : WindowCosts
        What is added to them.
    source, target : Box
        Positions that are left, and that are reached; beside the latter there is anything.
    """
    result = np.empty_like(values)
    width, _, rows, columns = values.shape
    if is_compiled():
        parts = (
            values,
            costs.risks,
            costs.blocked,
            (costs.weight, costs.most, costs.late),
            costs.in_time,
        )
        shape = width, rows, columns
        _compiled.lattice_move(shape, INFEASIBLE, source, target, *parts, result)
    else:
        _move(values, costs, source, target, result)
    return result


def _move(values: Float32, costs: WindowCosts, source: Box, target: Box, into: Float32) -> None:
    """Move values by displacements, without compiled code."""
    width, _, rows, columns = values.shape
    risks = costs.risks.reshape(values.shape)
    totals = values + np.float32(costs.weight) * risks
    blocked = np.unpackbits(costs.blocked, count=values.size).view(np.bool_).reshape(values.shape)
    totals[blocked | (risks > np.float32(costs.most)) | (totals >= _LIMIT)] = INFEASIBLE
    into.fill(INFEASIBLE)
    for i, j in product(range(width), repeat=2):
        down, right = i - width // 2, j - width // 2
        top, bottom = max(source[0], target[0] - down), min(source[1], target[1] - down)
        left, end = max(source[2], target[2] - right), min(source[3], target[3] - right)
        if top < bottom and left < end:
            reached = into[i, j, top + down : bottom + down, left + right : end + right]
            reached[:] = totals[i, j, top:bottom, left:end]
    is_late = np.ones((rows, columns), dtype=np.bool_)
    is_late[costs.in_time[0] : costs.in_time[1], costs.in_time[2] : costs.in_time[3]] = False
    into[:, :, is_late] += np.float32(costs.late)
