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
from radmpc.planners.certified.lattice.cheapest import cheapest_cells
from radmpc.planners.certified.lattice.half_planes import AvoidanceHalfPlanes, half_planes_of
from radmpc.planners.certified.lattice.motion import Motion
from radmpc.planners.certified.lattice.positions import (
    Lattice,
    coarse_lattice,
    finer_lattice,
    snapped_lattice,
)
from radmpc.planners.certified.lattice.slacks import Slacks, slacks_of
from radmpc.planners.certified.lattice.tables import WindowCosts, add_tails
from radmpc.planners.certified.lattice.tuning import TUNING
from radmpc.program.condensed import CondensedModel
from radmpc.program.program import DisjunctiveProgram
from radmpc.solvers.solution import Limits
from radmpc.system.memory import hand_back_freed

__all__ = ["PathSearch", "SlacksByKey"]

SlacksByKey = dict[tuple[object, ...], Slacks]
"""How near an obstacle is on a lattice. Not kept from price to price: measuring a hundred boxes
again takes a sixth of a search's time."""

BLOCKED = 1.0 / 32.0
"""Deviations within an obstacle from which on a displacement is blocked: more than even odds of a
collision, which no avoidance may take, and more than one entry of the table of tails."""

Others = Sequence[Sequence[AvoidanceHalfPlanes]]
"""What a path keeps clear of in each window besides the program's avoidances."""


@dataclass(frozen=True)
class _Terms:
    """What a path costs besides its effort, what it may risk, and when to stop.

    The price of risk is per unit of probability, as the most that an avoidance may take in a
    window; the cost of delay is that of every step at whose end the vehicle is not in its goal.
    """

    price: float
    most_risk: float
    limits: Limits
    delay_cost: float = 0.0
    others: Others = ()


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
            cells = self._search(lattice, _Terms(price, most_risk, limits), known)
            if cells is None:
                return
            yield lattice.positions(cells)

    def path_among(
        self,
        others: Others,
        price: float,
        most_risk: float,
        limits: Limits,
        known: SlacksByKey,
    ) -> Matrix | None:
        """Return the best positions on the coarse lattice among others.

        Parameters
        ----------
        others : sequence of sequence of AvoidanceHalfPlanes
            What it keeps clear of in each window besides the program's avoidances.
        price, limits
            As in `path`.
        most_risk : float
            What an avoidance may take in a window at most [-].
        known : dict
            What is known of the program's avoidances from one search to the next; filled.

        Returns
        -------
        (T+1, 2) array or None
            Positions [m]; None where there is no path, or none was found in time.
        """
        self._look()
        lattice = self._lattice()
        terms = _Terms(price, most_risk, limits, others=others)
        cells = self._search(lattice, terms, known)
        return None if cells is None else lattice.positions(cells)

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
        terms = _Terms(price, self.unit, limits, delay_cost)
        while True:
            lattice = self._lattice()
            cells = self._search(lattice, terms, {})
            if cells is not None:
                break
            if limits.reached or self.is_coarse_only or self.level == len(TUNING.reaches):
                return None
            self.level += 1
        if lattice.lines is None:
            finer = finer_lattice(lattice, cells)
            found = self._search(finer, terms, {})
            lattice, cells = finer, 2 * cells if found is None else found
        return lattice.positions(cells)

    def _search(self, lattice: Lattice, terms: _Terms, known: SlacksByKey) -> Indices | None:
        """Return the cheapest path over a lattice, (T+1, 2) cells from the start."""

        def costs(k: int) -> WindowCosts:
            return self._window_costs(lattice, k, terms, known)

        return cheapest_cells(lattice, self.model, self.motion, costs, terms.limits)

    def _window_costs(
        self, lattice: Lattice, k: int, terms: _Terms, known: SlacksByKey
    ) -> WindowCosts:
        """Return what displacements risk in the window after a step, and which are blocked.

        What stands still is measured once: `known` keeps it from window to window.
        """
        count = (2 * lattice.reach + 1) ** 2 * lattice.shape[0] * lattice.shape[1]
        risks, blocked = np.zeros(count, np.float32), np.zeros((count + 7) // 8, np.uint8)
        here = lattice.reference[k]
        displacement = lattice.reference[k + 1] - here
        place = lattice, here, displacement
        near = []
        for avoidance in self._avoidances[k]:
            key = (avoidance.key, *here, *displacement)
            if key not in known:
                largest = self._deviations[avoidance.key]
                known[key] = slacks_of(*place, avoidance, self._slack_bounds(largest))
            near.append((avoidance, known[key]))
        for avoidance in terms.others[k] if terms.others else ():
            bounds = self._slack_bounds(avoidance.deviation)
            near.append((avoidance, slacks_of(*place, avoidance, bounds)))
        for avoidance, slacks in near:
            if slacks.bits.size:
                blocked |= slacks.bits
            if slacks.numbers.size:
                add_tails(risks, slacks, avoidance.deviation, self.program.tail)
        goal, is_timed = self.model.vehicle.goal, terms.delay_cost > 0.0
        in_time = lattice.box(k + 1, goal.lower, goal.upper) if is_timed else lattice.everywhere
        most = min(terms.most_risk, CONVEX_RISK)
        return WindowCosts(risks, blocked, terms.price, most, terms.delay_cost, in_time)

    def _slack_bounds(self, deviation: float) -> tuple[float, float]:
        """Return the slack that is too little whatever the risk, and what counts as little [m]."""
        return -BLOCKED * deviation, self._near_by * deviation * 1.5
