"""A linear program whose exchanged rows and columns have keys, by which its basis is kept."""

from __future__ import annotations

import numpy as np

from radmpc.arrays import Indices, Vector
from radmpc.records import dataclass
from radmpc.solvers.lp.exchange_lp import ExchangeLp
from radmpc.solvers.lp.quiet_highs import (
    BASIC,
    FEASIBILITY_TOL,
    LOWER,
    UPPER,
    basic_of,
    begin_with,
)

__all__ = ["Exchanged", "KeyedLp"]

_OPTIONS = (
    # Few pivots follow each change: exact edge weights cost more than they save, and so do scales
    # and perturbed costs, which are undone in the end.
    ("simplex_dual_edge_weight_strategy", 0),
    ("simplex_scale_strategy", 0),
    ("dual_simplex_cost_perturbation_multiplier", 0.0),
)

_NONE: Indices = np.zeros(0, dtype=np.int64)


@dataclass(frozen=True, slots=True, eq=False)
class Exchanged:
    """Columns that are at least 0, and rows without upper bounds, c and r of them.

    Attributes
    ----------
    cost : (c,) array
        Of the columns.
    column_keys : (c,) int array
        The same for the same column from exchange to exchange.
    starts : (r,) int array
        Where the entries of each row begin.
    columns : (e,) int array
        Columns of the entries; those exchanged are numbered on from those that stay.
    values : (e,) array
        The entries.
    lower : (r,) array
        Bounds of the rows.
    row_keys : (r,) int array
        The same for the same row.
    """

    cost: Vector
    column_keys: Indices
    starts: Indices
    columns: Indices
    values: Vector
    lower: Vector
    row_keys: Indices


class KeyedLp(ExchangeLp):
    """An `ExchangeLp` that begins where the last solve ended for what is exchanged as well.

    HiGHS forgets which rows were active once they are deleted. Those that come back are so from the
    first: that leaves a quarter of the pivots.
    """

    def __init__(self) -> None:
        super().__init__()
        for name, value in _OPTIONS:
            self._highs.setOptionValue(name, value)
        self._uppers = np.zeros(0)
        self._basis: tuple[Indices, Indices] | None = None
        self._ended: tuple[frozenset[int], frozenset[int]] = frozenset(), frozenset()
        self._keys = _NONE, _NONE

    @property
    def num_stay(self) -> int:
        """Number of columns that stay."""
        return self.num_columns - self._exchanged_columns

    def begin(self, columns: Indices, rows: Indices) -> None:
        """Begin the next solve with a basis of what stays; what is exchanged adds nothing to it.

        Parameters
        ----------
        columns, rows : int array
            Where each of them is, see `begin_with`.
        """
        self._basis, self._ended = (columns, rows), (frozenset(), frozenset())

    def add_columns(self, cost: Vector, lower: Vector, upper: Vector) -> int:
        """Append columns that stay; return the number of the first.

        Parameters
        ----------
        cost, lower, upper : (n,) array
            Costs and bounds, ±inf where there is none.
        """
        first = super().add_columns(cost, lower, upper)
        self._uppers = np.append(self._uppers[:first], upper)
        return first

    def bound_columns(self, first: int, lower: Vector, upper: Vector) -> None:
        """Give columns that stay other bounds.

        Parameters
        ----------
        first : int
            The first of them.
        lower, upper : (n,) array
            Bounds, ±inf where there is none.
        """
        numbers = np.arange(first, first + lower.size, dtype=np.int32)
        self._highs.changeColsBounds(lower.size, numbers, lower, upper)
        self._uppers[numbers] = upper
        if self._basis is not None:
            at = self._basis[0][numbers]
            at[np.isinf(np.where(at == UPPER, upper, lower))] = BASIC
            self._basis[0][numbers] = at

    def drop(self) -> None:
        """Take away what was exchanged last."""
        super().drop()
        self._keys = _NONE, _NONE

    def exchange(self, exchanged: Exchanged) -> None:
        """Put columns and rows in the place of all that were exchanged before.

        Parameters
        ----------
        exchanged : Exchanged
            What they are.
        """
        count, free = exchanged.lower.size, np.full(exchanged.cost.size, np.inf)
        self.drop()
        self.extend_columns(exchanged.cost, free)
        starts, columns = exchanged.starts.astype(np.int32), exchanged.columns.astype(np.int32)
        values, upper = exchanged.values, np.full(count, np.inf)
        self._highs.addRows(count, exchanged.lower, upper, values.size, starts, columns, values)
        self.num_rows += count
        self._exchanged_rows += count
        self._keys = exchanged.column_keys, exchanged.row_keys

    def solve(self, seconds: float = np.inf) -> Vector | None:
        """Minimize from where the last solve ended; return all columns, None without an optimum.

        Parameters
        ----------
        seconds : float
            After which it is given up [s].
        """
        if self._basis is not None:
            is_basic, is_active = (
                [key in ended for key in keys.tolist()]
                for keys, ended in zip(self._keys, self._ended, strict=True)
            )
            columns = np.concatenate([self._basis[0], np.where(is_basic, BASIC, LOWER)])
            rows = np.concatenate([self._basis[1], np.where(is_active, LOWER, BASIC)])
            begin_with(self._highs, columns, rows)
        values = super().solve(seconds)
        if values is None and self._basis is not None:
            values = super().solve(seconds)
        if values is None:
            self._basis = None
            return None
        columns, rows = basic_of(self._highs, self.num_columns, self.num_rows)
        stay = self.num_stay
        kept = self.num_rows - self._exchanged_rows
        is_upper = np.abs(self._uppers[:stay] - values[:stay]) <= FEASIBILITY_TOL
        self._basis = (
            np.where(columns[:stay], BASIC, np.where(is_upper, UPPER, LOWER)),
            np.where(rows[:kept], BASIC, LOWER),
        )
        basic, active = self._keys[0][columns[stay:]], self._keys[1][~rows[kept:]]
        self._ended = frozenset(basic.tolist()), frozenset(active.tolist())
        return values
