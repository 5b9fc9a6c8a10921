"""One linear program kept alive: rows are added once and switched by their bounds."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

from radmpc.arrays import Indices, Vector
from radmpc.program.program import DisjunctiveProgram
from radmpc.records import dataclass
from radmpc.solvers.lp.choosing import bounded_lp
from radmpc.solvers.lp.outcome import LpOutcome

__all__ = ["CostRow", "WarmLp"]

_HELD, _OPPOSED = 1, 2
"""Flags of an active row: bounded above, bounded below."""

_CROWD = 200
"""Rows beyond which switched-off ones are dropped [-], beside two per active row: 1.3 to 2 times
less time on long searches of eight vehicles."""


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


class WarmLp:
    """The program's hard rows plus the chance rows seen so far, solved warm by dual simplex.

    Parameters
    ----------
    program : DisjunctiveProgram
        The program; its chance rows are numbered as there.
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
        self._dropped_solves = 0
        self._start()

    def _start(self) -> None:
        """Load columns, hard rows and cost rows; no chance row yet."""
        program = self._program
        self._place.clear()
        self._state.clear()
        self._lp = bounded_lp(program.cost, program.lower, program.upper)
        self._lp.add_rows(program.hard, program.hard_lower, program.hard_upper)
        for row in self._cost_rows:
            columns = row.columns.astype(np.int32)
            self._lp.add_row(columns, program.cost[row.columns], row.bound, np.inf)

    @property
    def solves(self) -> int:
        """Linear programs solved."""
        return self._lp.solves + self._dropped_solves

    def activate(self, rows: Iterable[int], opposite: Iterable[int] = ()) -> None:
        """Switch exactly these chance rows on, adding those that are new.

        Parameters
        ----------
        rows : iterable of int
            Rows to hold.
        opposite : iterable of int
            Rows to hold in the opposite direction: at least the right side.
        """
        target = dict.fromkeys((int(r) for r in rows), _HELD)
        for row in opposite:
            target[int(row)] = target.get(int(row), 0) | _OPPOSED
        if len(self._place) > _CROWD + 2 * len(target):
            # Rows switched off still cost time in every pivot: begin again without them.
            self._dropped_solves += self._lp.solves
            self._start()
        new = [r for r in target if r not in self._place]
        if new:
            self._add(sorted(new))
        state = self._state
        changed = [r for r in state if r not in target]
        changed += [r for r, s in target.items() if state.get(r, 0) != s]
        if changed:
            states = np.array([target.get(r, 0) for r in changed])
            right = self._right[changed]
            self._lp.bound_rows(
                [self._place[r] for r in changed],
                np.where(states & _OPPOSED, right, -np.inf),
                np.where(states & _HELD, right, np.inf),
            )
        self._state = target

    def _add(self, rows: list[int]) -> None:
        """Append chance rows, switched off."""
        matrix, _ = self._program.column_rows(np.array(rows))
        infinite = np.full(len(rows), np.inf)
        base = self._lp.add_rows(matrix, -infinite, infinite)
        for i, row in enumerate(rows):
            self._place[row] = base + i

    def solve(self, cutoff: float = float("inf")) -> tuple[LpOutcome, float]:
        """Minimize over the active rows; see `BoundedLp.solve`."""
        return self._lp.solve(cutoff)

    def point(self) -> Vector:
        """Return the columns of the last optimal solve."""
        return self._lp.point()
