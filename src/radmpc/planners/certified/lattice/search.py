"""A vehicle's path among obstacles on a lattice of positions and displacements, at a price of risk.

Dynamic programming over (position, last displacement): a change of displacement costs the effort it
takes, and a displacement costs what the program's own rows say it risks, each avoidance with its
best alternative along the whole window. First on a coarse lattice over all the vehicle can reach,
then on finer ones in a tube around the path found. Dynamics, sagitta and the goal's variance are
left to the linear program with the alternatives that the path satisfies. A heuristic where
branching takes long to find a passage; it proves nothing.

The price is the cost of risk per unit of probability.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

import numpy as np

from radmpc.arrays import Indices, Matrix
from radmpc.gaussian import CONVEX_RISK
from radmpc.planners.certified.lattice.half_planes import AvoidanceHalfPlanes, half_planes_of
from radmpc.planners.certified.lattice.motion import Motion
from radmpc.planners.certified.lattice.positions import (
    Lattice,
    coarse_lattice,
    finer_lattice,
    snapped_lattice,
)
from radmpc.planners.certified.lattice.slacks import Slacks, slacks_of
from radmpc.planners.certified.lattice.tables import (
    INFEASIBLE,
    FeasibleValues,
    Float32,
    WindowCosts,
    add_tails,
    changed,
    moved,
)
from radmpc.planners.certified.lattice.tuning import TUNING
from radmpc.program.condensed import CondensedModel
from radmpc.program.program import DisjunctiveProgram
from radmpc.solvers.solution import Limits
from radmpc.system.memory import hand_back_freed

__all__ = ["PathSearch"]

SlacksByKey = dict[tuple[object, ...], Slacks]
"""How near an obstacle is on a lattice. Not kept from price to price: measuring a hundred boxes
again takes a sixth of a search's time."""

BLOCKED = 1.0 / 32.0
"""Deviations within an obstacle from which on a displacement is blocked: more than even odds of a
collision, which no avoidance may take, and more than one entry of the table of tails."""


@dataclass(eq=False)
class PathSearch:
    """The search for paths on lattices, by one vehicle's program.

    Attributes
    ----------
    program : DisjunctiveProgram
        Of one vehicle; others may be placed in it, as moving obstacles.
    model : CondensedModel
        The vehicle.
    unit : float
        The fleet's unit of risk [-]; no avoidance may take more than its row risk cap in a window.
    first : int
        Its first output: 0 unless others are placed.
    level : int
        The coarsest lattice to be tried; where it has no path, the search goes on to finer ones.
    is_coarse_only : bool
        Whether it ends there instead.
    """

    program: DisjunctiveProgram
    model: CondensedModel
    unit: float
    first: int = 0
    level: int = 0
    is_coarse_only: bool = False
    _avoidances: list[list[AvoidanceHalfPlanes]] = field(default_factory=list)
    _deviations: dict[tuple[bytes, bytes], float] = field(default_factory=dict)
    """The largest of each avoidance over all windows: what is near then is examined in all."""
    _paths: dict[tuple[float, float], Matrix | None] = field(default_factory=dict)

    def __post_init__(self) -> None:
        """Derive the motion from the dynamics; the avoidances follow when first needed."""
        self.motion = Motion.of(self.model)
        self._near_by = float(self.program.tail.clearance_for(TUNING.near * self.unit))

    @property
    def is_possible(self) -> bool:
        """Whether the search applies: in the plane, to vehicles that move, straight to goals."""
        is_direct = not self.model.vehicle.via and self.model.vehicle.goal.within is None
        return self.motion.is_planar and is_direct and not self.program.num_visits

    @property
    def output_slice(self) -> slice:
        """The outputs that are the vehicle's positions, step by step."""
        return slice(self.first, self.first + 2 * (self.model.horizon + 1))

    def path(self, price: float, limits: Limits, delay_cost: float = 0.0) -> Matrix | None:
        """Return the best positions at each step.

        Parameters
        ----------
        price : float
            Cost of risk, per unit of probability.
        limits : Limits
            When to stop early.
        delay_cost : float
            Cost of every step at whose end the vehicle is not in its goal.

        Returns
        -------
        (T+1, 2) array or None
            Positions [m]; None where the lattice has no path, or none was found in time.
        """
        self._look()
        if (price, delay_cost) not in self._paths:
            path = self._refined_path(price, delay_cost, limits)
            hand_back_freed()
            if limits.reached:
                return path
            self._paths[price, delay_cost] = path
        return self._paths[price, delay_cost]

    def rough_paths(
        self, price: float, most_risks: Sequence[float], limits: Limits
    ) -> Iterator[Matrix]:
        """Find the best positions on the coarse lattice alone, as in `path`.

        Parameters
        ----------
        price, limits
            As there.
        most_risks : sequence of float
            What an avoidance may take in a window at most, path by path [-].

        Yields
        ------
        (T+1, 2) array
            Positions [m], until there is no path.
        """
        self._look()
        lattice = self._lattice()
        known: SlacksByKey = {}
        for most_risk in most_risks:
            cells = self._search(lattice, price, 0.0, limits, known, most_risk)
            if cells is None:
                return
            yield lattice.positions(cells)

    def _look(self) -> None:
        """Lay out the avoidances, once."""
        if self._avoidances:
            return
        self._avoidances = half_planes_of(self.program, self.model.horizon, self.output_slice)
        for avoidance in (avoidance for at in self._avoidances for avoidance in at):
            largest = self._deviations.get(avoidance.key, 0.0)
            self._deviations[avoidance.key] = max(largest, avoidance.deviation)

    def _lattice(self) -> Lattice:
        """Lay out the lattice of the level."""
        reach = TUNING.reaches[min(self.level, len(TUNING.reaches) - 1)]
        lattice = coarse_lattice(self.model, self._avoidances, self.motion.longest, reach)
        # Narrow passages may lie between the lines.
        is_last = self.level == len(TUNING.reaches)
        return snapped_lattice(lattice, self._avoidances) if is_last else lattice

    def _refined_path(self, price: float, delay_cost: float, limits: Limits) -> Matrix | None:
        """Seek a path, on finer lattices where coarser ones have none, from then on there alone."""
        while True:
            lattice = self._lattice()
            cells = self._search(lattice, price, delay_cost, limits, {}, self.unit)
            if cells is not None:
                break
            if limits.reached or self.is_coarse_only or self.level == len(TUNING.reaches):
                return None
            self.level += 1
        if lattice.lines is None:
            finer = finer_lattice(lattice, cells)
            found = self._search(finer, price, delay_cost, limits, {}, self.unit)
            lattice, cells = finer, 2 * cells if found is None else found
        return lattice.positions(cells)

    def _search(
        self,
        lattice: Lattice,
        price: float,
        delay_cost: float,
        limits: Limits,
        known: SlacksByKey,
        most_risk: float,
    ) -> Indices | None:
        """Return the cheapest path over a lattice, (T+1, 2) cells from the start."""
        motion, reach = self.motion, lattice.reach
        displacements = np.diff(lattice.reference, axis=0)
        shape = 2 * reach + 1, 2 * reach + 1, *lattice.shape
        row, column = (int(place) for place in -lattice.first)
        values = np.full(shape, INFEASIBLE, dtype=np.float32)
        values[:, :, row, column] = motion.first_costs(
            displacements[0] * lattice.stride, lattice.stride, reach
        )
        box, arrivals = (row, row + 1, column, column + 1), list[FeasibleValues]()
        tables = self._tables(lattice)
        for k in range(self.model.horizon):
            if limits.reached:
                return None
            if k > 0:
                values = changed(values, tables[k - 1], box)
            ahead = lattice.box(k + 1, self.model.reach_lower[k + 1], self.model.reach_upper[k + 1])
            costs = self._window_costs(lattice, k, known, price, most_risk, delay_cost)
            values = moved(values, costs, box, ahead)
            arrivals.append(FeasibleValues.of(values, ahead))
            if not arrivals[-1].values.size:
                return None
            box = ahead
        return self._traced(lattice, tables, arrivals)

    def _tables(self, lattice: Lattice) -> list[tuple[Float32, Float32]]:
        """Return the effort of changes from each displacement to the next."""
        known: dict[bytes, tuple[Float32, Float32]] = {}
        found, displacements = [], np.diff(lattice.reference, axis=0)
        for k in range(1, len(displacements)):
            last, following = displacements[k - 1 : k + 1]
            key = displacements[k - 1 : k + 1].tobytes()
            if key not in known:
                parts = last, following, lattice.stride, lattice.reach
                known[key] = self.motion.change_costs(*parts)
            found.append(known[key])
        return found

    def _traced(
        self,
        lattice: Lattice,
        tables: list[tuple[Float32, Float32]],
        arrivals: list[FeasibleValues],
    ) -> Indices:
        """Follow the cheapest path back from its end."""
        last = arrivals[-1].cheapest
        displacement, cell = np.array(last[:2]), np.array(last[2:])
        cells = [cell]
        for k in range(self.model.horizon - 1, -1, -1):
            cell = cell - (displacement - lattice.reach)
            cells.append(cell)
            if k > 0:
                total = arrivals[k - 1].at(int(cell[0]), int(cell[1]))
                along, across = tables[k - 1]
                total = total + along[displacement[0]][:, None] + across[displacement[1]][None, :]
                displacement = np.array(np.unravel_index(int(total.argmin()), total.shape))
        return np.asarray(cells[::-1] + lattice.first + lattice.reference)

    def _window_costs(
        self,
        lattice: Lattice,
        k: int,
        known: SlacksByKey,
        price: float,
        most_risk: float,
        delay_cost: float,
    ) -> WindowCosts:
        """Return what displacements risk in the window after a step, and which are blocked.

        What stands still is measured once: `known` keeps it from window to window.
        """
        count = (2 * lattice.reach + 1) ** 2 * lattice.shape[0] * lattice.shape[1]
        risks, blocked = np.zeros(count, np.float32), np.zeros((count + 7) // 8, np.uint8)
        here = lattice.reference[k]
        displacement = lattice.reference[k + 1] - here
        for avoidance in self._avoidances[k]:
            key = (avoidance.key, *here, *displacement)
            if key not in known:
                bounds = self._slack_bounds(avoidance)
                known[key] = slacks_of(lattice, here, displacement, avoidance, bounds)
            slacks = known[key]
            if slacks.bits.size:
                blocked |= slacks.bits
            if slacks.numbers.size:
                add_tails(risks, slacks, avoidance.deviation, self.program.tail)
        goal = self.model.vehicle.goal
        is_timed = delay_cost > 0.0
        in_time = lattice.box(k + 1, goal.lower, goal.upper) if is_timed else lattice.everywhere
        return WindowCosts(risks, blocked, price, min(most_risk, CONVEX_RISK), delay_cost, in_time)

    def _slack_bounds(self, avoidance: AvoidanceHalfPlanes) -> tuple[float, float]:
        """Return the slack that is too little whatever the risk, and what counts as little [m]."""
        largest = self._deviations[avoidance.key]
        return -BLOCKED * largest, self._near_by * largest * 1.5
