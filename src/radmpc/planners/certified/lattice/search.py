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
import numpy.typing as npt

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
    changed,
    shifted,
    tail_of,
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
        motion, horizon = self.motion, self.model.horizon
        displacements = np.diff(lattice.reference, axis=0)
        width = 2 * lattice.reach + 1
        values = np.full((width, width, *lattice.shape), INFEASIBLE, dtype=np.float32)
        origin = -lattice.first
        values[(slice(None), slice(None), *origin)] = motion.first_costs(
            displacements[0] * lattice.stride, lattice.stride, lattice.reach
        )
        weight = np.float32(price)
        late = np.float32(delay_cost)
        arrivals: list[FeasibleValues] = []
        for k in range(horizon):
            if limits.reached:
                return None
            if k > 0:
                tables = motion.change_costs(
                    displacements[k - 1], displacements[k], lattice.stride, lattice.reach
                )
                values = changed(values, tables)
            risks, is_blocked = self._risks(lattice, k, known)
            values += weight * risks
            values[is_blocked | (risks > min(most_risk, CONVEX_RISK))] = INFEASIBLE
            values = shifted(values)
            values[:, :, ~self._within_reach(lattice, k + 1)] = INFEASIBLE
            if delay_cost > 0.0:
                values[:, :, ~self._in_goal(lattice, k + 1)] += late
            arrivals.append(FeasibleValues.of(values))
        if values.min() >= 0.5 * INFEASIBLE:
            return None
        return self._traced(lattice, arrivals)

    def _traced(self, lattice: Lattice, arrivals: list[FeasibleValues]) -> Indices:
        """Follow the cheapest path back from its end."""
        displacements = np.diff(lattice.reference, axis=0)
        last = np.unravel_index(int(arrivals[-1].whole().argmin()), arrivals[-1].shape)
        displacement, cell = np.array(last[:2]), np.array(last[2:])
        cells = [cell]
        for k in range(self.model.horizon - 1, -1, -1):
            cell = cell - (displacement - lattice.reach)
            cells.append(cell)
            if k > 0:
                tables = self.motion.change_costs(
                    displacements[k - 1], displacements[k], lattice.stride, lattice.reach
                )
                total = arrivals[k - 1].whole()[:, :, cell[0], cell[1]]
                total = (
                    total
                    + tables[0][displacement[0]][:, None]
                    + tables[1][displacement[1]][None, :]
                )
                displacement = np.array(np.unravel_index(int(total.argmin()), total.shape))
        return np.asarray(cells[::-1] + lattice.first + lattice.reference)

    def _within_reach(self, lattice: Lattice, k: int) -> npt.NDArray[np.bool_]:
        """Whether positions lie in the vehicle's reach at a step, up to half a cell."""
        return lattice.inside(k, self.model.reach_lower[k], self.model.reach_upper[k])

    def _in_goal(self, lattice: Lattice, k: int) -> npt.NDArray[np.bool_]:
        """Whether positions lie in the goal at a step, up to half a cell."""
        goal = self.model.vehicle.goal
        return lattice.inside(k, goal.lower, goal.upper)

    def _risks(
        self, lattice: Lattice, k: int, known: SlacksByKey
    ) -> tuple[Float32, npt.NDArray[np.bool_]]:
        """Return what every displacement risks in the window after a step, and which are blocked.

        What stands still is measured once: `known` keeps it from window to window.
        """
        width = 2 * lattice.reach + 1
        shape = (width, width, *lattice.shape)
        risks = np.zeros(width * width * lattice.shape[0] * lattice.shape[1])
        is_blocked = np.zeros(risks.shape, dtype=np.bool_)
        here = lattice.reference[k]
        displacement = lattice.reference[k + 1] - here
        for avoidance in self._avoidances[k]:
            key = (avoidance.key, *here, *displacement)
            if key not in known:
                bounds = self._slack_bounds(avoidance)
                known[key] = slacks_of(lattice, here, displacement, avoidance, bounds)
            slacks = known[key]
            blocked = slacks.blocked(risks.size)
            if blocked is not None:
                is_blocked |= blocked
            if slacks.numbers.size:
                clearances = slacks.values / avoidance.deviation
                risks[slacks.numbers] += tail_of(clearances, self.program.tail)
        return risks.reshape(shape).astype(np.float32), is_blocked.reshape(shape)

    def _slack_bounds(self, avoidance: AvoidanceHalfPlanes) -> tuple[float, float]:
        """Return the slack that is too little whatever the risk, and what counts as little [m]."""
        largest = self._deviations[avoidance.key]
        return -BLOCKED * largest, self._near_by * largest * 1.5
