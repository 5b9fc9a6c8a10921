"""Incumbents of a single vehicle among many dangers: a way on a lattice, then a small search."""

from __future__ import annotations

from dataclasses import dataclass

from radmpc.arrays import Vector
from radmpc.planners.certified.walk import Walk
from radmpc.solvers.risk_around import search_around
from radmpc.solvers.risk_nodes import Incumbent
from radmpc.solvers.risk_rating import Rater
from radmpc.solvers.solution import Limits

__all__ = ["Passage"]

_NODES = 50


@dataclass(frozen=True, slots=True, eq=False)
class Passage:
    """Ways through, sought anew at every price.

    Attributes
    ----------
    walk : Walk
        The lattice search of the vehicle's programme.
    rater : Rater
        The programme, laid out for rating.
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
        program, best = self.rater.program, known

        def around(slacks: Vector, beat: Incumbent | None) -> Incumbent | None:
            return search_around(
                self.rater,
                slacks,
                beat,
                move=float(self.walk.motion.longest.max()),
                unit=self.walk.unit,
                price=price,
                scale=scale,
                limits=limits,
                max_nodes=_NODES,
            )

        way = self.walk.way(price)
        if way is not None:
            outputs = program.constant.copy()
            outputs[: program.num_positions] = way.ravel()
            outputs[program.num_positions :] = 0.0
            slacks = program.rows.offsets - program.rows.normals @ outputs
            best = _better(best, around(slacks, None), price / self.walk.unit)
        return None if best is None else around(program.slacks(best.z), best)


def _better(one: Incumbent | None, two: Incumbent | None, rate: float) -> Incumbent | None:
    """Return the plan of less cost and priced risk."""
    plans = [plan for plan in (one, two) if plan is not None]
    return min(plans, key=lambda plan: plan.cost + rate * plan.risk, default=None)
