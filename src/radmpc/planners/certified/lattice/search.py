"""A vehicle's way among dangers on a lattice of places and moves, at a price of risk.

Dynamic programming over (place, last move): a change of move costs the effort it takes, and a move
costs what the program's own rows say it risks, each avoidance at its best side along the whole
move. First on a coarse lattice over all the vehicle can reach, then on finer ones in a tube around
the way found. Dynamics, sagitta and the goal's variance are left to the linear program of the sides
that the way passes things on. A heuristic where branching takes long to find a passage; it proves
nothing.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from itertools import product

import numpy as np
import numpy.typing as npt

from radmpc.arrays import Indices, Matrix, Vector
from radmpc.gaussian import CONVEX_RISK, clearance_for, tail_probability
from radmpc.planners.certified.lattice.half_planes import AvoidanceHalfPlanes, half_planes_of
from radmpc.planners.certified.lattice.motion import Motion
from radmpc.planners.certified.lattice.moves import (
    Lattice,
    coarse_lattice,
    finer_lattice,
    snapped_lattice,
)
from radmpc.program.condensed import CondensedModel
from radmpc.program.program import DisjunctiveProgram

__all__ = ["PathSearch"]

_MOVES = (3, 6)
"""Cells that the longest move covers, each way; finer where a coarser lattice knows no way."""

_NEAR = 1e-5
"""Share of the unit below which a risk costs nothing here."""

_INF = np.float32(1e9)

_FINENESS = 64
_FAR = 10
"""Clearance beyond which there is no risk (8e-24)."""

_TAILS = tail_probability(np.arange(-_FAR * _FINENESS, _FAR * _FINENESS + 1) / _FINENESS)
"""The tail at every sixty-fourth of a deviation."""

Float32 = npt.NDArray[np.float32]


@dataclass(eq=False)
class PathSearch:
    """The lattice search of one vehicle's program.

    Parameters
    ----------
    program : DisjunctiveProgram
        Of one vehicle; others may be placed in it, as moving obstacles.
    model : Subject
        The vehicle.
    unit : float
        Budget of risk; an avoidance may risk as much along a move, up to `CONVEX_RISK`.
    first : int
        Its first output: 0 unless others are placed.
    level : int
        The coarsest lattice to be tried; where it knows no way, the walk goes on to finer ones.
    is_quick : bool
        Whether it does not.
    """

    program: DisjunctiveProgram
    model: CondensedModel
    unit: float
    first: int = 0
    level: int = 0
    is_coarse_only: bool = False
    _avoidances: list[list[AvoidanceHalfPlanes]] = field(default_factory=list)
    _deviations: dict[tuple[bytes, bytes], float] = field(default_factory=dict)
    """The largest of each danger over all windows: what is near then is looked at in all."""
    _paths: dict[tuple[float, float], Matrix | None] = field(default_factory=dict)
    _margins: dict[tuple[object, ...], tuple[Indices, Vector]] = field(default_factory=dict)

    def __post_init__(self) -> None:
        """Read the moves off the dynamics; the dangers follow when first needed."""
        self.motion = Motion.of(self.model)
        self._near_by = float(clearance_for(_NEAR * self.unit))

    @property
    def is_possible(self) -> bool:
        """Whether the search applies: in the plane, to vehicles that move."""
        return self.motion.is_planar

    @property
    def places(self) -> slice:
        """The outputs that are the vehicle's positions, step by step."""
        return slice(self.first, self.first + 2 * (self.model.horizon + 1))

    def path(self, price: float, delay_cost: float = 0.0) -> Matrix | None:
        """Return the best positions at each step.

        Parameters
        ----------
        rate : float
            Cost of risk, per unit of probability.
        haste : float
            Cost of every step at whose end the vehicle is not in its goal.

        Returns
        -------
        (T+1, 2) array or None
            Positions [m]; None where the lattice knows no way.
        """
        if not self._avoidances:
            self._avoidances = half_planes_of(self.program, self.model.horizon, self.places)
            for avoidance in (avoidance for at in self._avoidances for avoidance in at):
                known = self._deviations.get(avoidance.key, 0.0)
                self._deviations[avoidance.key] = max(known, avoidance.deviation)
        if (price, delay_cost) not in self._paths:
            self._paths[price, delay_cost] = self._refined_path(price, delay_cost)
        return self._paths[price, delay_cost]

    def _refined_path(self, price: float, delay_cost: float) -> Matrix | None:
        """Seek a way, on finer lattices where coarser ones know none, from then on there alone."""
        while True:
            moves = _MOVES[min(self.level, len(_MOVES) - 1)]
            lattice = coarse_lattice(self.model, self._avoidances, self.motion.longest, moves)
            if self.level == len(_MOVES):
                # Narrow ways may lie between the lines.
                lattice = snapped_lattice(lattice, self._avoidances)
            cells = self._search(lattice, price, delay_cost)
            if cells is not None:
                break
            if self.is_coarse_only or self.level == len(_MOVES):
                return None
            self.level += 1
        if lattice.lines is None:
            finer = finer_lattice(lattice, cells)
            found = self._search(finer, price, delay_cost)
            lattice, cells = finer, 2 * cells if found is None else found
        return lattice.positions(cells)

    def _search(self, lattice: Lattice, price: float, delay_cost: float) -> Indices | None:
        """Return the cheapest way over a lattice, (T+1, 2) cells from the start."""
        motion, horizon = self.motion, self.model.horizon
        moves = np.diff(lattice.reference, axis=0)
        width = 2 * lattice.moves + 1
        values = np.full((width, width, *lattice.shape), _INF, dtype=np.float32)
        origin = -lattice.first
        values[(slice(None), slice(None), *origin)] = motion.first_costs(
            moves[0] * lattice.stride, lattice.stride, lattice.moves
        )
        weight = np.float32(price)
        late = np.float32(delay_cost)
        arrivals: list[Float32] = []
        for k in range(horizon):
            if k > 0:
                tables = motion.change_costs(moves[k - 1], moves[k], lattice.stride, lattice.moves)
                values = _changed(values, tables)
            risks = self._risks(lattice, k)
            values += weight * risks
            values[risks > min(self.unit, CONVEX_RISK)] = _INF
            values = _shifted(values)
            values[:, :, ~self._within_reach(lattice, k + 1)] = _INF
            if delay_cost > 0.0:
                values[:, :, ~self._in_goal(lattice, k + 1)] += late
            arrivals.append(values)
        if values.min() >= 0.5 * _INF:
            return None
        return self._traced(lattice, arrivals)

    def _traced(self, lattice: Lattice, arrivals: list[Float32]) -> Indices:
        """Follow the cheapest way back from its end."""
        moves = np.diff(lattice.reference, axis=0)
        last = np.unravel_index(int(arrivals[-1].argmin()), arrivals[-1].shape)
        move, place = np.array(last[:2]), np.array(last[2:])
        places = [place]
        for k in range(self.model.horizon - 1, -1, -1):
            place = place - (move - lattice.moves)
            places.append(place)
            if k > 0:
                tables = self.motion.change_costs(
                    moves[k - 1], moves[k], lattice.stride, lattice.moves
                )
                total = arrivals[k - 1][:, :, place[0], place[1]]
                total = total + tables[0][move[0]][:, None] + tables[1][move[1]][None, :]
                move = np.array(np.unravel_index(int(total.argmin()), total.shape))
        return np.asarray(places[::-1] + lattice.first + lattice.reference)

    def _within_reach(self, lattice: Lattice, k: int) -> np.ndarray:
        """Whether places lie in the vehicle's reach at a step, up to half a cell."""
        return self._in_box(lattice, k, self.model.reach_lower[k], self.model.reach_upper[k])

    def _in_goal(self, lattice: Lattice, k: int) -> np.ndarray:
        """Whether places lie in the goal at a step, up to half a cell."""
        goal = self.model.vehicle.goal
        return self._in_box(lattice, k, goal.lower, goal.upper)

    def _in_box(self, lattice: Lattice, k: int, lower: Vector, upper: Vector) -> np.ndarray:
        """Whether places lie in a box at a step, up to half a cell."""
        inside = []
        for axis in (0, 1):
            cells = lattice.reference[k, axis] + lattice.first[axis]
            points = (cells + np.arange(lattice.shape[axis])) * lattice.stride[axis]
            points = points + lattice.start[axis]
            half = 0.5 * lattice.stride[axis]
            inside.append((points >= lower[axis] - half) & (points <= upper[axis] + half))
        return np.asarray(inside[0][:, None] & inside[1][None, :])

    def _risks(self, lattice: Lattice, k: int) -> Float32:
        """Return what every move from every place risks in the window that begins at a step."""
        width = 2 * lattice.moves + 1
        risks = np.zeros(width * width * lattice.shape[0] * lattice.shape[1])
        move = lattice.reference[k + 1] - lattice.reference[k]
        for avoidance in self._avoidances[k]:
            places, margins = self._near(lattice, lattice.reference[k], move, avoidance)
            if places.size:
                risks[places] += _tail(margins / avoidance.deviation)
        return risks.reshape(width, width, *lattice.shape).astype(np.float32)

    def _near(
        self, lattice: Lattice, reference: Indices, move: Indices, avoidance: AvoidanceHalfPlanes
    ) -> tuple[Indices, Vector]:
        """Return where a danger is near, and how near; known ones are not worked out again."""
        key = (
            avoidance.key,
            lattice.stride[0],
            lattice.shape,
            lattice.moves,
            lattice.lines is None,
            *reference,
            *move,
        )
        known = self._margins.get(key)
        if known is None:
            known = self._margins[key] = self._measured(lattice, reference, move, avoidance)
        return known

    def _measured(
        self, lattice: Lattice, reference: Indices, move: Indices, avoidance: AvoidanceHalfPlanes
    ) -> tuple[Indices, Vector]:
        """Return the moves along which the best side leaves little room, and how little."""
        near = self._near_by * self._deviations[avoidance.key] * 1.5
        axes = lattice.axes(reference)
        # Cells from which no move leads near are cut away first.
        longest = (lattice.moves + np.abs(move)) * lattice.stride
        rough = np.full(lattice.shape, -np.inf)
        for here, ahead in zip(avoidance.here, avoidance.ahead, strict=True):
            slack = np.full(lattice.shape, np.inf)
            for plane in (here, ahead):
                room = plane[2] - plane[0] * axes[0][:, None] - plane[1] * axes[1][None, :]
                slack = np.minimum(slack, room - np.abs(plane[:2]) @ longest)
            rough = np.maximum(rough, slack)
        x, y = np.nonzero(rough < near)
        steps = np.array(list(product(range(-lattice.moves, lattice.moves + 1), repeat=2))) + move
        points = np.column_stack([axes[0][x], axes[1][y]])
        reached = lattice.reached(points, (x, y), steps)
        best = np.full((len(steps), x.size), -np.inf)
        for here, ahead in zip(avoidance.here, avoidance.ahead, strict=True):
            now = here[2] - points @ here[:2]
            then = ahead[2] - ahead[0] * reached[0] - ahead[1] * reached[1]
            np.maximum(best, np.minimum(now[None, :], then), out=best)
        number, cell = np.nonzero(best < near)
        places = number * (lattice.shape[0] * lattice.shape[1])
        places = places + x[cell] * lattice.shape[1] + y[cell]
        return places, best[number, cell]


def _tail(clearances: Vector) -> Vector:
    """Return the tail probability, about: from a table."""
    numbers = (clearances * _FINENESS).astype(np.int64) + _FAR * _FINENESS
    return _TAILS[np.clip(numbers, 0, _TAILS.size - 1)]


def _changed(values: Float32, tables: tuple[Float32, Float32]) -> Float32:
    """Return the least value of each place and *next* move over all last moves."""
    for axis, table in enumerate(tables):
        source = np.moveaxis(values, axis, 0)
        result = np.full_like(source, _INF)
        for after, before in zip(*np.nonzero(table < _INF), strict=True):
            np.minimum(result[after], source[before] + table[after, before], out=result[after])
        values = np.moveaxis(result, 0, axis)
    return np.ascontiguousarray(values)


def _shifted(values: Float32) -> Float32:
    """Return the values where the moves lead to."""
    result = np.full_like(values, _INF)
    rows, columns = values.shape[2:]
    moves = values.shape[0] // 2
    for i, j in product(range(values.shape[0]), range(values.shape[1])):
        here, ahead = _overlap(rows, i - moves), _overlap(columns, j - moves)
        result[i, j][here[1], ahead[1]] = values[i, j][here[0], ahead[0]]
    return result


def _overlap(count: int, shift: int) -> tuple[slice, slice]:
    """Return which indices move by a shift to which, along one axis."""
    if shift >= 0:
        return slice(0, max(count - shift, 0)), slice(shift, count)
    return slice(-shift, count), slice(0, max(count + shift, 0))
