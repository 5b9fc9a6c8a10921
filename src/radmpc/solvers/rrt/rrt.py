"""Solver ``rrt``: no optimizer at all, only random samples that are checked.

Vehicles are planned one after the other, each by a random tree around those before it. The answer
satisfies the program; nothing is proven of its cost, and finding none proves nothing.
"""

from __future__ import annotations

import time
from typing import ClassVar

import numpy as np
from scipy.sparse import csr_array

from radmpc.arguments import is_integer, value_text
from radmpc.arrays import Indices, Vector
from radmpc.errors import ScenarioError
from radmpc.program.program import DisjunctiveProgram
from radmpc.program.restrict import avoidance_blocks
from radmpc.records import dataclass
from radmpc.solvers.rrt.course import course_of
from radmpc.solvers.rrt.tree import RandomTree
from radmpc.solvers.selection import least_violated, possible_alternatives, violations_of
from radmpc.solvers.solution import Guide, Limits, Outcome, Solution, Solver, relative_gap
from radmpc.wording import changed_texts, with_options

__all__ = ["Rrt"]

_VIOLATION_TOL = 1e-7
"""Violation up to which a point satisfies the program [m], as linear solvers have it by default."""

_REACH_TOL = 1e-6
"""Amount by which bounds of outputs may cross before nothing is reachable [m]: they are exact only
up to rounding."""

_MAX_ROUNDS = 3
"""Orders in which vehicles are placed [-]; each new one begins with the vehicle that found no
path."""


@dataclass(frozen=True, slots=True)
class Rrt(Solver):
    """Rapidly-exploring random trees; repeatable.

    Attributes
    ----------
    max_nodes : int
        Nodes of each vehicle's tree.
    """

    proves: ClassVar[bool] = False
    plans_visits: ClassVar[bool] = False

    max_nodes: int = 300

    def __post_init__(self) -> None:
        """Refuse trees without a root."""
        if not (is_integer(self.max_nodes) and self.max_nodes >= 1):
            raise ScenarioError(f"max_nodes must be at least 1, got {value_text(self.max_nodes)}")

    def __str__(self) -> str:
        return with_options("rrt", *changed_texts(self, Rrt(), "max_nodes"))

    def solve(
        self,
        program: DisjunctiveProgram,
        margins: Vector,
        *,
        gap: float,
        limits: Limits,
        start: Indices | None = None,
        guide: Guide | None = None,
        rng: np.random.Generator | None = None,
    ) -> Solution:
        """Look for a cheap point at fixed margins; see `radmpc.solvers.solution.Solver`.

        Parameters
        ----------
        program, margins, gap, limits, rng
            As there.
        start, guide
            Ignored: a selection is of no use to samples.
        """
        del start, guide
        begun = time.perf_counter()
        possible = possible_alternatives(program, margins)
        if _is_infeasible(program, possible):
            return Solution(Outcome.INFEASIBLE, None, None, float("inf"), float("inf"))
        rng = np.random.default_rng(0) if rng is None else rng
        fleet = _Fleet(program, margins, possible, self.max_nodes, rng, limits)
        z = fleet.run()
        # Nothing is relaxed here: the only lower bound is that of the columns' own bounds.
        bound = float(np.minimum(program.cost * program.lower, program.cost * program.upper).sum())
        outcome, selection, cost = Outcome.LIMIT, None, float("inf")
        if z is not None:
            violations = violations_of(program, margins, z)
            selection = least_violated(program, violations)
            cost = float(program.cost @ z)
            closed = relative_gap(cost, bound) <= gap
            outcome = Outcome.OPTIMAL if closed else Outcome.FEASIBLE
            if not _holds(program, z, violations[selection]):  # pragma: no cover - a defect
                outcome, z, selection, cost = Outcome.LIMIT, None, None, float("inf")
        return Solution(
            outcome=outcome,
            z=z,
            selection=selection,
            cost=cost,
            bound=bound,
            nodes=fleet.nodes,
            seconds=time.perf_counter() - begun,
        )


def _is_infeasible(program: DisjunctiveProgram, possible: np.ndarray) -> bool:
    """Whether limits alone rule every solution out: no goal, or no alternative, within reach.

    Samples that find nothing prove nothing; this does.
    """
    left = np.bincount(program.layout.owners[possible], minlength=program.num_avoidances)
    return bool(
        np.any(left == 0)
        or np.any(program.upper < program.lower)
        or np.any(program.output_lower > program.output_upper + _REACH_TOL)
    )


def _holds(program: DisjunctiveProgram, z: Vector, violations: Vector) -> bool:
    """Whether a point satisfies the program itself, not only the tree's copy of it."""
    hard = program.hard @ z
    return bool(
        np.all(violations <= _VIOLATION_TOL)
        and np.all((z >= program.lower - _VIOLATION_TOL) & (z <= program.upper + _VIOLATION_TOL))
        and np.all(hard >= program.hard_lower - _VIOLATION_TOL)
        and np.all(hard <= program.hard_upper + _VIOLATION_TOL)
    )


@dataclass(slots=True)
class _Fleet:
    """Blocks, one after the other."""

    program: DisjunctiveProgram
    margins: Vector
    possible: np.ndarray
    max_nodes: int
    rng: np.random.Generator
    limits: Limits
    nodes: int = 0

    def run(self) -> Vector | None:
        """Return a point, or None.

        A block that finds no path is put first and all begins again, a few times.
        """
        order = [int(block) for block in np.unique(self.program.blocks)]
        touched = avoidance_blocks(self.program)
        for _ in range(_MAX_ROUNDS):
            z = np.zeros(self.program.num_columns)
            placed: list[int] = []
            for block in order:
                if not self._place(block, placed, touched, z):
                    break
                placed.append(block)
            if len(placed) == len(order):
                return z
            if self.limits.reached:
                return None
            failed = order[len(placed)]
            order = [failed, *(b for b in order if b != failed)]
        return None

    def _place(self, block: int, placed: list[int], touched: csr_array, z: Vector) -> bool:
        """Plan one block around those placed; write it into the point if there is a path."""
        absent = np.setdiff1d(np.arange(touched.shape[1]), [*placed, block])
        is_due = np.asarray(touched[:, absent].sum(axis=1)).ravel() == 0.0
        is_own = np.asarray(touched[:, [block]].sum(axis=1)).ravel() > 0.0
        avoidances = np.flatnonzero(is_due & is_own)
        course = course_of(self.program, self.margins, self.possible, block, avoidances, z)
        tree = RandomTree(course, self.max_nodes, self.rng, self.limits)
        tree.run()
        self.nodes += tree.count
        if tree.best is None:
            return False
        z[course.columns] = course.points(tree.best[None])[0]
        return True
