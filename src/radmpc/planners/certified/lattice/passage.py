"""Incumbents of a single vehicle among many dangers: a way on a lattice, then a small search."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from radmpc.arrays import Matrix, Vector
from radmpc.planners.certified.lattice.search import Walk
from radmpc.program.restrict import along
from radmpc.solvers.priced.around import search_around
from radmpc.solvers.priced.nodes import Incumbent
from radmpc.solvers.priced.rating import Rater
from radmpc.solvers.priced.tree import RiskTree
from radmpc.solvers.solution import Limits

__all__ = ["Passage"]

_NODES = 50
_NODES_ALONG = 150

_ROUGH_GAP = 0.05

_ROOM = 1.0
"""How far a plan may be off its way on the lattice, in longest moves."""

_STEP_SHARE = 0.01
"""Share of the risk bound that a vehicle in haste risks to gain a step."""


@dataclass(frozen=True, slots=True)
class _Pace:
    """What small searches go by: a price of risk, a scale of values, when to stop."""

    price: float
    scale: float
    limits: Limits
    nodes: int


@dataclass(frozen=True, slots=True, eq=False)
class Passage:
    """Ways through, sought anew at every price.

    Attributes
    ----------
    walk : Walk
        The lattice search of the vehicle's program.
    rater : Rater
        The program, laid out for rating.
    """

    walk: Walk
    rater: Rater

    def found(
        self, price: float, scale: float, limits: Limits, known: Incumbent | None
    ) -> Incumbent | None:
        """Return a plan at a price of a unit of risk; None where no way was found.

        Parameters
        ----------
        price : float
            Of one unit of risk.
        scale : float
            Value below which gaps are taken of this.
        limits : Limits
            When to stop early.
        known : Incumbent or None
            The best plan so far.

        Returns
        -------
        Incumbent or None
            No worse than the plan given.
        """
        best, pace = known, _Pace(price, scale, limits, _NODES)
        way = self.walk.way(price / self.walk.unit)
        if way is not None:
            best = _better(best, self._along(self.rater, way, pace), price / self.walk.unit)
        if best is None:
            return None
        return self._around(self.rater, self.rater.program.slacks(best.z), best, pace)

    def hurried(self, limits: Limits) -> Incumbent | None:
        """Return a plan that waits where it must and then loses no time; None if none was found.

        It leaves the way to others, who may find none past a vehicle that takes all its time.

        Parameters
        ----------
        limits : Limits
            When to stop early.
        """
        walk, unit = self.walk, self.walk.unit
        # Where no effort is needed, or none counts, any price makes haste.
        haste = walk.motion.start_cost or 1.0
        # A step is worth about a hundredth of the bound.
        rate = haste / (_STEP_SHARE * self.rater.program.risk_bound)
        way = walk.way(rate, haste)
        if way is None:
            return None
        room = np.tile(_ROOM * walk.motion.longest, len(way))
        program = along(self.rater.program, walk.places, way.ravel(), room)
        rater = Rater(program, unit)
        found = self._along(rater, way, _Pace(rate * unit, haste, limits, _NODES_ALONG))
        # The lattice knows no sagitta: a side that it passes on may not hold, or not be the best.
        tree = RiskTree(
            program, unit, rate * unit, gap=_ROUGH_GAP, scale=haste, limits=limits, rater=rater
        )
        if found is not None:
            tree.consider(found.z)
        tree.run(_NODES_ALONG)
        return tree.best

    def _along(self, rater: Rater, way: Matrix, pace: _Pace) -> Incumbent | None:
        """Return a plan that passes everything on the way's sides, or about."""
        program = rater.program
        outputs = program.constant.copy()
        outputs[self.walk.places] = way.ravel()
        outputs[program.num_positions :] = 0.0
        slacks = program.rows.offsets - program.rows.normals @ outputs
        found = self._around(rater, slacks, None, pace)
        if found is None and not pace.limits.reached:
            # In a maze too many sides are in doubt: first those of the way, all of them.
            found = self._around(rater, slacks, None, pace, is_rigid=True)
            if found is not None:
                found = self._around(rater, program.slacks(found.z), found, pace)
        return found

    def _around(
        self,
        rater: Rater,
        slacks: Vector,
        beat: Incumbent | None,
        pace: _Pace,
        *,
        is_rigid: bool = False,
    ) -> Incumbent | None:
        """Search near a way for a plan, or for a better one."""
        return search_around(
            rater,
            slacks,
            beat,
            move=float(self.walk.motion.longest.max()),
            unit=self.walk.unit,
            price=pace.price,
            scale=pace.scale,
            limits=pace.limits,
            max_nodes=pace.nodes,
            is_rigid=is_rigid,
        )


def _better(one: Incumbent | None, two: Incumbent | None, rate: float) -> Incumbent | None:
    """Return the plan of less cost and priced risk."""
    plans = [plan for plan in (one, two) if plan is not None]
    return min(plans, key=lambda plan: plan.cost + rate * plan.risk, default=None)
