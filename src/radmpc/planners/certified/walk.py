"""A vehicle's way among dangers on a lattice of places and moves, at a price of risk.

Dynamic programming over (place, last move): a change of move costs the effort it takes, and a move
costs what the programme's own rows say it risks, each avoidance at its best side along the whole
move. First on a coarse lattice over all the vehicle can reach, then on finer ones in a tube around
the way found. Dynamics, bow and the goal's variance are left to the linear programme of the sides
that the way passes things on. A heuristic where branching takes long to find a passage; it proves
nothing.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from itertools import product

import numpy as np
import numpy.typing as npt

from radmpc.arrays import Indices, Matrix, Vector
from radmpc.gaussian import tail_probability
from radmpc.planners.certified.motion import Motion
from radmpc.program.program import DisjunctiveProgram
from radmpc.program.subject import Subject

__all__ = ["Walk"]

_MOVES = (3, 6)
"""Cells that the longest move covers, each way; finer where a coarser lattice knows no way."""

_MOVES_AROUND = 3
"""Cells that a move may differ from that of a way which is refined."""

_MAX_CELLS = 20_000
_REFINEMENTS = 1
_TUBE = 4
"""Cells on each side of a way within which the next, finer one is sought."""

_NEAR = 4.5
"""Clearance beyond which an avoidance costs nothing here (3e-6)."""

_NARROW = 3.0
"""Gaps, in cells, whose middles are given a line of their own."""

_INF = np.float32(1e9)

_FINENESS = 64
_TAILS = tail_probability(np.arange(-6 * _FINENESS, 6 * _FINENESS + 1) / _FINENESS)
"""The tail at every sixty-fourth of a deviation."""

Float32 = npt.NDArray[np.float32]


@dataclass(frozen=True, slots=True, eq=False)
class _Danger:
    """One avoidance over a window: half-planes at its start and at its end, side by side.

    Attributes
    ----------
    here, ahead : (s, 3) array
        Normal and offset per side; a normal of 0 and an offset of inf where nothing is asked.
    deviation : float
        The largest standard deviation of its rows [m].
    """

    here: Matrix
    ahead: Matrix
    deviation: float

    @property
    def key(self) -> tuple[bytes, bytes]:
        """What makes two windows of a danger that does not move the same."""
        return self.here.tobytes(), self.ahead.tobytes()


@dataclass(frozen=True, slots=True, eq=False)
class _Lattice:
    """Places and moves around a reference way.

    Attributes
    ----------
    stride : (2,) array
        Size of a cell [m].
    reference : (T+1, 2) int array
        Cell around which places are counted at each step, relative to the start.
    first : (2,) int array
        First place along each axis, relative to the reference.
    shape : (int, int)
        Places along each axis.
    moves : int
        Cells, each way, that a move may differ from the reference's.
    lines : pair of array or None
        Where the places really are along each axis [m], where they are not evenly spaced.
    """

    stride: Vector
    reference: Indices
    first: Indices
    shape: tuple[int, int]
    moves: int
    lines: tuple[Vector, Vector] | None = None


@dataclass(eq=False)
class Walk:
    """The lattice search of one vehicle's programme.

    Parameters
    ----------
    program : DisjunctiveProgram
        Of one vehicle; others may be placed in it, as moving obstacles.
    subject : Subject
        The vehicle.
    unit : float
        Most that one avoidance may risk along a move.
    first : int
        Its first output: 0 unless others are placed.
    is_quick : bool
        Whether finer lattices are left out where the coarse one knows no way.
    """

    program: DisjunctiveProgram
    subject: Subject
    unit: float
    first: int = 0
    is_quick: bool = False
    _dangers: list[list[_Danger]] = field(default_factory=list)
    _margins: dict[tuple[object, ...], tuple[Indices, Vector]] = field(default_factory=dict)

    def __post_init__(self) -> None:
        """Read the moves off the dynamics; the dangers follow when first needed."""
        self.motion = Motion.of(self.subject)

    @property
    def is_possible(self) -> bool:
        """Whether the search applies: in the plane, to vehicles that move."""
        return self.motion.is_planar

    @property
    def places(self) -> slice:
        """The outputs that are the vehicle's positions, step by step."""
        return slice(self.first, self.first + 2 * (self.subject.horizon + 1))

    def way(self, rate: float, haste: float = 0.0) -> Matrix | None:
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
        if not self._dangers:
            self._dangers = _dangers(self.program, self.subject.horizon, self.places)
        for moves in _MOVES[:1] if self.is_quick else _MOVES:
            lattice = self._coarse(moves)
            cells = self._search(lattice, rate, haste)
            if cells is not None:
                break
        else:
            if self.is_quick:
                return None
            # Narrow ways may lie between the lines of a lattice.
            lattice = self._snapped(self._coarse(_MOVES[-1]))
            cells = self._search(lattice, rate, haste)
            return None if cells is None else self._positions(lattice, cells)
        for _ in range(_REFINEMENTS):
            if cells is None:
                return None
            lattice = _Lattice(
                0.5 * lattice.stride,
                2 * cells,
                np.full(2, -_TUBE, dtype=np.int64),
                (2 * _TUBE + 1, 2 * _TUBE + 1),
                _MOVES_AROUND,
            )
            finer = self._search(lattice, rate, haste)
            cells = 2 * cells if finer is None else finer
        return None if cells is None else self._positions(lattice, cells)

    def _positions(self, lattice: _Lattice, cells: Indices) -> Matrix:
        """Return where cells, counted from the start, are [m]."""
        if lattice.lines is None:
            return np.asarray(self._start + cells * lattice.stride)
        places = (cells - lattice.first).T
        return np.column_stack(
            [line[place] for line, place in zip(lattice.lines, places, strict=True)]
        )

    def _snapped(self, lattice: _Lattice) -> _Lattice:
        """Return a lattice whose lines run through the middles of gaps between parallel sides."""
        lines = []
        for axis in (0, 1):
            count = lattice.first[axis] + np.arange(lattice.shape[axis])
            line = self._start[axis] + lattice.stride[axis] * count
            for middle in self._gaps(axis, _NARROW * float(lattice.stride[axis])):
                nearest = int(np.abs(line - middle).argmin())
                if abs(line[nearest] - middle) <= 0.5 * lattice.stride[axis]:
                    line[nearest] = middle
            lines.append(line)
        return replace(lattice, lines=(lines[0], lines[1]))

    def _gaps(self, axis: int, widest: float) -> list[float]:
        """Return the middles of gaps along an axis, the narrowest last."""
        lower, upper = set[float](), set[float]()
        for danger in {danger.key: danger for at in self._dangers for danger in at}.values():
            for normal in danger.here:
                if abs(normal[axis]) > 1e-9 and abs(normal[1 - axis]) < 1e-9:
                    limit = float(np.round(normal[2] / normal[axis], 6))
                    (upper if normal[axis] > 0.0 else lower).add(limit)
        pairs = [(high - low, 0.5 * (high + low)) for low in lower for high in upper]
        gaps = sorted((pair for pair in pairs if 0.0 < pair[0] <= widest), reverse=True)
        return [middle for _, middle in gaps]

    @property
    def _start(self) -> Vector:
        """Return where the vehicle starts."""
        start: Vector = self.subject.drift_position[0]
        return start

    def _coarse(self, moves: int) -> _Lattice:
        """Return the lattice over everything in reach."""
        low = self.subject.reach_lower.min(axis=0) - self._start
        high = self.subject.reach_upper.max(axis=0) - self._start
        stride = self.motion.longest / moves
        while np.prod(np.floor(high / stride) - np.ceil(low / stride) + 1) > _MAX_CELLS:
            stride = stride * 1.25
        first = np.ceil(low / stride).astype(np.int64)
        last = np.floor(high / stride).astype(np.int64)
        shape = (int(last[0] - first[0]) + 1, int(last[1] - first[1]) + 1)
        still = np.zeros((self.subject.horizon + 1, 2), dtype=np.int64)
        return _Lattice(stride, still, first, shape, moves)

    def _search(self, lattice: _Lattice, rate: float, haste: float) -> Indices | None:
        """Return the cheapest way over a lattice, (T+1, 2) cells from the start."""
        motion, horizon = self.motion, self.subject.horizon
        moves = np.diff(lattice.reference, axis=0)
        width = 2 * lattice.moves + 1
        values = np.full((width, width, *lattice.shape), _INF, dtype=np.float32)
        origin = -lattice.first
        values[(slice(None), slice(None), *origin)] = motion.first_costs(
            moves[0] * lattice.stride, lattice.stride, lattice.moves
        )
        weight = np.float32(rate)
        late = np.float32(haste)
        arrivals: list[Float32] = []
        for k in range(horizon):
            if k > 0:
                tables = motion.change_costs(moves[k - 1], moves[k], lattice.stride, lattice.moves)
                values = _changed(values, tables)
            risks = self._risks(lattice, k)
            values += weight * risks
            values[risks > self.unit] = _INF
            values = _shifted(values)
            values[:, :, ~self._within_reach(lattice, k + 1)] = _INF
            if haste > 0.0:
                values[:, :, ~self._in_goal(lattice, k + 1)] += late
            arrivals.append(values)
        if values.min() >= 0.5 * _INF:
            return None
        return self._traced(lattice, arrivals)

    def _traced(self, lattice: _Lattice, arrivals: list[Float32]) -> Indices:
        """Follow the cheapest way back from its end."""
        moves = np.diff(lattice.reference, axis=0)
        last = np.unravel_index(int(arrivals[-1].argmin()), arrivals[-1].shape)
        move, place = np.array(last[:2]), np.array(last[2:])
        places = [place]
        for k in range(self.subject.horizon - 1, -1, -1):
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

    def _within_reach(self, lattice: _Lattice, k: int) -> np.ndarray:
        """Whether places lie in the vehicle's reach at a step, up to half a cell."""
        return self._in_box(lattice, k, self.subject.reach_lower[k], self.subject.reach_upper[k])

    def _in_goal(self, lattice: _Lattice, k: int) -> np.ndarray:
        """Whether places lie in the goal at a step, up to half a cell."""
        goal = self.subject.vehicle.goal
        return self._in_box(lattice, k, goal.lower, goal.upper)

    def _in_box(self, lattice: _Lattice, k: int, lower: Vector, upper: Vector) -> np.ndarray:
        """Whether places lie in a box at a step, up to half a cell."""
        inside = []
        for axis in (0, 1):
            cells = lattice.reference[k, axis] + lattice.first[axis]
            points = (cells + np.arange(lattice.shape[axis])) * lattice.stride[axis]
            points = points + self._start[axis]
            half = 0.5 * lattice.stride[axis]
            inside.append((points >= lower[axis] - half) & (points <= upper[axis] + half))
        return np.asarray(inside[0][:, None] & inside[1][None, :])

    def _risks(self, lattice: _Lattice, k: int) -> Float32:
        """Return what every move from every place risks in the window that begins at a step."""
        width = 2 * lattice.moves + 1
        risks = np.zeros(width * width * lattice.shape[0] * lattice.shape[1])
        move = lattice.reference[k + 1] - lattice.reference[k]
        for danger in self._dangers[k]:
            places, margins = self._near(lattice, lattice.reference[k], move, danger)
            if places.size:
                risks[places] += _tail(margins / danger.deviation)
        return risks.reshape(width, width, *lattice.shape).astype(np.float32)

    def _axes(self, lattice: _Lattice, reference: Indices) -> list[Vector]:
        """Return where the places are along each axis [m]."""
        if lattice.lines is not None:
            return list(lattice.lines)
        counts = [reference[a] + lattice.first[a] + np.arange(lattice.shape[a]) for a in (0, 1)]
        return [self._start[a] + lattice.stride[a] * counts[a] for a in (0, 1)]

    def _reached(
        self,
        lattice: _Lattice,
        points: Matrix,
        places: tuple[Indices, Indices],
        steps: Indices,
    ) -> list[Matrix]:
        """Return where moves from places lead to along each axis, (moves, places) [m]."""
        if lattice.lines is None:
            shift = steps * lattice.stride
            return [points[:, a][None, :] + shift[:, a][:, None] for a in (0, 1)]
        return [
            line[np.clip(place[None, :] + steps[:, a][:, None], 0, len(line) - 1)]
            for a, (line, place) in enumerate(zip(lattice.lines, places, strict=True))
        ]

    def _near(
        self, lattice: _Lattice, reference: Indices, move: Indices, danger: _Danger
    ) -> tuple[Indices, Vector]:
        """Return where a danger is near, and how near; known ones are not worked out again."""
        key = (
            danger.key,
            lattice.stride[0],
            lattice.shape,
            lattice.moves,
            lattice.lines is None,
            *reference,
            *move,
        )
        known = self._margins.get(key)
        if known is None:
            known = self._margins[key] = self._measured(lattice, reference, move, danger)
        return known

    def _measured(
        self, lattice: _Lattice, reference: Indices, move: Indices, danger: _Danger
    ) -> tuple[Indices, Vector]:
        """Return the moves along which the best side leaves little room, and how little."""
        near = _NEAR * danger.deviation * 1.5
        axes = self._axes(lattice, reference)
        # Cells from which no move leads near are cut away first.
        longest = (lattice.moves + np.abs(move)) * lattice.stride
        rough = np.full(lattice.shape, -np.inf)
        for here, ahead in zip(danger.here, danger.ahead, strict=True):
            slack = np.full(lattice.shape, np.inf)
            for plane in (here, ahead):
                room = plane[2] - plane[0] * axes[0][:, None] - plane[1] * axes[1][None, :]
                slack = np.minimum(slack, room - np.abs(plane[:2]) @ longest)
            rough = np.maximum(rough, slack)
        x, y = np.nonzero(rough < near)
        steps = np.array(list(product(range(-lattice.moves, lattice.moves + 1), repeat=2))) + move
        points = np.column_stack([axes[0][x], axes[1][y]])
        reached = self._reached(lattice, points, (x, y), steps)
        best = np.full((len(steps), x.size), -np.inf)
        for here, ahead in zip(danger.here, danger.ahead, strict=True):
            now = here[2] - points @ here[:2]
            then = ahead[2] - ahead[0] * reached[0] - ahead[1] * reached[1]
            np.maximum(best, np.minimum(now[None, :], then), out=best)
        number, cell = np.nonzero(best < near)
        places = number * (lattice.shape[0] * lattice.shape[1])
        places = places + x[cell] * lattice.shape[1] + y[cell]
        return places, best[number, cell]


def _tail(clearances: Vector) -> Vector:
    """Return the tail probability, about: from a table."""
    numbers = (clearances * _FINENESS).astype(np.int64) + 6 * _FINENESS
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


def _dangers(program: DisjunctiveProgram, horizon: int, own: slice) -> list[list[_Danger]]:
    """Return the avoidances of each window; where others are placed is part of the offsets."""
    rows = program.rows
    others = program.constant[: program.num_positions].copy()
    others[own] = 0.0
    offsets = rows.offsets - rows.normals[:, : program.num_positions] @ others
    places = rows.normals[:, own].tocoo()
    normals = np.zeros((rows.count, 2))
    normals[places.row, places.col % 2] = places.data
    steps = np.full(rows.count, -1)
    steps[places.row] = places.col // 2
    is_interval = bool(np.any(np.diff(program.alternative_starts) == 2))
    found: list[list[_Danger]] = [[] for _ in range(horizon)]
    for avoidance, label in enumerate(program.avoidances):
        k = label.step - (0 if is_interval else 1)
        sides = program.alternatives_of(avoidance)
        here, ahead = (np.tile([0.0, 0.0, np.inf], (len(sides), 1)) for _ in range(2))
        deviation = 1e-9
        for number, side in enumerate(sides):
            for row in program.rows_of(side):
                plane = here if steps[row] == k else ahead
                plane[number] = [*normals[row], offsets[row]]
                deviation = max(deviation, float(rows.deviations[row]))
        found[k].append(_Danger(here, ahead, deviation))
    return found
