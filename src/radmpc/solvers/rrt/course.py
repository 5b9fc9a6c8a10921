"""One vehicle's part of a program, over its signed controls and ready for sampling.

A *course* is a control sequence ``u = u⁺ − u⁻`` over the whole horizon. Every condition of a
program is affine in ``u⁺`` and ``u⁻``, and depends on controls up to some step only: its *level*.
So one product checks many courses, and the conditions of level k or less check a prefix of k steps.
"""

from __future__ import annotations

from collections.abc import Sequence, Sized
from typing import NamedTuple

import numpy as np
import numpy.typing as npt
from scipy.sparse import csr_array

from radmpc.arrays import Indices, Matrix, Tensor, Vector
from radmpc.program.program import DisjunctiveProgram
from radmpc.records import dataclass
from radmpc.solvers.rrt.connect import ROUNDS, connect

__all__ = ["Course", "course_of"]

_TOL = 1e-9
"""Violation up to which controls and chance rows hold [control unit, m]."""

_HARD_TOL = 1e-8
"""Violation up to which hard rows hold [m, m/s]: least-norm solves meet goals that are points only
up to rounding."""

_REACH_TOL = 1e-6
"""Violation up to which the reachable boxes hold [m]: they are exact only up to rounding."""

_INSIDE = 1e-4
"""Share of the goal's half-width by which courses end inside it [-]."""


@dataclass(frozen=True, slots=True, eq=False)
class Course:
    """One block of a program, other blocks fixed or left out; c = T·m signed controls.

    Attributes
    ----------
    columns : (2c,) int array
        Its columns in the program, u⁺ before u⁻.
    horizon : int
        Steps T.
    steps : (c,) int array
        The step of each control.
    cost : (2c,) array
        Cost of the columns.
    limits : (c,) array
        Largest |u|.
    hard : (h, c) array
        Hard rows.
    hard_lower, hard_upper : (h,) array
        Their bounds.
    hard_levels : (h,) int array
        Their levels.
    goal : (g,) int array
        Which of them are the goal.
    positions : (T+1, d, c) array
        Mean positions per control.
    drift : (T+1, d) array
        Mean positions without control [m].
    lower, upper : (T+1, d) array
        Box that holds the mean position [m].
    rows : (r, 2c) array
        Chance rows, alternative by alternative.
    offsets : (r,) array
        Their right sides, less margins and fixed blocks [m].
    alternatives, avoidances : int array
        First row of each alternative, first alternative of each avoidance.
    levels : (v,) int array
        Levels of the avoidances.
    """

    columns: Indices
    horizon: int
    steps: Indices
    cost: Vector
    limits: Vector
    hard: Matrix
    hard_lower: Vector
    hard_upper: Vector
    hard_levels: Indices
    goal: Indices
    positions: Tensor
    drift: Matrix
    lower: Matrix
    upper: Matrix
    rows: Matrix
    offsets: Vector
    alternatives: Indices
    avoidances: Indices
    levels: Indices

    def points(self, courses: Matrix) -> Matrix:
        """Return the columns' values, (s, 2c), of courses (s, c)."""
        return np.concatenate([np.maximum(courses, 0.0), np.maximum(-courses, 0.0)], axis=1)

    def costs(self, courses: Matrix) -> Vector:
        """Return the cost of each course, (s,)."""
        costs: Vector = self.points(courses) @ self.cost
        return costs

    def paths(self, courses: Matrix) -> Tensor:
        """Return the mean positions of each course, (s, T+1, d) [m]."""
        flat = courses @ self.positions.reshape(-1, self.steps.size).T
        return flat.reshape(len(courses), *self.drift.shape) + self.drift

    def failures(self, courses: Matrix) -> Indices:
        """Return the first level at which each course fails, (s,); T+1 where it never does."""
        never = self.horizon + 1
        first = np.full(len(courses), never)
        _lower(first, np.abs(courses) > self.limits + _TOL, self.steps + 1)
        hard = courses @ self.hard.T
        outside = (hard < self.hard_lower - _HARD_TOL) | (hard > self.hard_upper + _HARD_TOL)
        _lower(first, outside, self.hard_levels)
        paths = self.paths(courses)
        out = (paths < self.lower - _REACH_TOL) | (paths > self.upper + _REACH_TOL)
        _lower(first, out.any(axis=2), np.arange(never))
        if self.levels.size:
            short = self.rows @ self.points(courses).T - self.offsets[:, None]
            worst = np.maximum.reduceat(short, self.alternatives, axis=0)
            best = np.minimum.reduceat(worst, self.avoidances, axis=0)
            _lower(first, best.T > _TOL, self.levels)
        return first

    def to_goal(self, courses: Matrix, free: np.ndarray, rounds: int = ROUNDS) -> Matrix:
        """Return courses with their free controls replaced by cheap ones to the goal.

        Parameters
        ----------
        courses : (s, c) array
            Controls.
        free : (s, c) bool array
            Which of them may change.
        rounds : int
            See `radmpc.solvers.rrt.connect.connect`.

        Returns
        -------
        (s, c) array
            Controls that end in the goal as far as limits allow.
        """
        kept = np.where(free, 0.0, courses)
        rows = self.hard[self.goal]
        lower, upper = self.hard_lower[self.goal], self.hard_upper[self.goal]
        needs = 0.5 * (lower + upper) - kept @ rows.T
        # Where in the goal to end is one more control for each of its rows, and costs nothing.
        width = np.diag(0.5 * (upper - lower))
        limits = np.hstack([free * self.limits, np.full(needs.shape, 1.0 - _INSIDE)])
        found = connect(np.hstack([rows, width])[None], needs, limits, rounds, free=len(width))
        return kept + found[:, : self.steps.size]


def _lower(first: Indices, failed: npt.ArrayLike, levels: Indices) -> None:
    """Lower what failed first, (s,), to the levels of what failed, (s, i) and (i,)."""
    if levels.size:
        first[:] = np.minimum(first, np.where(failed, levels, first[:, None]).min(axis=1))


def course_of(
    program: DisjunctiveProgram,
    margins: Vector,
    possible: np.ndarray,
    block: int,
    avoidances: Indices,
    z: Vector,
) -> Course:
    """Return one block's part of a program.

    Parameters
    ----------
    program : DisjunctiveProgram
        The program.
    margins : (r,) array
        Back-off of each row [m].
    possible : (a,) bool array
        Which alternatives are possible; at least one per avoidance.
    block : int
        The block.
    avoidances : int array
        The avoidances that it has to keep.
    z : (n,) array
        Where other blocks are; its own entries are not used.

    Returns
    -------
    Course
        Over the block's own columns.
    """
    columns = np.flatnonzero(program.blocks == block)
    plus = columns[: columns.size // 2]
    layout = program.layout
    horizon, dimension, span = layout.horizon, layout.dimension, layout.positions[block]
    steps = np.repeat(np.arange(horizon), plus.size // horizon)
    positions = program.outputs[span].toarray()[:, plus]
    numbers = np.flatnonzero(abs(program.hard)[:, plus].sum(axis=1) > 0.0)
    hard = program.hard[numbers].toarray()[:, plus]
    hard_levels = _levels(hard, steps)
    others = np.where(program.blocks == block, 0.0, z)
    chance = _chance_rows(program, margins, possible, avoidances)
    rows = chance.rows[:, columns].toarray()
    levels = _levels(rows, np.tile(steps, 2))
    if avoidances.size:
        levels = np.maximum.reduceat(levels, chance.alternatives)
        levels = np.maximum.reduceat(levels, chance.avoidances)
    return Course(
        columns=columns,
        horizon=horizon,
        steps=steps,
        cost=program.cost[columns],
        limits=np.minimum(program.upper[plus], program.upper[columns[plus.size :]]),
        hard=hard,
        hard_lower=program.hard_lower[numbers],
        hard_upper=program.hard_upper[numbers],
        hard_levels=hard_levels,
        goal=_goal(hard, hard_levels, positions[-dimension:]),
        positions=positions.reshape(horizon + 1, dimension, -1),
        drift=program.constant[span].reshape(horizon + 1, dimension),
        lower=program.output_lower[span].reshape(horizon + 1, dimension),
        upper=program.output_upper[span].reshape(horizon + 1, dimension),
        rows=rows,
        offsets=chance.offsets - chance.rows @ others,
        alternatives=chance.alternatives,
        avoidances=chance.avoidances,
        levels=levels,
    )


def _levels(matrix: Matrix, steps: Indices) -> Indices:
    """Return the steps whose controls each row depends on, the first k of them, (r,)."""
    levels: Indices = np.where(matrix != 0.0, steps + 1, 0).max(axis=1, initial=0)
    return levels


def _goal(hard: Matrix, levels: Indices, last: Matrix) -> Indices:
    """Return the hard rows over the last position, or over the last control."""
    is_last_place = (hard[:, None, :] == last).all(axis=2).any(axis=1)
    return np.flatnonzero(is_last_place | (levels == levels.max(initial=0)))


class _Chance(NamedTuple):
    """Chance rows over all columns, alternative by alternative, and where the runs start."""

    rows: csr_array
    offsets: Vector
    alternatives: Indices
    avoidances: Indices


def _chance_rows(
    program: DisjunctiveProgram, margins: Vector, possible: np.ndarray, avoidances: Indices
) -> _Chance:
    """Return the rows of the possible alternatives, less margins."""
    members = [
        [a for a in program.alternatives_of(int(avoidance)) if possible[a]]
        for avoidance in avoidances
    ]
    runs = [program.rows_of(a) for alternatives in members for a in alternatives]
    numbers = np.concatenate([np.zeros(0, dtype=np.int64), *runs])
    rows, offsets = program.column_rows(numbers)
    return _Chance(rows, offsets - margins[numbers], _starts(runs), _starts(members))


def _starts(runs: Sequence[Sized]) -> Indices:
    """Return where each run starts."""
    sizes = np.array([len(run) for run in runs], dtype=np.int64)
    return np.cumsum(sizes) - sizes
