"""One linear program kept alive in compiled code; what that cannot answer, HiGHS is asked."""

from __future__ import annotations

import numpy as np
from scipy.sparse import csr_array

from radmpc.arrays import Matrix, Vector
from radmpc.solvers import _compiled
from radmpc.solvers.lp.bounded_lp import BoundedLp, floats
from radmpc.solvers.lp.outcome import LpOutcome, Numbers

__all__ = ["LEAST_PIVOTS", "PIVOTS", "SimplexLp"]

_FEASIBILITY_TOL = 1e-9
"""Primal and dual feasibility tolerance [m, m/s, cost], that of HiGHS (`quiet_highs`)."""

LEAST_PIVOTS, PIVOTS = 500, 3
"""Pivots after which a solve is left to HiGHS [-], and how many more per row and column: no solve
of the benchmark families took a tenth of it."""

_OUTCOMES = (LpOutcome.OPTIMAL, LpOutcome.INFEASIBLE, LpOutcome.CUTOFF, LpOutcome.FAILED)
"""By the numbers of compiled code (`compiled/lp.h`)."""


class SimplexLp(BoundedLp):
    """A `BoundedLp` in compiled code.

    Parameters
    ----------
    cost, lower, upper : (n,) array
        Of the first columns; an infinite bound leaves nothing to be proven.

    Attributes
    ----------
    compiled : Program
        The program itself; what is added to it there counts here.
    """

    def __init__(self, cost: Vector, lower: Vector, upper: Vector) -> None:
        super().__init__()
        columns = floats(cost), floats(lower), floats(upper)
        self.compiled = _compiled.Program(*columns, _FEASIBILITY_TOL)
        self._point: Vector | None = None

    @property
    def num_columns(self) -> int:
        """Columns now."""
        return self.compiled.num_columns

    @property
    def num_rows(self) -> int:
        """Rows now."""
        return self.compiled.num_rows

    def solve(self, cutoff: float = float("inf")) -> tuple[LpOutcome, float]:
        """Minimize, see `BoundedLp.solve`.

        Parameters
        ----------
        cutoff : float
            Give up as soon as the cost is proven to be at least this.
        """
        self.solves += 1
        self._point = None
        most = LEAST_PIVOTS + PIVOTS * (self.num_rows + self.num_columns)
        number, bound = self.compiled.solve(cutoff, most)
        outcome = _OUTCOMES[number]
        return self._by_highs(cutoff) if outcome is LpOutcome.FAILED else (outcome, bound)

    def note(self, solves: int) -> None:
        """Take note of solves that compiled code did by itself.

        Parameters
        ----------
        solves : int
            How many.
        """
        self.solves += solves
        self._point = None

    def _by_highs(self, cutoff: float) -> tuple[LpOutcome, float]:
        """Solve a copy by HiGHS."""
        from radmpc.solvers.lp.highs_lp import HighsLp  # noqa: PLC0415 - few need it

        parts = self.compiled.contents()
        starts, columns = (np.frombuffer(part, dtype=np.int32) for part in parts[3:5])
        cost, lower, upper, values, row_lower, row_upper = (
            np.frombuffer(part) for part in (*parts[:3], *parts[5:])
        )
        copy = HighsLp(cost, lower, upper)
        shape = (self.num_rows, self.num_columns)
        copy.add_rows(csr_array((values, columns, starts), shape=shape), row_lower, row_upper)
        outcome, bound = copy.solve(cutoff)
        self.solves += copy.solves
        if outcome is LpOutcome.OPTIMAL:
            self._point = copy.point()
        return outcome, bound

    def point(self) -> Vector:
        """Return the columns of the last optimal solve."""
        if self._point is None:
            self._point = np.empty(self.num_columns)
            self.compiled.point(self._point)
        return self._point

    def basis(self) -> bytes:
        """Return where the last solve ended."""
        return self.compiled.basis()

    def begin_with(self, basis: bytes) -> None:
        """Begin the next solve where another one ended; if that is empty, where the last one did.

        Parameters
        ----------
        basis : bytes
            From `basis` of this program.
        """
        if basis:
            self.compiled.begin_with(basis)

    def _append_rows(
        self, starts: Numbers, columns: Numbers, values: Matrix, lower: Vector, upper: Vector
    ) -> None:
        self.compiled.add_rows(starts, columns, values, lower, upper)

    def _append_column(self, cost: float, upper: float, rows: Numbers, values: Vector) -> None:
        self.compiled.add_column(cost, upper, rows, values)

    def _bound_rows(self, rows: Numbers, lower: Vector, upper: Vector) -> None:
        self.compiled.bound_rows(rows, lower, upper)

    def _change_cost(self, cost: Vector) -> None:
        self.compiled.change_cost(cost)
