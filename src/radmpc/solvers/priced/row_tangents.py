"""The rows that tangents to the risk of chance rows are in a linear program."""

from __future__ import annotations

import numpy as np

from radmpc.arrays import Matrix, Vector
from radmpc.gaussian import CONVEX_RISK, GAUSSIAN, Tail
from radmpc.program.program import DisjunctiveProgram
from radmpc.records import dataclass
from radmpc.solvers.lp.outcome import Numbers
from radmpc.solvers.priced.tuning import TUNING

__all__ = ["RowTangents", "Touching"]


@dataclass(frozen=True, slots=True, eq=False)
class Touching:
    """Tangents ``t + slope · q >= height`` to a tail, t in units, and where they touch it.

    Attributes
    ----------
    clearances, slopes, heights : (k,) array
        q [standard deviations], [units per standard deviation], [units].
    """

    clearances: Vector
    slopes: Vector
    heights: Vector

    @classmethod
    def at(cls, clearances: Vector, unit: float, tail: Tail = GAUSSIAN) -> Touching:
        """Return the tangents at some clearances.

        Parameters
        ----------
        clearances : (k,) array
            Where they touch, >= 0 [standard deviations].
        unit : float
            The risk that a column's 1 stands for.
        tail : Tail
            What they touch.
        """
        slopes = -tail.slope(clearances) / unit
        return cls(clearances, slopes, tail.probability(clearances) / unit + slopes * clearances)


class _RowsOf(dict[int, list[int]]):
    """The rows of alternatives, as far as they were asked for."""

    def __init__(self, program: DisjunctiveProgram) -> None:
        self._program = program

    def __missing__(self, alternative: int) -> list[int]:
        rows: list[int] = self._program.rows_of(alternative).tolist()
        self[alternative] = rows
        return rows


class RowTangents:
    """Tangents to the risk of a program's chance rows, computed once for all searches of it.

    Parameters
    ----------
    program : DisjunctiveProgram
        The program.
    unit : float
        Risk budget: the risk that a column's 1 stands for.

    Attributes
    ----------
    row_cap : float
        Most that one row may risk.
    floor : float
        The clearance that this leaves [standard deviations].
    right : (r,) array
        Right sides of the chance rows over the decision variables [m].
    first : Touching
        The tangents that a row begins with.
    tail : Tail
        Of what rows deviate by.
    is_noisy : bytes
        Whether each row has noise, 1 or 0; without it has no tangents.
    events : memoryview of int
        The event of each row.
    rows_of : mapping of int to list of int
        The rows of each alternative.
    """

    def __init__(self, program: DisjunctiveProgram, unit: float) -> None:
        rows = program.rows
        self._program = program
        self.tail = program.tail
        self.row_cap = min(unit, CONVEX_RISK)
        self.floor = float(self.tail.clearance_for(self.row_cap))
        self.right: Vector = rows.offsets - rows.normals @ program.constant
        at = (self.floor, *(q for q in TUNING.first_tangents if q > self.floor + 0.2))
        self.first = Touching.at(np.array(at), unit, self.tail)
        # Searches ask for a few of a hundred thousand rows: lists of all take 12 MB a program.
        self.is_noisy = (rows.deviations > 0.0).tobytes()
        self.events = rows.events.data
        self.rows_of = _RowsOf(program)
        self._coefficients: dict[int, tuple[Numbers, Vector]] = {}
        self._beginnings: dict[int, tuple[Numbers, Matrix, Vector]] = {}

    def coefficients(self, row: int) -> tuple[Numbers, Vector]:
        """Return a chance row over the decision variables: the columns it touches, its values."""
        cached = self._coefficients.get(row)
        if cached is None:
            cached = self._coefficients[row] = self._program.column_row(row)
        return cached

    def beginning(self, row: int, risk_column: int) -> tuple[Numbers, Matrix, Vector]:
        """Return a row's first tangents.

        Parameters
        ----------
        row : int
            A row with noise.
        risk_column : int
            The column of its risk.

        Returns
        -------
        (k, w) int array, (k, w) and (k,) array
            Columns, coefficients and lower bounds; the columns are good until the next call.
        """
        cached = self._beginnings.get(row)
        if cached is None:
            cached = self._beginnings[row] = self._tangents(row, self.first)
        cached[0][:, -1] = risk_column
        return cached

    def tangents(
        self, row: int, touching: Touching, risk_column: int
    ) -> tuple[Numbers, Matrix, Vector]:
        """Return tangents of a row with noise, as `beginning` does.

        Parameters
        ----------
        row : int
            The row.
        touching : Touching
            The tangents.
        risk_column : int
            The column of its risk.
        """
        columns, entries, lowers = self._tangents(row, touching)
        columns[:, -1] = risk_column
        return columns, entries, lowers

    def _tangents(self, row: int, touching: Touching) -> tuple[Numbers, Matrix, Vector]:
        """Return tangents of a row, the column of its risk left open."""
        touched, values = self.coefficients(row)
        steepness = touching.slopes / float(self._program.rows.deviations[row])
        columns = np.empty((steepness.size, touched.size + 1), dtype=np.int32)
        columns[:, :-1] = touched
        entries = np.ones(columns.shape)
        np.multiply(-steepness[:, None], values, out=entries[:, :-1])
        return columns, entries, touching.heights - steepness * self.right[row]
