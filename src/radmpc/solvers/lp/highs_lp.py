"""One linear program kept alive in HiGHS: grown by rows and columns, solved warm.

What HiGHS reports is not a proof: bounds and infeasibility are what its dual values prove of a copy
of the program.
"""

from __future__ import annotations

from collections.abc import Iterator

import highspy
import numpy as np

from radmpc.arrays import Matrix, Vector
from radmpc.solvers.lp.bounded_lp import BoundedLp
from radmpc.solvers.lp.outcome import NO_NUMBERS, NO_VALUES, LpOutcome, Numbers
from radmpc.solvers.lp.quiet_highs import FEASIBILITY_TOL, array_of, checked, quiet_highs
from radmpc.solvers.lp.safe_bound import LpRecord

__all__ = ["HighsLp"]

_DUAL_SIMPLEX = (
    ("presolve", "off"),
    ("solver", "simplex"),
    ("simplex_strategy", 1),
    # Few pivots follow each change: exact edge weights cost more than they save.
    ("simplex_dual_edge_weight_strategy", 0),
    # Meters, seconds and shares of a budget are of one order as they are, and warm vertices of a
    # search are left as they were found: scales and perturbed costs have to be undone every time.
    ("simplex_scale_strategy", 0),
    ("dual_simplex_cost_perturbation_multiplier", 0.0),
    ("primal_feasibility_tolerance", FEASIBILITY_TOL),
    ("dual_feasibility_tolerance", FEASIBILITY_TOL),
    # Tangents far out in the tail are flat, and still count where risk bounds are small.
    ("small_matrix_value", 1e-12),
)
"""Options of the warm dual simplex. Dantzig pricing took 10 to 18 % less time than steepest
edge. Without scales and perturbation it takes 40 % less in 76 searches of `fleet(64)` and
`paper(8)`, and a fifth fewer nodes. A solve that fails is repeated by HiGHS as it comes."""

_BEYOND = 1e-7
"""Share of the cutoff by which HiGHS goes beyond it [-], so that the cutoff is proven despite
rounding."""

_WEAK = 1e-6
"""Relative difference between reported and proven cost above which the solve is repeated [-]."""

_PIVOTS = 1.5
"""Pivots per row and column after which HiGHS is stopped, beside `_LEAST_PIVOTS` [-]: it can cycle,
and no deadline reaches it there. Solves that ended took 0.45 at most (20,000 of fleets of 6 to 20
vehicles). The more, the later a circle is noticed: at 5 each after 0.25 s of 1,300 rows and
columns."""

_LEAST_PIVOTS = 500
"""Pivots that every solve may take in any case [-], so that the smallest programs end."""

_FRESH = 10
"""Factor on this limit for a fresh HiGHS [-]: it starts cold."""

_Status = highspy.HighsModelStatus
_INFEASIBLE = (_Status.kInfeasible, _Status.kUnboundedOrInfeasible)
_INF = float("inf")


class HighsLp(BoundedLp):
    """A `BoundedLp` in HiGHS, minimized by its dual simplex method.

    Parameters
    ----------
    cost, lower, upper : (n,) array
        Of the first columns; an infinite bound leaves nothing to be proven.
    """

    def __init__(self, cost: Vector, lower: Vector, upper: Vector) -> None:
        super().__init__()
        self._num_columns, self._num_rows = int(cost.size), 0
        self._cutoff = float("inf")
        self._record = LpRecord(cost, lower, upper)
        self._point = np.zeros(0)
        self._highs = quiet_highs()
        for name, value in _DUAL_SIMPLEX:
            self._highs.setOptionValue(name, value)
        checked(
            self._highs.addCols(
                self.num_columns, cost, lower, upper, 0, NO_NUMBERS, NO_NUMBERS, NO_VALUES
            )
        )

    @property
    def num_columns(self) -> int:
        """Columns now."""
        return self._num_columns

    @property
    def num_rows(self) -> int:
        """Rows now."""
        return self._num_rows

    def _append_rows(
        self, starts: Numbers, columns: Numbers, values: Matrix, lower: Vector, upper: Vector
    ) -> None:
        flat = columns.ravel(), values.ravel()
        checked(self._highs.addRows(lower.size, lower, upper, values.size, starts[:-1], *flat))
        self._record.add_rows(starts, *flat, lower, upper)
        self._num_rows += lower.size

    def _append_column(self, cost: float, upper: float, rows: Numbers, values: Vector) -> None:
        checked(self._highs.addCol(cost, 0.0, upper, len(rows), rows, values))
        self._record.add_column(cost, upper, rows, values)
        self._num_columns += 1

    def _bound_rows(self, rows: Numbers, lower: Vector, upper: Vector) -> None:
        checked(self._highs.changeRowsBounds(rows.size, rows, lower, upper))
        self._record.bound_rows(rows, lower, upper)

    def _change_cost(self, cost: Vector) -> None:
        numbers = np.arange(self.num_columns, dtype=np.int32)
        checked(self._highs.changeColsCost(self.num_columns, numbers, cost))
        # The last vertex stays feasible: 4 pivots of the primal simplex (4), 6 of the dual one.
        self._highs.setOptionValue("simplex_strategy", 4)
        self._record.change_cost(cost)

    def solve(self, cutoff: float = float("inf")) -> tuple[LpOutcome, float]:
        """Minimize: warm, else from scratch, else in a fresh HiGHS with options of its own.

        Parameters
        ----------
        cutoff : float
            Give up as soon as the cost is proven to be at least this.

        Returns
        -------
        (LpOutcome, float)
            The outcome and a proven lower bound on the cost: near the least where optimal, inf
            where infeasible, at least the cutoff where cut off; where HiGHS failed, what is proven.
        """
        if self._record.is_contradictory:
            return LpOutcome.INFEASIBLE, float("inf")
        latest, proven = LpOutcome.FAILED, -float("inf")
        for highs in self._tries(cutoff):
            outcome, bound, reported = self._run(highs, cutoff)
            proven = max(proven, bound)
            if outcome is not LpOutcome.FAILED:
                latest = outcome
                if reported <= bound + _WEAK * max(1.0, abs(reported)):
                    return latest, proven
        return latest, max(proven, self._record.least(np.zeros(self.num_rows)))

    def _tries(self, cutoff: float) -> Iterator[highspy.Highs]:
        """Return HiGHS as it stands; asked again, from scratch; then a fresh one."""
        most = _LEAST_PIVOTS + int(_PIVOTS * (self.num_rows + self.num_columns))
        self._highs.setOptionValue("simplex_iteration_limit", most)
        self._stop_at(cutoff)
        yield self._highs
        self._highs.clearSolver()
        self._stop_at(float("inf"))
        yield self._highs
        self._highs.clearSolver()
        fresh = quiet_highs()
        fresh.setOptionValue("simplex_iteration_limit", _FRESH * most)
        fresh.passModel(self._highs.getLp())
        yield fresh
        # What presolve takes for infeasible comes without a proof.
        fresh.setOptionValue("presolve", "off")
        fresh.clearSolver()
        yield fresh

    def _stop_at(self, cutoff: float) -> None:
        """Let HiGHS stop a little beyond a cutoff."""
        if cutoff != self._cutoff:
            self._cutoff = cutoff
            beyond = cutoff + _BEYOND * abs(cutoff)
            self._highs.setOptionValue("objective_bound", beyond)

    def _run(self, highs: highspy.Highs, cutoff: float) -> tuple[LpOutcome, float, float]:
        """Solve once; return the outcome, what is proven of the cost, and what is reported."""
        self.solves += 1
        highs.run()
        status = highs.getModelStatus()
        if status in _INFEASIBLE:
            _, has_ray, ray = highs.getDualRay()
            if has_ray and self._record.has_no_point(np.asarray(ray)):
                return LpOutcome.INFEASIBLE, float("inf"), float("inf")
            return LpOutcome.FAILED, -float("inf"), float("inf")
        solution = highs.getSolution()
        bound = -float("inf")
        if solution.dual_valid:
            bound = self._record.least(array_of(solution.row_dual))
        if status == _Status.kOptimal:
            self._point = array_of(solution.col_value)
            return LpOutcome.OPTIMAL, bound, self._record.cost_at(self._point)
        if bound >= cutoff:
            return LpOutcome.CUTOFF, bound, bound
        if status == _Status.kObjectiveBound:
            # Stopped, but not proven to be beyond the cutoff: to the end, then.
            self._stop_at(float("inf"))
            return self._run(highs, cutoff)
        return LpOutcome.FAILED, bound, float("inf")

    def point(self) -> Vector:
        """Return the columns of the last optimal solve."""
        return self._point
