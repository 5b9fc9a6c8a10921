"""Chance rows in a linear program, kept by compiled code."""

from __future__ import annotations

from functools import cached_property

import numpy as np

from radmpc.arrays import Vector
from radmpc.solvers import _compiled
from radmpc.solvers.lp.bounded_lp import floats
from radmpc.solvers.lp.simplex_lp import SimplexLp
from radmpc.solvers.priced.rating import Rater, Rating
from radmpc.solvers.priced.risk_rows import FLAT, RiskRows, Surroundings
from radmpc.solvers.priced.tuning import TUNING

__all__ = ["CompiledRiskRows"]


class CompiledRiskRows(RiskRows):
    """`RiskRows` in compiled code.

    Parameters
    ----------
    around : Surroundings
        What rows are added to, a `SimplexLp`.
    rater : Rater
        The same program laid out for rating, for the same unit.
    """

    def __init__(self, around: Surroundings, rater: Rater) -> None:
        self._around, self._rater = around, rater

    @property
    def lp(self) -> SimplexLp:
        """What rows are added to."""
        lp = self._around.lp
        assert isinstance(lp, SimplexLp)
        return lp

    @property
    def crowd(self) -> int:
        """Rows beyond which those switched off are dropped [-]."""
        return self._around.crowd

    @cached_property
    def compiled(self) -> _compiled.RiskRows:
        """The rows, laid out when first needed."""
        around, first = self._around, self._rater.tangents.first
        program, unit = around.program, around.unit
        num_blocks = int(program.blocks.max(initial=0)) + 1
        has_block = np.zeros((len(around.bound_rows), num_blocks), dtype=bool)
        for bound, (blocks, _) in enumerate(around.bound_rows):
            has_block[bound, list(blocks)] = True
        return _compiled.RiskRows(
            self.lp.compiled,
            self._rater.compiled,
            floats(program.rows.deviations),
            program.blocks.astype(np.int32),
            np.array([row for _, row in around.bound_rows], dtype=np.int32),
            has_block,
            first.clearances,
            first.slopes,
            first.heights,
            around.budget_row,
            unit,
            around.price,
            around.row_scale,
            self._rater.row_cap,
            self._rater.tangents.floor,
            float(program.tail.clearance_for(FLAT * unit)),
        )

    def activate(self, alternatives: tuple[int, ...]) -> bool:
        """Switch the rows of alternatives on, see `RiskRows.activate`.

        Parameters
        ----------
        alternatives : tuple of int
            Their numbers.
        """
        return self.compiled.activate(alternatives, self.crowd, TUNING.crowd_each)

    def refine(self, rating: Rating, point: Vector, tolerance: float) -> bool:
        """Add tangents where risk is underestimated, see `RiskRows.refine`.

        Parameters
        ----------
        rating : Rating
            Of the decision variables of a point.
        point : (c,) array
            All columns of it.
        tolerance : float
            Share of the unit by which risks may be underestimated in all [-].
        """
        return self.compiled.refine(rating.clearances, point, tolerance)
