"""Rating points with NumPy alone: what compiled code does, where there is none."""

from __future__ import annotations

import numpy as np

from radmpc.arrays import Indices, Integers, Matrix, Vector
from radmpc.gaussian import clearance
from radmpc.program.program import DisjunctiveProgram

__all__ = ["NumpyRatings"]

_Rated = tuple[Vector, Vector, Indices, Matrix, float, float]


class NumpyRatings:
    """A program laid out for rating by whole arrays.

    Parameters
    ----------
    program : DisjunctiveProgram
        The program.
    table : (v, w) int array
        The possible alternatives of every avoidance, padded with −1.
    reference : float
        The clearance that shortfalls are measured from [standard deviations].
    """

    def __init__(self, program: DisjunctiveProgram, table: Integers, reference: float) -> None:
        self._program = program
        self._table = table
        deviations = program.rows.deviations
        noisy = deviations > 0.0
        self._inverse = np.where(noisy, 1.0 / np.where(noisy, deviations, 1.0), 0.0)
        self._certain = ~noisy
        self._reference = deviations * reference
        blank = table < 0
        self._beyond = np.where(blank, np.inf, 0.0)
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
        if self._is_single and program.num_alternatives:
            # One row per alternative: the table of alternatives is a table of rows.
            self._row_table = np.where(blank, 0, self._rows[table])

    def rate(self, z: Vector) -> _Rated:
        """Return clearances, least risks, selection, shortfalls, risk and its largest part.

        Parameters
        ----------
        z : (n,) array
            A point of the program, which has avoidances.
        """
        program = self._program
        slacks = program.slacks(z)
        clearances = self._in_deviations(slacks)
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
            by_alternative = np.add.reduceat(by_event, self._starts_of_events)[self._table]
            short = np.maximum.reduceat(misses[members], self._starts)[self._table]
        by_alternative += self._beyond
        short += self._beyond
        places = by_alternative.argmin(axis=1)
        cheapest = by_alternative[self._every, places]
        selection = self._table[self._every, places].astype(np.int64)
        return clearances, cheapest, selection, short, *self._total(z, selection, cheapest)

    def clearances(self, z: Vector) -> Vector:
        """Return every row's slack at a point, (r,) [standard deviations].

        Parameters
        ----------
        z : (n,) array
            A point of the program.
        """
        return self._in_deviations(self._program.slacks(z))

    def _in_deviations(self, slacks: Vector) -> Vector:
        """Return slacks over standard deviations; without noise ±inf."""
        clearances: Vector = slacks * self._inverse
        if self._certain.any():
            certain = slacks[self._certain]
            clearances[self._certain] = clearance(certain, np.zeros(certain.size))
        return clearances

    def _total(self, z: Vector, selection: Indices, cheapest: Vector) -> tuple[float, float]:
        """Return the risk of a selection, and its largest part."""
        if self._is_single and self._is_distinct:
            return float(cheapest.sum()), float(cheapest.max())
        by_event = self._program.event_risks(z, selection)
        return float(by_event.sum()), float(by_event.max(initial=0.0))

    @property
    def _is_distinct(self) -> bool:
        """Whether no two rows share an event."""
        return self._program.rows.risk_items.size == self._program.rows.count
