"""Where a linear program of turning ended, to begin there once its half-spaces are turned anew.

HiGHS forgets which rows were active when they are taken away. A half-space that was active is so
from the first in the next program, and gives up what it gives up on the latest paths.
"""

from __future__ import annotations

from typing import Self

import numpy as np
import numpy.typing as npt

from radmpc.arrays import Indices, Matrix, Tensor, Vector
from radmpc.records import dataclass
from radmpc.solvers.lp.quiet_highs import BASIC, FREE, LOWER, UPPER

__all__ = ["Bounds", "KeptBasis", "Offered"]

Flags = npt.NDArray[np.bool_]

Bounds = tuple[Vector, Vector]
"""Lower and upper ones."""

_ROUNDING = 1e-9
"""Length by which what is given up may miss the end of a part [m]."""


@dataclass(frozen=True, slots=True, eq=False)
class Offered:
    """Half-spaces in a program, w of them with e ends and r rows.

    Attributes
    ----------
    end_keys : (w, e) int array
        The same for the same end of the same half-space.
    row_keys : (r,) int array
        The same for the same row.
    row_ends : (r,) int array
        The end of each row, numbered half-space by half-space.
    lengths : (w, e, m) array
        Parts that may be given up there, the cheapest first [m].
    given_up : (w, e) array
        What the latest paths give up in all [m].
    """

    end_keys: Indices
    row_keys: Indices
    row_ends: Indices
    lengths: Tensor
    given_up: Matrix


@dataclass(frozen=True, slots=True, eq=False)
class KeptBasis:
    """Where columns and rows that stay were, and what was active of those that were exchanged.

    Attributes
    ----------
    columns, rows : int array
        Where each that stays is.
    nearest : int array
        The bound that each column is nearer to.
    order : int array
        Basic columns that stay, those nearest to a bound first.
    active : (a,) int array
        Keys of rows that were active.
    basic : (b,) int array
        Keys of ends at which something was given up in part, which was basic.
    """

    columns: Indices
    rows: Indices
    nearest: Indices
    order: Indices
    active: Indices
    basic: Indices

    @classmethod
    def of(
        cls,
        is_basic: tuple[Flags, Flags],
        values: tuple[Vector, Vector],
        bounds: tuple[Bounds, Bounds],
        exchanged: tuple[Indices, Indices],
    ) -> Self:
        """Return a basis, told by columns and rows that stay, and what was exchanged.

        Parameters
        ----------
        is_basic : tuple of bool array
            Which columns, and which rows, are basic.
        values : tuple of array
            Columns, and the left sides of rows.
        bounds : tuple of Bounds
            Of columns, and of rows.
        exchanged : tuple of int array
            Keys of active rows, and of ends with a basic column.
        """
        columns, rows = (_where(*each) for each in zip(is_basic, values, bounds, strict=True))
        (lower, upper), found = bounds[0], values[0]
        room = np.minimum(found - lower, upper - found)
        nearest = np.where(found - lower < upper - found, LOWER, UPPER)
        bounded = np.flatnonzero(is_basic[0] & np.isfinite(room))
        return cls(columns, rows, nearest, bounded[room[bounded].argsort()], *exchanged)

    def in_program(self, offered: Offered) -> tuple[Indices, Indices]:
        """Return where all columns and rows are in a program with the same of them that stay.

        Parameters
        ----------
        offered : Offered
            Half-spaces that were exchanged for others.
        """
        is_active = np.isin(offered.row_keys, self.active)
        held = np.zeros(offered.end_keys.size, dtype=bool)
        held[offered.row_ends[is_active]] = True
        is_basic = np.isin(offered.end_keys, self.basic)
        where = _given_up(offered, held.reshape(is_basic.shape), is_basic)
        columns = np.concatenate([self.columns, where.ravel()])
        rows = np.append(self.rows, np.where(is_active, LOWER, BASIC))
        # Of half-spaces that are gone, columns were basic that nothing determines any more.
        more = np.count_nonzero(columns == BASIC) + np.count_nonzero(rows == BASIC) - rows.size
        left_over = self.order[: max(more, 0)]
        columns[left_over] = self.nearest[left_over]
        return columns, rows


def _where(is_basic: Flags, values: Vector, bounds: Bounds) -> Indices:
    """Return where columns or rows are."""
    lower, upper = bounds
    where = np.where(np.abs(upper - values) < np.abs(values - lower), UPPER, LOWER)
    where[np.isinf(lower) & np.isinf(upper)] = FREE
    where[is_basic] = BASIC
    return where


def _given_up(offered: Offered, is_held: Flags, is_basic: Flags) -> Indices:
    """Return where the columns of what is given up are, the last of each end what is missed."""
    ends = np.cumsum(offered.lengths, axis=2)
    part = (ends <= offered.given_up[..., None] + _ROUNDING).sum(axis=2)[..., None]
    part = np.minimum(part, offered.lengths.shape[2] - 1)
    number = np.arange(offered.lengths.shape[2] + 1)
    where = np.where((number < part) & is_held[..., None], UPPER, LOWER)
    return np.where((number == part) & is_basic[..., None], BASIC, where)
