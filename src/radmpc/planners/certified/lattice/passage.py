"""Incumbents of a single vehicle among many obstacles: a path on a lattice, then a small search."""

from __future__ import annotations

import numpy as np

from radmpc.arrays import Matrix, Vector
from radmpc.planners.certified.lattice.search import PathSearch
from radmpc.planners.certified.lattice.tuning import TUNING
from radmpc.program.restrict import along
from radmpc.records import dataclass
from radmpc.solvers.priced.around import search_around
from radmpc.solvers.priced.nodes import Incumbent
from radmpc.solvers.priced.rating import Rater
from radmpc.solvers.priced.tree import RiskTree
from radmpc.solvers.solution import Limits

__all__ = ["Passage"]


@dataclass(frozen=True, slots=True)
class _Pace:
    """What small searches go by: the price of a unit of risk, a scale of values, when to stop."""

    unit_price: float
    scale: float
    limits: Limits
    nodes: int


@dataclass(frozen=True, slots=True, eq=False)
class Passage:
    """Paths through the obstacles, sought anew at every price.

    Attributes
    ----------
    path_search : PathSearch
        The lattice search of the vehicle's program.
    rater : Rater
        The program, laid out for rating.
    """

    path_search: PathSearch
    rater: Rater

    def plan(
        self, unit_price: float, scale: float, limits: Limits, incumbent: Incumbent | None
    ) -> Incumbent | None:
        """Return a plan at a price of risk; None where no path was found.

        Parameters
        ----------
        unit_price : float
            Cost of one unit of risk.
        scale : float
            Value below which gaps are taken of this instead.
        limits : Limits
            When to stop early.
        incumbent : Incumbent or None
            The best plan so far.

        Returns
        -------
        Incumbent or None
            No worse than the plan given.
        """
        best, pace = incumbent, _Pace(unit_price, scale, limits, TUNING.nodes)
        path = self.path_search.path(unit_price / self.path_search.unit, limits)
        if path is not None:
            best = _better(
                best, self._along(self.rater, path, pace), unit_price / self.path_search.unit
            )
        if best is None:
            return None
        return self._around(self.rater, self.rater.program.slacks(best.z), best, pace)

    def earliest_plan(self, limits: Limits) -> Incumbent | None:
        """Return a plan that waits where it must and then loses no time; None if none was found.

        It leaves the passage free early for others, which may find no path past a vehicle that
        takes all its time.
        """
        path_search, unit = self.path_search, self.path_search.unit
        # Where no effort is needed, or none counts, any cost of delay will do.
        delay_cost = path_search.motion.start_cost or 1.0
        # A step is worth about a hundredth of the bound.
        price = delay_cost / (TUNING.step_share * self.rater.program.risk_bound)
        path = path_search.path(price, limits, delay_cost)
        if path is None:
            return None
        room = np.tile(TUNING.earliest_tube * path_search.motion.longest, len(path))
        program = along(self.rater.program, path_search.output_slice, path.ravel(), room)
        rater = Rater(program, unit)
        found = self._along(
            rater, path, _Pace(price * unit, delay_cost, limits, TUNING.nodes_along)
        )
        # The lattice ignores the sagitta: an alternative of its path may not hold, or not be best.
        tree = RiskTree(
            program,
            unit,
            price * unit,
            gap=TUNING.rough_gap,
            scale=delay_cost,
            limits=limits,
            rater=rater,
        )
        if found is not None:
            tree.consider(found.z)
        tree.run(TUNING.nodes_along)
        return tree.best

    def _along(self, rater: Rater, path: Matrix, pace: _Pace) -> Incumbent | None:
        """Return a plan with the alternatives that a path satisfies, where these are clear."""
        program = rater.program
        outputs = program.constant.copy()
        outputs[self.path_search.output_slice] = path.ravel()
        outputs[program.num_positions :] = 0.0
        slacks = program.rows.offsets - program.rows.normals @ outputs
        found = self._around(rater, slacks, None, pace)
        if found is None and not pace.limits.reached:
            # In a maze too many alternatives are in doubt: first all of the path's own.
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
        """Search near a path for a plan, or for a better one."""
        return search_around(
            rater,
            slacks,
            beat,
            longest_step=float(self.path_search.motion.longest.max()),
            unit=self.path_search.unit,
            price=pace.unit_price,
            scale=pace.scale,
            limits=pace.limits,
            max_nodes=pace.nodes,
            is_rigid=is_rigid,
        )


def _better(one: Incumbent | None, two: Incumbent | None, price: float) -> Incumbent | None:
    """Return the plan of less cost plus priced risk."""
    plans = [plan for plan in (one, two) if plan is not None]
    return min(plans, key=lambda plan: plan.cost + price * plan.risk, default=None)
