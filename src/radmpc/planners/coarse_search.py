"""An alternative for every avoidance from a coarse search over positions and times.

A path over a grid is sought for one vehicle after the other, step by step, at the least effort,
around obstacles and around the vehicles placed before. Only the alternatives that it satisfies are
kept: the linear program with these then finds the trajectories, dynamics and all. A heuristic for
coupled scenes, where branching alone takes long to find any plan; it proves nothing.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product

import numpy as np

from radmpc.arrays import Indices, Matrix, Vector
from radmpc.planners.coarse_grid import CoarseGrid, coarse_grid
from radmpc.program.condensed import CondensedModel
from radmpc.program.program import DisjunctiveProgram
from radmpc.program.restrict import avoidance_blocks
from radmpc.records import dataclass
from radmpc.solvers.selection import least_violated, violations_of_outputs
from radmpc.solvers.solution import Limits

__all__ = ["propose_alternatives"]

_MAX_ROUNDS = 5
"""Orders of the vehicles that are tried, at most [-]: a vehicle without a path goes first."""


def propose_alternatives(
    program: DisjunctiveProgram, models: Sequence[CondensedModel], margins: Vector, limits: Limits
) -> Indices | None:
    """Propose one alternative per avoidance.

    Parameters
    ----------
    program : DisjunctiveProgram
        The program of the vehicles.
    models : sequence of CondensedModel
        Its vehicles, in the order of its blocks.
    margins : (r,) array
        Back-off of each row [m].
    limits : Limits
        When to stop early.

    Returns
    -------
    (v,) int array or None
        A selection; None if no path was found in time, where something is visited on the way, and
        in space, where grids are too large.
    """
    if program.layout.dimension != 2 or program.num_visits:
        return None
    search = _Search(program, models, margins, limits)
    order = list(range(len(models)))
    for _ in range(_MAX_ROUNDS):
        failed = search.place(order)
        if failed is None:
            violations = violations_of_outputs(program, margins, search.outputs)
            return least_violated(program, violations)
        if limits.reached:
            break
        order = [failed, *(i for i in order if i != failed)]
    return None


class _Search:
    """The vehicles placed so far."""

    def __init__(
        self,
        program: DisjunctiveProgram,
        models: Sequence[CondensedModel],
        margins: Vector,
        limits: Limits,
    ) -> None:
        self.program = program
        self.limits = limits
        self.models = models
        self.right = program.rows.offsets - margins
        touched = avoidance_blocks(program)
        parts: list[Indices] = np.split(touched.indices, touched.indptr[1:-1])
        self.blocks = [frozenset(part.tolist()) for part in parts]
        self.outputs = program.constant.copy()

    def place(self, order: list[int]) -> int | None:
        """Seek a path for all vehicles in an order; return the one that has none."""
        self.outputs = self.program.constant.copy()
        placed: set[int] = set()
        for i in order:
            placed.add(i)
            path = self._path(i, placed)
            if path is None:
                return i
            self.outputs[self.program.layout.positions[i]] = path.ravel()
        return None

    def _path(self, i: int, placed: set[int]) -> Matrix | None:
        """Return positions at every step, (T+1, 2), at the least sum of squared moves."""
        model = self.models[i]
        grid, last = coarse_grid(model), model.horizon
        tests = self._tests(i, placed)
        here = model.drift_position[:1]
        goal = model.vehicle.goal.center[None, :]
        costs, places, parents = np.zeros(1), here, []
        for k in range(last):
            if self.limits.reached:
                return None
            ahead = goal if k == last - 1 else grid.points
            inside = self._within_reach(model, ahead, k + 1, grid)
            step = _Step(places, ahead, grid, self._allowed(tests, i, k, places, ahead))
            costs, parent = step.relax(costs)
            costs[~inside] = np.inf
            parents.append(parent)
            places = ahead
        if not np.isfinite(costs[0]):
            return None
        return _traced(parents, grid.points, here[0], goal[0])

    def _within_reach(
        self, model: CondensedModel, points: Matrix, k: int, grid: CoarseGrid
    ) -> np.ndarray:
        """Whether points lie in the vehicle's reach at a step, up to half a cell."""
        half = 0.5 * grid.stride
        low, high = model.reach_lower[k] - half, model.reach_upper[k] + half
        return np.asarray(np.all((points >= low) & (points <= high), axis=1))

    def _tests(self, i: int, placed: set[int]) -> dict[int, list[int]]:
        """Return the avoidances that concern a vehicle and those before it, by window."""
        layout = self.program.layout
        found: dict[int, list[int]] = {}
        for avoidance, label in enumerate(self.program.avoidances):
            blocks = self.blocks[avoidance]
            if i in blocks and blocks <= placed:
                found.setdefault(layout.window_of(label.step), []).append(avoidance)
        return found

    def _allowed(
        self, tests: dict[int, list[int]], i: int, k: int, here: Matrix, ahead: Matrix
    ) -> list[list[tuple[np.ndarray, np.ndarray]]]:
        """Return per avoidance its alternatives as what holds here and what holds ahead."""
        result = []
        for avoidance in tests.get(k, ()):
            alternatives = []
            for alternative in self.program.alternatives_of(avoidance):
                now = np.ones(len(here), dtype=bool)
                then = np.ones(len(ahead), dtype=bool)
                for row in self.program.rows_of(alternative):
                    step, holds = self._row(int(row), i)
                    if step == k:
                        now &= holds(here)
                    else:
                        then &= holds(ahead)
                if now.any() and then.any():
                    alternatives.append((now, then))
            if not alternatives and len(ahead) == 1:
                continue  # the middle of a goal may be too close where another part of it is not
            if not any(now.all() and then.all() for now, then in alternatives):
                result.append(alternatives)
        return result

    def _row(self, row: int, i: int) -> tuple[int, _Halfplane]:
        """Return the step of a row and its half-plane for one vehicle, the others in place."""
        normals = self.program.rows.normals
        span = slice(normals.indptr[row], normals.indptr[row + 1])
        columns, values = normals.indices[span], normals.data[span]
        own = self.program.layout.positions[i]
        mine = (columns >= own.start) & (columns < own.stop)
        rest = (columns < self.program.num_positions) & ~mine
        local = columns[mine] - own.start
        normal = np.zeros(2)
        normal[local % 2] = values[mine]
        offset = self.right[row] - float(values[rest] @ self.outputs[columns[rest]])
        return int(local[0] // 2), _Halfplane(normal, offset)


@dataclass(frozen=True, slots=True, eq=False)
class _Halfplane:
    """Points with ``normal @ point <= offset``."""

    normal: Vector
    offset: float

    def __call__(self, points: Matrix) -> np.ndarray:
        """Whether points lie within."""
        return np.asarray(points @ self.normal <= self.offset + 1e-9)


@dataclass(frozen=True, slots=True, eq=False)
class _Step:
    """One step of the path search: from which positions to which, and what forbids it."""

    here: Matrix
    ahead: Matrix
    grid: CoarseGrid
    tests: list[list[tuple[np.ndarray, np.ndarray]]]

    def relax(self, costs: Vector) -> tuple[Vector, Indices]:
        """Return the least cost of each position ahead and where it came from."""
        if len(self.here) == len(self.ahead) == len(self.grid.points):
            return self._between_cells(costs)
        moves = self.ahead[None, :, :] - self.here[:, None, :]
        limit = self.grid.stride * (np.array(self.grid.reach) + 1e-9)
        total = costs[:, None] + np.sum(moves**2, axis=2)
        total[np.any(np.abs(moves) > limit, axis=2)] = np.inf
        for alternatives in self.tests:
            free = np.zeros(total.shape, dtype=bool)
            for now, then in alternatives:
                free |= now[:, None] & then[None, :]
            total[~free] = np.inf
        parents = total.argmin(axis=0)
        return total[parents, np.arange(len(self.ahead))], parents

    def _between_cells(self, costs: Vector) -> tuple[Vector, Indices]:
        """Relax cell to cell, one offset of the grid at a time."""
        rows, columns = self.grid.shape
        numbers = np.arange(rows * columns).reshape(rows, columns)
        best = np.full((rows, columns), np.inf)
        parents = np.zeros((rows, columns), dtype=np.int64)
        table = costs.reshape(rows, columns)
        tests = [
            [(now.reshape(rows, columns), then.reshape(rows, columns)) for now, then in test]
            for test in self.tests
        ]
        reach = self.grid.reach
        for dx, dy in product(range(-reach[0], reach[0] + 1), range(-reach[1], reach[1] + 1)):
            here, ahead = _overlap(rows, dx), _overlap(columns, dy)
            origin, target = (here[0], ahead[0]), (here[1], ahead[1])
            length = float(np.sum((self.grid.stride * np.array([dx, dy])) ** 2))
            total = table[origin] + length
            for alternatives in tests:
                free = np.zeros(total.shape, dtype=bool)
                for now, then in alternatives:
                    free |= now[origin] & then[target]
                total[~free] = np.inf
            better = total < best[target]
            best[target] = np.where(better, total, best[target])
            parents[target] = np.where(better, numbers[origin], parents[target])
        return best.ravel(), parents.ravel()


def _overlap(count: int, shift: int) -> tuple[slice, slice]:
    """Return which indices move by a shift to which, along one axis."""
    if shift >= 0:
        return slice(0, max(count - shift, 0)), slice(shift, count)
    return slice(-shift, count), slice(0, max(count + shift, 0))


def _traced(parents: list[Indices], cells: Matrix, start: Vector, goal: Vector) -> Matrix:
    """Follow the parents back from the goal."""
    path = [goal]
    number = int(parents[-1][0])
    for parent in reversed(parents[:-1]):
        path.append(cells[number])
        number = int(parent[number])
    path.append(start)
    return np.array(path[::-1])
