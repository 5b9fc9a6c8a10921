"""One linear programme kept alive: rows are added once and switched by their bounds."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from enum import Enum

import highspy
import numpy as np

from radmpc.arrays import Indices, Vector
from radmpc.errors import SolverError
from radmpc.program.program import DisjunctiveProgram

__all__ = ["CostRow", "LpOutcome", "WarmLp", "quiet_highs"]

FEASIBILITY_TOL = 1e-9
_HELD, _OPPOSED = 1, 2
_CROWD = 200


class LpOutcome(Enum):
    """How a linear programme ended."""

    OPTIMAL = "optimal"
    INFEASIBLE = "infeasible"
    CUTOFF = "worse than the cutoff"


@dataclass(frozen=True, slots=True, eq=False)
class CostRow:
    """A proven lower bound on the cost of some columns.

    Attributes
    ----------
    columns : int array
        The columns.
    bound : float
        What they cost at least in any solution.
    """

    columns: Indices
    bound: float


def quiet_highs() -> highspy.Highs:
    """Return a HiGHS instance that is silent, single-threaded and repeatable."""
    highs = highspy.Highs()
    for name, value in (
        ("output_flag", False),
        ("threads", 1),
        ("random_seed", 0),
    ):
        highs.setOptionValue(name, value)
    return highs


class WarmLp:
    """The programme's hard rows plus the chance rows seen so far, solved warm by dual simplex.

    Parameters
    ----------
    program : DisjunctiveProgram
        The programme; its chance rows are numbered as there.
    margins : (r,) array
        Back-off of each chance row [m].
    cost_rows : sequence of CostRow
        Known lower bounds on parts of the cost.
    """

    def __init__(
        self,
        program: DisjunctiveProgram,
        margins: Vector,
        cost_rows: Sequence[CostRow] = (),
    ) -> None:
        self._program = program
        self._right = program.rows.offsets - program.rows.normals @ program.constant - margins
        self._place: dict[int, int] = {}
        self._cost_rows = tuple(cost_rows)
        self._state: dict[int, int] = {}
        self.solves = 0
        self._start()

    def _start(self) -> None:
        """Load columns, hard rows and cost rows; no chance row yet."""
        program = self._program
        self._place.clear()
        self._state.clear()
        highs = quiet_highs()
        for name, value in (
            ("presolve", "off"),
            ("solver", "simplex"),
            ("simplex_strategy", 1),
            ("primal_feasibility_tolerance", FEASIBILITY_TOL),
            ("dual_feasibility_tolerance", FEASIBILITY_TOL),
        ):
            highs.setOptionValue(name, value)
        empty = np.zeros(0, dtype=np.int32)
        n = program.num_columns
        _check(
            highs.addCols(
                n, program.cost, program.lower, program.upper, 0, empty, empty, np.zeros(0)
            )
        )
        hard = program.hard
        _check(
            highs.addRows(
                hard.shape[0],
                program.hard_lower,
                program.hard_upper,
                hard.nnz,
                hard.indptr[:-1].astype(np.int32),
                hard.indices.astype(np.int32),
                hard.data,
            )
        )
        for row in self._cost_rows:
            columns = row.columns.astype(np.int32)
            _check(
                highs.addRow(row.bound, np.inf, columns.size, columns, program.cost[row.columns])
            )
        self._num_hard = int(hard.shape[0]) + len(self._cost_rows)
        self._highs = highs
        self._cutoff = float("inf")

    def activate(self, rows: Iterable[int], opposite: Iterable[int] = ()) -> None:
        """Switch exactly these chance rows on, adding those that are new.

        Parameters
        ----------
        rows : iterable of int
            Rows to hold.
        opposite : iterable of int
            Rows to hold the other way round: at least the right side.
        """
        wanted = dict.fromkeys((int(r) for r in rows), _HELD)
        for row in opposite:
            wanted[int(row)] = wanted.get(int(row), 0) | _OPPOSED
        if len(self._place) > _CROWD + 2 * len(wanted):
            # Rows switched off still cost time in every pivot: begin again without them.
            self._start()
        new = [r for r in wanted if r not in self._place]
        if new:
            self._add(sorted(new))
        state = self._state
        changed = [r for r in state if r not in wanted]
        changed += [r for r, s in wanted.items() if state.get(r, 0) != s]
        if changed:
            states = np.array([wanted.get(r, 0) for r in changed])
            right = self._right[changed]
            _check(
                self._highs.changeRowsBounds(
                    len(changed),
                    np.array([self._place[r] for r in changed], dtype=np.int32),
                    np.where(states & _OPPOSED, right, -np.inf),
                    np.where(states & _HELD, right, np.inf),
                )
            )
        self._state = wanted

    def _add(self, rows: list[int]) -> None:
        """Append chance rows, switched off."""
        matrix, _ = self._program.column_rows(np.array(rows))
        count = len(rows)
        infinite = np.full(count, np.inf)
        _check(
            self._highs.addRows(
                count,
                -infinite,
                infinite,
                matrix.nnz,
                matrix.indptr[:-1].astype(np.int32),
                matrix.indices.astype(np.int32),
                matrix.data,
            )
        )
        base = self._num_hard + len(self._place)
        for i, row in enumerate(rows):
            self._place[row] = base + i

    def solve(self, cutoff: float = float("inf")) -> tuple[LpOutcome, float]:
        """Minimise over the active rows.

        Parameters
        ----------
        cutoff : float
            Give up as soon as the cost is known to be above this.

        Returns
        -------
        (LpOutcome, float)
            The outcome and the least cost (inf where infeasible).

        Raises
        ------
        SolverError
            If HiGHS fails twice, the second time from scratch.
        """
        if cutoff != self._cutoff:
            self._highs.setOptionValue("objective_bound", cutoff)
            self._cutoff = cutoff
        for attempt in range(2):
            self.solves += 1
            self._highs.run()
            status = self._highs.getModelStatus()
            if status == highspy.HighsModelStatus.kOptimal:
                return LpOutcome.OPTIMAL, float(self._highs.getInfo().objective_function_value)
            if status == highspy.HighsModelStatus.kInfeasible:
                return LpOutcome.INFEASIBLE, float("inf")
            if status == highspy.HighsModelStatus.kObjectiveBound:
                return LpOutcome.CUTOFF, cutoff
            if attempt == 0:
                self._highs.clearSolver()
        raise SolverError(f"HiGHS stopped with {self._highs.modelStatusToString(status)}")

    def point(self) -> Vector:
        """Return the columns of the last optimal solve."""
        return np.array(self._highs.getSolution().col_value)


def _check(status: highspy.HighsStatus) -> None:
    """Turn a failed call into an error."""
    if status == highspy.HighsStatus.kError:
        raise SolverError("HiGHS refused a row or a bound")
