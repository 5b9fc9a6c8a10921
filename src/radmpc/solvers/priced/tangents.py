"""Tangents added where the chosen rows' risk is underestimated, and which rows those are."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from radmpc.arrays import Indices, Vector
from radmpc.solvers.priced.lp import RiskLp
from radmpc.solvers.priced.rating import Rating
from radmpc.solvers.priced.row_tangents import RowTangents

__all__ = ["Tangents"]

_FLAT = 1e-7
"""Share of the unit below which a tangent is no better than t >= 0 [-]: none is added there."""


class Tangents:
    """Which rows of chosen alternatives need more tangents.

    Parameters
    ----------
    rows : RowTangents
        The rows of the program.
    unit : float
        Risk budget: the risk that a column's 1 stands for.
    """

    def __init__(self, rows: RowTangents, unit: float) -> None:
        self._unit = unit
        self._flat = float(rows.tail.clearance_for(_FLAT * unit))
        self._is_noisy, self._rows_of = rows.is_noisy, rows.rows_of
        self._latest: tuple[Sequence[int], Indices] = ((), np.zeros(0, dtype=np.int64))

    def rows(self, alternatives: Sequence[int]) -> list[int]:
        """Return the rows of alternatives."""
        return [row for alternative in alternatives for row in self._rows_of[alternative]]

    def noisy_rows(self, alternatives: Sequence[int]) -> Indices:
        """Return the distinct rows with noise of alternatives."""
        if self._latest[0] is not alternatives:
            rows = {row for row in self.rows(alternatives) if self._is_noisy[row]}
            self._latest = alternatives, np.array(sorted(rows), dtype=np.int64)
        return self._latest[1]

    def refine(
        self,
        lp: RiskLp,
        chosen: Sequence[int],
        point: Vector,
        rating: Rating,
        *,
        tolerance: float,
    ) -> bool:
        """Add tangents where the chosen rows' risk is underestimated.

        Parameters
        ----------
        lp : RiskLp
            Solved, the chosen rows active.
        chosen : sequence of int
            Alternatives.
        point : (c,) array
            All columns of its solution.
        rating : Rating
            Of its decision variables.
        tolerance : float
            Value by which risks may be underestimated in all.

        Returns
        -------
        bool
            Whether there was any to add.
        """
        rows = self.noisy_rows(chosen)
        if rows.size == 0:
            return False
        # Rows of one event share a column: a row below its share must not offset another above.
        missing = np.maximum(rating.risks(rows) - lp.allocated(rows, point), 0.0)
        missing *= lp.price / self._unit
        if missing.sum() <= tolerance:
            return False
        return self.add(lp, rows[missing > tolerance / (4.0 * rows.size)], rating)

    def add(self, lp: RiskLp, rows: Indices, rating: Rating) -> bool:
        """Add tangents of rows at a point, unless they hold by far; return whether any was added.

        Parameters
        ----------
        lp : RiskLp
            Solved, the rows active.
        rows : (k,) int array
            Rows with noise.
        rating : Rating
            Of the point.
        """
        clearances = rating.clearances[rows]
        near = clearances < self._flat
        if not near.any():
            return False
        return lp.add_tangents(rows[near].tolist(), np.maximum(clearances[near], lp.floor))
