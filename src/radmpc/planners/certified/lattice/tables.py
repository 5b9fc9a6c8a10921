"""Values of a lattice search as arrays: tails from a table, changes of displacement, and moves.

Of the values of a search eight or nine tenths are infeasible, blocked or out of reach. What is kept
of each window is a bit for all and a value for the others (of a map of 32 x 32 cells 3 MB, not 26).
"""

from __future__ import annotations

from functools import cache
from itertools import product

import numpy as np
import numpy.typing as npt

from radmpc.arrays import Vector
from radmpc.gaussian import Tail
from radmpc.records import dataclass

__all__ = ["INFEASIBLE", "FeasibleValues", "Float32", "changed", "shifted", "tail_of"]

INFEASIBLE = np.float32(1e9)
"""Value of what is not allowed: large beside any plan's cost, finite when summed over a path."""

_FINENESS = 64
"""Entries of the table of tails per standard deviation [-]."""

_FAR = 10
"""Clearance beyond which there is no risk (8e-24) [standard deviations]."""

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
    """

    bits: npt.NDArray[np.uint8]
    values: Float32
    shape: tuple[int, ...]

    @classmethod
    def of(cls, values: Float32) -> FeasibleValues:
        """Return the values of an array."""
        is_feasible = values < 0.5 * INFEASIBLE
        return cls(np.packbits(is_feasible), values[is_feasible], values.shape)

    def whole(self) -> Float32:
        """Return the array, infeasible values all the same."""
        whole = np.full(self.shape, INFEASIBLE, dtype=np.float32)
        is_feasible = np.unpackbits(self.bits, count=whole.size).view(np.bool_)
        whole.ravel()[is_feasible] = self.values
        return whole


@cache
def _tails(tail: Tail) -> Vector:
    """Return the tail probability at every sixty-fourth of a standard deviation."""
    return tail.probability(np.arange(-_FAR * _FINENESS, _FAR * _FINENESS + 1) / _FINENESS)


def tail_of(clearances: Vector | Float32, tail: Tail) -> Vector:
    """Return tail probabilities, rounded to the clearances of a table.

    Parameters
    ----------
    clearances : array
        In standard deviations.
    tail : Tail
        Whose probabilities.
    """
    tails = _tails(tail)
    numbers = (clearances * _FINENESS).astype(np.int64) + _FAR * _FINENESS
    return tails[np.clip(numbers, 0, tails.size - 1)]


def changed(values: Float32, tables: tuple[Float32, Float32]) -> Float32:
    """Return the least value over all last displacements, for each position and *next* one.

    Parameters
    ----------
    values : (w, w, a, b) array
        Values by last displacement and position.
    tables : pair of (w, w) array
        Effort from one displacement to the next along each axis, [next, last].

    Returns
    -------
    (w, w, a, b) array
        Values by next displacement and position.
    """
    for axis, table in enumerate(tables):
        source = np.moveaxis(values, axis, 0)
        result = np.full_like(source, INFEASIBLE)
        for after, before in zip(*np.nonzero(table < INFEASIBLE), strict=True):
            np.minimum(result[after], source[before] + table[after, before], out=result[after])
        values = np.moveaxis(result, 0, axis)
    return np.ascontiguousarray(values)


def shifted(values: Float32) -> Float32:
    """Return values by displacement and position, (w, w, a, b), at the positions they lead to."""
    result = np.full_like(values, INFEASIBLE)
    rows, columns = values.shape[2:]
    reach = values.shape[0] // 2
    for i, j in product(range(values.shape[0]), range(values.shape[1])):
        here, ahead = _overlap(rows, i - reach), _overlap(columns, j - reach)
        result[i, j][here[1], ahead[1]] = values[i, j][here[0], ahead[0]]
    return result


def _overlap(count: int, shift: int) -> tuple[slice, slice]:
    """Return which indices move by a shift to which, along one axis."""
    if shift >= 0:
        return slice(0, max(count - shift, 0)), slice(shift, count)
    return slice(-shift, count), slice(0, max(count + shift, 0))
