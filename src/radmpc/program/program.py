"""The disjunctive chance-constrained program as a value: what every planner builds and solves.

Minimize ``cost @ z`` over hard rows and, for every avoidance, at least one alternative whose
chance rows all hold. The chance rows are written over *outputs* ``y = outputs @ z + constant``
(mean positions and controls), few per row, so that rating thousands of rows is one short
product; a row's dense form over ``z`` is made only for the few that enter a solver.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from scipy.sparse import csr_array

from radmpc.arrays import Indices, Integers, Vector, distinct
from radmpc.gaussian import GAUSSIAN, Tail, clearance
from radmpc.program.layout import ProgramLayout, RiskItem, owners_of_runs
from radmpc.records import dataclass

__all__ = ["PRESOLVED_RISK", "PRESOLVED_SHARE", "ChanceRows", "DisjunctiveProgram", "RiskItem"]

PRESOLVED_RISK = 1e-12
"""Violation probability up to which an avoidance is presolved, whatever the controls [-]: it is
charged at that probability and left out. Where Δ is below 1e-4, `PRESOLVED_SHARE` of Δ instead."""

PRESOLVED_SHARE = 1e-8
"""Share of Δ that one presolved avoidance may take [-]: thousands of them leave Δ as it is."""


@dataclass(frozen=True, slots=True, eq=False)
class ChanceRows:
    """Rows ``normals @ y <= offsets`` whose left sides carry Gaussian noise.

    Rows of one *event* look along the same direction at the same step and differ only in their
    offsets, so their violations are nested: together they are charged once, at the largest risk.

    Attributes
    ----------
    normals : (r, p) sparse array
        Coefficients over the outputs.
    offsets : (r,) array
        Right sides [m].
    deviations : (r,) array
        Standard deviations of the left sides [m]; 0 makes a hard row.
    events : (r,) int array
        The event each row belongs to.
    risk_items : (e,) int array
        The risk item each event belongs to.
    """

    normals: csr_array
    offsets: Vector
    deviations: Vector
    events: Integers
    risk_items: Integers

    @property
    def count(self) -> int:
        """Number of rows."""
        return int(self.offsets.size)


@dataclass(frozen=True, slots=True, eq=False)
class DisjunctiveProgram:
    """The one mathematical object of this package.

    Attributes
    ----------
    cost : (n,) array
        Cost of the decision variables.
    lower, upper : (n,) array
        Their bounds.
    blocks : (n,) int array
        The block of each variable: hard rows never join two blocks, so that without chance rows
        the program falls apart into one per block (one per vehicle).
    hard : (h, n) sparse array
        Coefficients of the hard rows.
    hard_lower, hard_upper : (h,) array
        Bounds of the hard rows.
    outputs : (p, n) sparse array
        What the chance rows see, without its constant: positions first, then the controls.
    num_positions : int
        How many of the outputs are positions.
    constant : (p,) array
        Constant part of the outputs.
    output_lower, output_upper : (p,) array
        Bounds of the outputs over all points that satisfy the hard rows.
    rows : ChanceRows
        All chance rows.
    alternative_starts : (a+1,) int array
        Alternative i owns ``alternative_rows[starts[i]:starts[i+1]]``.
    alternative_rows : int array
        Row numbers.
    avoidance_starts : (v+1,) int array
        Avoidance i owns alternatives ``starts[i]..starts[i+1]-1``; none is a contradiction.
    avoidances : tuple of RiskItem
        What each avoidance avoids, with the step its window starts at.
    risk_items : tuple of RiskItem
        What risk is allocated to.
    risk_bound : float
        Δ for this program.
    initial_risk : float
        Risk charged to Δ first: at k = 0, which no control can change, and of presolved
        avoidances.
    initial : tuple of (RiskItem, float)
        Risk at k = 0 that is not negligible, item by item. Under intervals it is that of rows
        within alternatives, and not part of ``initial_risk``.
    layout : ProgramLayout
        What the outputs, windows and alternatives stand for.
    presolved_risk : float
        The part of ``initial_risk`` that is of presolved avoidances: the most that they can run,
        which a plan may undercut and a lower bound must not charge.
    num_presolved : int
        How many avoidances hold throughout the reachable boxes and were left out.
    parents : (a,) int array or None
        The alternative of the same avoidance that each refines, -1 where there is none: whatever
        satisfies it satisfies that one. Only those that nothing refines are alternatives proper;
        the others stand for all that refine them. None where no alternative refines another.
    num_visits : int
        How many of the avoidances, the last of them, are visits: without risk.
    tail : Tail
        Of what all rows deviate by.
    """

    cost: Vector
    lower: Vector
    upper: Vector
    blocks: Indices
    hard: csr_array
    hard_lower: Vector
    hard_upper: Vector
    outputs: csr_array
    num_positions: int
    constant: Vector
    output_lower: Vector
    output_upper: Vector
    rows: ChanceRows
    alternative_starts: Indices
    alternative_rows: Integers
    avoidance_starts: Indices
    avoidances: tuple[RiskItem, ...]
    risk_items: tuple[RiskItem, ...]
    risk_bound: float
    initial_risk: float
    initial: tuple[tuple[RiskItem, float], ...]
    layout: ProgramLayout
    presolved_risk: float = 0.0
    num_presolved: int = 0
    parents: Indices | None = None
    num_visits: int = 0
    tail: Tail = GAUSSIAN

    @property
    def num_columns(self) -> int:
        """Number of decision variables n."""
        return int(self.cost.size)

    @property
    def num_avoidances(self) -> int:
        """Number of avoidances."""
        return len(self.avoidances)

    @property
    def num_alternatives(self) -> int:
        """Number of alternatives of all avoidances."""
        return int(self.alternative_starts.size - 1)

    @property
    def budget(self) -> float:
        """What is left of Δ for the rows; negative where the start alone exceeds it."""
        return self.risk_bound - self.initial_risk

    def alternatives_of(self, avoidance: int) -> range:
        """Return the alternatives of an avoidance."""
        return range(
            int(self.avoidance_starts[avoidance]), int(self.avoidance_starts[avoidance + 1])
        )

    def rows_of(self, alternative: int) -> Indices:
        """Return the rows of an alternative."""
        start, stop = self.alternative_starts[alternative : alternative + 2]
        return self.alternative_rows[start:stop]

    def entry_owners(self) -> Indices:
        """Return the alternative that owns each entry of ``alternative_rows``, (entries,)."""
        return owners_of_runs(self.alternative_starts)

    def slacks(self, z: Vector) -> Vector:
        """Return ``offset − normal @ y`` of every row at a point, (r,) [m]."""
        outputs = self.outputs @ z + self.constant
        slacks: Vector = self.rows.offsets - self.rows.normals @ outputs
        return slacks

    def clearances(self, z: Vector) -> Vector:
        """Return every row's slack in standard deviations, (r,); ±inf for rows without noise."""
        return clearance(self.slacks(z), self.rows.deviations)

    def fixed_rows(self) -> np.ndarray:
        """Return which rows are over positions that no control can change, (r,) bool.

        Those at the first step, and later ones where the control comes with a delay. Their sagitta
        may still depend on the control.
        """
        positions = slice(0, self.num_positions)
        moved = abs(self.outputs[positions]) @ np.ones(self.num_columns)
        return np.asarray(abs(self.rows.normals[:, positions]) @ moved == 0.0)

    def column_rows(self, rows: Indices) -> tuple[csr_array, Vector]:
        """Return chosen rows over the decision variables: coefficients and right sides."""
        normals = self.rows.normals[rows]
        return csr_array(normals @ self.outputs), self.rows.offsets[rows] - normals @ self.constant

    def column_row(self, row: int) -> tuple[npt.NDArray[np.int32], Vector]:
        """Return one row over the decision variables: the columns it touches, and its values."""
        dense = np.zeros(self.num_columns)
        normals, outputs = self.rows.normals, self.outputs
        for entry in range(normals.indptr[row], normals.indptr[row + 1]):
            output = normals.indices[entry]
            span = slice(outputs.indptr[output], outputs.indptr[output + 1])
            dense[outputs.indices[span]] += normals.data[entry] * outputs.data[span]
        columns = np.flatnonzero(dense)
        return columns.astype(np.int32), dense[columns]

    def event_risks(self, z: Vector, selection: Indices) -> Vector:
        """Return the risk each event runs at a point; 0 for events that are not chosen.

        Parameters
        ----------
        z : (n,) array
            The point.
        selection : (v,) int array
            The alternative chosen for each avoidance.

        Returns
        -------
        (e,) array
            Probability, the largest of each event's chosen rows.
        """
        rows = self._members(selection)
        risks = np.zeros(self.rows.risk_items.size)
        chosen = clearance(self.slacks(z)[rows], self.rows.deviations[rows])
        np.maximum.at(risks, self.rows.events[rows], self.tail.probability(chosen))
        return risks

    def selected_rows(self, selection: Indices) -> Indices:
        """Return the distinct rows of one alternative per avoidance."""
        return distinct(self._members(selection))

    def _members(self, selection: Indices) -> Indices:
        """Return the rows of some alternatives, one after the other."""
        if selection.size == 0:
            return np.zeros(0, dtype=np.int64)
        starts = self.alternative_starts[selection]
        sizes = self.alternative_starts[selection + 1] - starts
        ends = np.cumsum(sizes)
        places = np.arange(ends[-1]) + np.repeat(starts - ends + sizes, sizes)
        members: Indices = self.alternative_rows[places]
        return members
