"""The linear program of optimal risk allocation: chosen rows with a column each for their risk.

On clearances q >= 0 the tail Q is convex and q is affine in the variables, so the tangents

    t >= (Q(q₀) − φ(q₀) (q − q₀)) / unit

never exceed Q: the program underestimates the risk of the chosen rows, and its optimum bounds
that of every solution which chooses them. A column t is measured in units of the budget and at
most 1, or what 0.5 is of a larger unit; with the tangent at that risk's clearance, that keeps
q >= 0 without a row of its own.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from radmpc.arrays import Vector
from radmpc.program.program import DisjunctiveProgram
from radmpc.solvers.compiled_code import is_compiled
from radmpc.solvers.lp.choosing import bounded_lp
from radmpc.solvers.lp.outcome import LpOutcome
from radmpc.solvers.priced.numpy_risk_rows import NumpyRiskRows
from radmpc.solvers.priced.rating import Rater, Rating
from radmpc.solvers.priced.risk_rows import RiskRows, Surroundings
from radmpc.solvers.priced.set_bounds import BoundRows, SetBound
from radmpc.solvers.priced.tuning import TUNING

if is_compiled():
    from radmpc.solvers.priced.compiled_risk_rows import CompiledRiskRows

__all__ = ["Basis", "RiskLp"]

Basis = tuple[int, bytes]
"""A vertex of a `RiskLp`: how often it was loaded by then, and the basis there."""

_INF = float("inf")
_DEAR = 1e6
"""Price from which rows with prices in them are scaled down [cost]: HiGHS refuses entries of
1e15."""


class RiskLp:
    """The program's hard rows, the chance rows seen so far, and their risk columns.

    Parameters
    ----------
    program : DisjunctiveProgram
        The program.
    unit : float
        Risk budget: the risk that a column's 1 stands for. The chosen rows may not risk more
        together, nor any of them more than `CONVEX_RISK`.
    price : float
        Cost of one unit of risk: the Lagrange multiplier of the risk bound.
    bounds : sequence of SetBound
        Proven lower bounds of parts, at this price.
    rater : Rater or None
        The program laid out for rating, if at hand; one made for another unit is not used.

    Attributes
    ----------
    row_cap : float
        Most that one row may risk.
    floor : float
        The clearance that this leaves [standard deviations].
    rater : Rater
        The program laid out for rating.
    rows : RiskRows
        The chance rows seen so far.
    starts : int
        How often it was loaded.
    dropped_solves : int
        Linear programs solved before rows were dropped.
    """

    def __init__(
        self,
        program: DisjunctiveProgram,
        unit: float,
        price: float,
        bounds: Sequence[SetBound] = (),
        rater: Rater | None = None,
    ) -> None:
        self.program = program
        self.unit = unit
        self.price = price
        # A rater made for another unit or program has other tangents.
        is_same = rater is not None and rater.unit == unit and rater.program.rows is program.rows
        self.rater = rater if rater is not None and is_same else Rater(program, unit)
        self.row_cap = self.rater.row_cap
        self.floor = self.rater.tangents.floor
        self._row_scale = 1.0 if price <= _DEAR else _DEAR / price
        self.dropped_solves = 0
        self.starts = 0
        self._bounds = BoundRows.of(program, bounds, price, self._row_scale)
        self._start()

    @property
    def solves(self) -> int:
        """Linear programs solved."""
        return self._lp.solves + self.dropped_solves

    def _start(self) -> None:
        """Load columns, hard rows and proven bounds; no chance row yet."""
        program = self.program
        self.starts += 1
        self._lp = bounded_lp(program.cost, program.lower, program.upper)
        self._lp.add_rows(program.hard, program.hard_lower, program.hard_upper)
        # No plan risks more than the whole unit, whatever the price.
        budget_row = self._lp.add_row(np.zeros(0, dtype=np.int32), np.zeros(0), -_INF, 1.0)
        bound_rows = self._add_bounds(budget_row)
        crowd = max(TUNING.crowd, TUNING.crowd_share * self._lp.num_rows)
        costs = self.unit, self.price, self._row_scale
        around = Surroundings(self._lp, program, *costs, budget_row, bound_rows, crowd)
        self.rows = _risk_rows(around, self.rater)

    def _add_bounds(self, budget_row: int) -> tuple[tuple[frozenset[int], int], ...]:
        """Load proven bounds; return their blocks and rows."""
        bounds = self._bounds
        rows, ones = np.array([budget_row], dtype=np.int32), np.ones(1)
        for _ in range(bounds.num_columns):
            # The budget's row holds it to one unit anyway; said here, it is finite.
            self._lp.add_column(self.price, 1.0, rows, ones)
        if not bounds.blocks:
            return ()
        packed = bounds.starts, bounds.columns, bounds.values
        first = self._lp.add_packed_rows(*packed, bounds.lower, np.full(len(bounds.lower), _INF))
        return tuple((blocks, first + row) for row, blocks in enumerate(bounds.blocks))

    def activate(self, alternatives: tuple[int, ...]) -> None:
        """Switch exactly the rows of these alternatives on, adding those that are new.

        Parameters
        ----------
        alternatives : tuple of int
            Their numbers.
        """
        if not self.rows.activate(alternatives):
            # Rows switched off still cost time in every pivot: begin again without them.
            self.restart()
            self.rows.activate(alternatives)

    def restart(self) -> None:
        """Begin again without any chance row."""
        self.dropped_solves += self._lp.solves
        self._start()

    def refine(self, rating: Rating, point: Vector, tolerance: float) -> bool:
        """Add tangents where the risk of the rows switched on is underestimated.

        Parameters
        ----------
        rating : Rating
            Of the decision variables of a point.
        point : (c,) array
            All columns of it.
        tolerance : float
            Share of the unit by which risks may be underestimated in all [-].

        Returns
        -------
        bool
            Whether any was added.
        """
        return self.rows.refine(rating, point, tolerance)

    def solve(self, cutoff: float = _INF) -> tuple[LpOutcome, float]:
        """Minimize over the active rows; see `BoundedLp.solve`."""
        return self._lp.solve(cutoff)

    def basis(self) -> Basis:
        """Return where the last solve ended."""
        return self.starts, self._lp.basis()

    def begin_with(self, basis: Basis) -> None:
        """Begin the next solve where another one ended, unless rows were dropped since.

        Parameters
        ----------
        basis : (int, bytes)
            From `basis`.
        """
        starts, vertex = basis
        if starts == self.starts:
            self._lp.begin_with(vertex)

    def point(self) -> Vector:
        """Return the decision variables, then all other columns, of the last optimal solve."""
        return self._lp.point()


def _risk_rows(around: Surroundings, rater: Rater) -> RiskRows:
    """Return no chance rows yet."""
    if is_compiled():
        return CompiledRiskRows(around, rater)
    return NumpyRiskRows(around, rater.tangents)
