"""Rating a point by its true risks: every avoidance at its alternative of least risk."""

from __future__ import annotations

from functools import cached_property

import numpy as np
import numpy.typing as npt
from scipy.sparse import csr_array

from radmpc.arrays import Indices, Vector
from radmpc.gaussian import CONVEX_RISK, Tail
from radmpc.program.program import DisjunctiveProgram
from radmpc.records import dataclass
from radmpc.solvers.compiled_code import is_compiled
from radmpc.solvers.lp.outcome import Numbers
from radmpc.solvers.priced.numpy_rating import NumpyRatings
from radmpc.solvers.priced.row_tangents import RowTangents
from radmpc.solvers.priced.tuning import TUNING
from radmpc.solvers.selection import alternative_table, possible_alternatives

if is_compiled():
    from radmpc.solvers import _compiled

__all__ = ["Rater", "Rating"]

_NOT_SENT = {"tangents", "compiled", "_plain"}
"""What other processes compute sooner than they receive it."""


@dataclass(frozen=True, slots=True, eq=False)
class Rating:
    """The risks of a point.

    Attributes
    ----------
    clearances : (r,) array
        Of every row [standard deviations].
    cheapest : (v,) array
        Least risk of any alternative of each avoidance.
    selection : (v,) int array
        The alternative that has it.
    short : (v, w) array
        By how much each alternative misses the reference clearance [m]; inf where there is none.
    risk : float
        Risk of the selection, shared rows counted once.
    largest : float
        Largest risk of a single row of the selection.
    tail : Tail
        Of what rows deviate by.
    """

    clearances: Vector
    cheapest: Vector
    selection: Indices
    short: Vector
    risk: float
    largest: float
    tail: Tail

    def risks(self, rows: Indices) -> Vector:
        """Return the risks of some rows.

        Parameters
        ----------
        rows : (k,) int array
            Which.
        """
        return self.tail.probability(self.clearances[rows])


class Rater:
    """A program laid out for rating.

    Parameters
    ----------
    program : DisjunctiveProgram
        The program.
    unit : float
        Risk budget; no row may risk more than it, nor than `CONVEX_RISK`.

    Attributes
    ----------
    row_cap : float
        Most that one row may risk.
    possible : (a,) bool array
        Which alternatives some admissible control can satisfy at that.
    table : (v, w) int array
        The possible alternatives of every avoidance, padded with −1.
    is_infeasible : bool
        Whether an avoidance has none, or a column no value.
    unit : float
        The risk budget.
    """

    def __init__(self, program: DisjunctiveProgram, unit: float) -> None:
        self.program = program
        self.unit = unit
        self.row_cap = min(unit, CONVEX_RISK)
        floor = program.rows.deviations * float(program.tail.clearance_for(self.row_cap))
        self.possible = possible_alternatives(program, floor)
        if program.parents is not None:
            # What others refine is no alternative of its own.
            self.possible[program.parents[program.parents >= 0]] = False
        self.table = alternative_table(program, self.possible)
        self._reference = float(
            program.tail.clearance_for(min(TUNING.reference * unit, CONVEX_RISK))
        )
        is_blank = bool(np.any((self.table < 0).all(axis=1)))
        self.is_infeasible = is_blank or bool(np.any(program.upper < program.lower))

    def rate(self, z: Vector) -> Rating:
        """Return a point's rating; infinite risk if an avoidance has no possible alternative."""
        program = self.program
        if program.num_avoidances and not self.is_infeasible and is_compiled():
            count = program.num_avoidances
            clearances, cheapest = np.empty(program.rows.count), np.empty(count)
            selection, short = np.empty(count, np.int64), np.empty(self.table.shape)
            parts = clearances, cheapest, selection, short
            risk, largest = self.compiled.rate(program.num_columns, z, *parts)
            return Rating(*parts, risk, largest, program.tail)
        return self._rated(z)

    def _rated(self, z: Vector) -> Rating:
        """Return a point's rating without compiled code."""
        program = self.program
        if program.num_avoidances == 0 or self.is_infeasible:
            risk = np.inf if self.is_infeasible else 0.0
            none = np.zeros(0)
            nothing = none, none.astype(np.int64), none.reshape(0, 1)
            return Rating(self._plain.clearances(z), *nothing, risk, risk, program.tail)
        return Rating(*self._plain.rate(z), program.tail)

    @cached_property
    def compiled(self) -> _compiled.Ratings:
        """The same for compiled code, where there is any."""
        program, rows = self.program, self.program.rows
        return _compiled.Ratings(
            *_parts(program.outputs),
            *_parts(rows.normals),
            program.constant,
            rows.offsets,
            rows.deviations,
            _numbers(self.table),
            _numbers(program.alternative_starts),
            _numbers(program.alternative_rows),
            _numbers(rows.events),
            program.num_columns,
            self.table.shape[1],
            rows.risk_items.size,
            program.tail.samples or 0,
            self._reference,
        )

    @cached_property
    def _plain(self) -> NumpyRatings:
        """The same for NumPy, made where it is asked for: it takes as much as the program."""
        return NumpyRatings(self.program, self.table, self._reference)

    def __getstate__(self) -> dict[str, object]:
        """Leave out what other processes compute sooner than they receive it."""
        return {name: value for name, value in vars(self).items() if name not in _NOT_SENT}

    @cached_property
    def tangents(self) -> RowTangents:
        """The tangents of its rows, shared by all searches at this unit."""
        return RowTangents(self.program, self.unit)


def _parts(matrix: csr_array) -> tuple[Numbers, Numbers, Vector]:
    """Return a sparse matrix as compiled code takes it."""
    return _numbers(matrix.indptr), _numbers(matrix.indices), matrix.data


def _numbers(values: npt.NDArray[np.signedinteger]) -> Numbers:
    """Return an array as compiled code takes it: itself, if it is so."""
    return np.ascontiguousarray(values, dtype=np.int32)
