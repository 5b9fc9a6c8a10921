"""Rating a point by its true risks: every avoidance at its alternative of least risk."""

from __future__ import annotations

from functools import cached_property

import numpy as np
import numpy.typing as npt
from scipy.sparse import csr_array

from radmpc.arrays import Indices, Vector
from radmpc.gaussian import CONVEX_RISK, Tail, clearance
from radmpc.program.program import DisjunctiveProgram
from radmpc.records import dataclass
from radmpc.solvers.compiled_code import is_compiled
from radmpc.solvers.lp.outcome import Numbers
from radmpc.solvers.priced.row_tangents import RowTangents
from radmpc.solvers.priced.tuning import TUNING
from radmpc.solvers.selection import alternative_table, possible_alternatives

if is_compiled():
    from radmpc.solvers import _compiled

__all__ = ["Rater", "Rating"]

_NOT_SENT = {"tangents", "compiled"}
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
    floor : (r,) array
        The margin of each row that this leaves [m].
    unit : float
        The risk budget.
    """

    def __init__(self, program: DisjunctiveProgram, unit: float) -> None:
        self.program = program
        self.unit = unit
        deviations = program.rows.deviations
        noisy = deviations > 0.0
        self._inverse = np.where(noisy, 1.0 / np.where(noisy, deviations, 1.0), 0.0)
        self._certain = ~noisy
        self.row_cap = min(unit, CONVEX_RISK)
        self.floor = deviations * float(program.tail.clearance_for(self.row_cap))
        self.possible = possible_alternatives(program, self.floor)
        if program.parents is not None:
            # What others refine is no alternative of its own.
            self.possible[program.parents[program.parents >= 0]] = False
        self._reference = deviations * float(
            program.tail.clearance_for(min(TUNING.reference * unit, CONVEX_RISK))
        )
        self.table = alternative_table(program, self.possible)
        self._blank = self.table < 0
        self._beyond = np.where(self._blank, np.inf, 0.0)
        self._every = np.arange(program.num_avoidances)
        starts = program.alternative_starts
        self._starts = starts[:-1]
        self._rows = program.alternative_rows
        self._is_single = bool(np.all(np.diff(starts) == 1))
        # Rows of one event are neighbors within an alternative and are charged once.
        owners = program.entry_owners()
        events = program.rows.events[self._rows]
        begins = np.append(True, (np.diff(owners) != 0) | (np.diff(events) != 0))[: owners.size]
        self._event_starts = np.flatnonzero(begins)
        self._has_twins = self._event_starts.size < owners.size
        self._starts_of_events = np.searchsorted(self._event_starts, self._starts)
        self.is_infeasible = bool(np.any(self._blank.all(axis=1))) or bool(
            np.any(program.upper < program.lower)
        )
        if self._is_single and program.num_alternatives:
            # One row per alternative: the table of alternatives is a table of rows.
            self._row_table = np.where(self._blank, 0, self._rows[self.table])

    def rate(self, z: Vector) -> Rating:
        """Return a point's rating; infinite risk if an avoidance has no possible alternative."""
        program = self.program
        if program.num_avoidances and not self.is_infeasible and is_compiled():
            clearances, cheapest = np.empty(program.rows.count), np.empty(self._every.size)
            selection, short = np.empty(self._every.size, np.int64), np.empty(self.table.shape)
            parts = clearances, cheapest, selection, short
            risk, largest = self.compiled.rate(program.num_columns, z, *parts)
            return Rating(*parts, risk, largest, program.tail)
        return self._rated(z)

    def _rated(self, z: Vector) -> Rating:
        """Return a point's rating without compiled code."""
        program = self.program
        slacks = program.slacks(z)
        clearances = slacks * self._inverse
        if self._certain.any():
            certain = slacks[self._certain]
            clearances[self._certain] = clearance(certain, np.zeros(certain.size))
        if program.num_avoidances == 0 or self.is_infeasible:
            risk = np.inf if self.is_infeasible else 0.0
            none = np.zeros(0)
            nothing = none, none.astype(np.int64), none.reshape(0, 1)
            return Rating(clearances, *nothing, risk, risk, program.tail)
        risks: Vector = np.asarray(program.tail.probability(clearances))
        misses = self._reference - slacks
        if self._is_single:
            by_alternative = risks[self._row_table]
            short = misses[self._row_table]
        else:
            members = self._rows
            by_event = risks[members]
            if self._has_twins:
                by_event = np.maximum.reduceat(by_event, self._event_starts)
            by_alternative = np.add.reduceat(by_event, self._starts_of_events)[self.table]
            short = np.maximum.reduceat(misses[members], self._starts)[self.table]
        by_alternative += self._beyond
        short += self._beyond
        places = by_alternative.argmin(axis=1)
        cheapest = by_alternative[self._every, places]
        selection = self.table[self._every, places]
        risk, largest = self._total(z, selection, cheapest)
        return Rating(clearances, cheapest, selection, short, risk, largest, program.tail)

    @cached_property
    def compiled(self) -> _compiled.Ratings:
        """The same for compiled code, where there is any."""
        program, rows = self.program, self.program.rows
        return _compiled.Ratings(
            *_parts(program.outputs),
            *_parts(rows.normals),
            program.constant,
            rows.offsets,
            self._inverse,
            self._reference,
            _numbers(self.table),
            _numbers(program.alternative_starts),
            _numbers(program.alternative_rows),
            _numbers(rows.events),
            program.num_columns,
            self.table.shape[1],
            rows.risk_items.size,
            program.tail.samples or 0,
        )

    def _total(self, z: Vector, selection: Indices, cheapest: Vector) -> tuple[float, float]:
        """Return the risk of a selection, and its largest part."""
        if self._is_single and self._is_distinct:
            return float(cheapest.sum()), float(cheapest.max())
        by_event = self.program.event_risks(z, selection)
        return float(by_event.sum()), float(by_event.max(initial=0.0))

    def __getstate__(self) -> dict[str, object]:
        """Leave out what other processes compute sooner than they receive it."""
        return {name: value for name, value in vars(self).items() if name not in _NOT_SENT}

    @cached_property
    def tangents(self) -> RowTangents:
        """The tangents of its rows, shared by all searches at this unit."""
        return RowTangents(self.program, self.unit)

    @property
    def _is_distinct(self) -> bool:
        """Whether no two rows share an event."""
        return self.program.rows.risk_items.size == self.program.rows.count


def _parts(matrix: csr_array) -> tuple[Numbers, Numbers, Vector]:
    """Return a sparse matrix as compiled code takes it."""
    return _numbers(matrix.indptr), _numbers(matrix.indices), matrix.data


def _numbers(values: npt.NDArray[np.signedinteger]) -> Numbers:
    """Return an array as compiled code takes it: itself, if it is so."""
    return np.ascontiguousarray(values, dtype=np.int32)
