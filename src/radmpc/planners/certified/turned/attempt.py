"""An attempt at a first plan: what it begins with, and how its vehicles are kept apart."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from radmpc.arrays import Matrix
from radmpc.planners.certified.state.incumbent import FleetIncumbent
from radmpc.planners.certified.state.task import Task
from radmpc.planners.certified.turned.narrow.route import Route
from radmpc.planners.certified.turned.successive import SuccessiveLp
from radmpc.planners.certified.turned.tuning import TUNING
from radmpc.planners.certified.turned.turning import Turning
from radmpc.program.condensed import CondensedModel
from radmpc.records import dataclass
from radmpc.solvers.solution import Limits

__all__ = ["Attempt", "Begin"]


@dataclass(frozen=True, slots=True, eq=False)
class Begin:
    """What attempts begin with.

    Attributes
    ----------
    task : Task
        What is asked.
    alone : SuccessiveLp
        What vehicles do by themselves, and their linear programs.
    routes : mapping of int to Route
        Routes around obstacles of those that these stop.
    sets : tuple of tuple of int
        Vehicles in conflict.
    price : float
        Shadow price of the risk, per unit of probability.
    clearance : float
        Standard deviations to keep [-].
    to_choose : tuple of CondensedModel or None
        The vehicles with visits at any step of their windows; None where no step is to be chosen.
    is_any : bool
        Whether the first plan found will do, whatever others cost.
    is_quick : bool
        Whether that is not turned any further: the search will find a cheaper one, given time.
    is_hard : bool
        Whether it is turned to the end: the search is not expected to find a cheaper one soon.
    is_compared : bool
        Whether beginnings are compared: many obstacles are in the way, and no proof that tells
        better sides follows.
    is_followed : bool
        Whether such a proof follows, which turns the plan to the end once it told the sides.
    """

    task: Task
    alone: SuccessiveLp
    routes: Mapping[int, Route]
    sets: tuple[tuple[int, ...], ...]
    price: float
    clearance: float
    to_choose: tuple[CondensedModel, ...] | None = None
    is_any: bool = False
    is_quick: bool = False
    is_hard: bool = False
    is_compared: bool = False
    is_followed: bool = False

    def referring(self, places: Mapping[int, Matrix]) -> Turning:
        """Return half-spaces turned to given positions, for all others to their paths alone."""
        # Where several sides are turned, it takes both to the end to compare them.
        is_brief = self.is_followed and bool(self.routes)
        turning = Turning(
            self.task,
            FleetIncumbent(),
            self.sets,
            self.price,
            is_patient=self.is_hard,
            enough=TUNING.enough * self.task.risk_bound if is_brief else float("inf"),
            programs=self.alone.programs,
            is_routed=bool(self.routes) and not is_brief,
        )
        successive = turning.successive
        successive.begin(self.alone.paths.controls)
        successive.least.update(enumerate(self.alone.paths.controls))
        for i, path in places.items():
            successive.refer(i, path)
        return turning


@dataclass(frozen=True, slots=True, eq=False)
class Attempt:
    """What one begins with, and how its vehicles are kept apart.

    Attributes
    ----------
    turning : Turning
        Half-spaces turned to its paths.
    sweeps : int
        Sweeps over the fleet at most; 0 where paths are kept as they are [-].
    penalty : float
        Of a meter missed in the first sweep, see `Tuning.first_penalty` [-].
    is_placed : bool
        Whether paths are places clear of each other: a vehicle that keeps them is not planned.
    rounds : int
        Turns at a price of risk at most, once there is a plan; as usual before [-].
    rng : Generator or None
        Draws other paces for the few that cannot keep theirs; None leaves them.
    is_drawn : bool
        Whether it begins at drawn times, which seldom leads to what misses less than others do.
    """

    turning: Turning
    sweeps: int
    penalty: float = TUNING.first_penalty
    is_placed: bool = False
    rounds: int = TUNING.first_rounds
    rng: np.random.Generator | None = None
    is_drawn: bool = False

    def run(self) -> FleetIncumbent:
        """Turn half-spaces at a price of risk; return the best plan, if any."""
        successive = self.turning.successive
        # Not ahead of where paths were to be, but of where they are.
        successive.restore(successive.paths.state())
        rounds = TUNING.rounds if self.rounds and self.turning.is_patient else self.rounds
        found = self.turning.run(rounds)
        return found if found.controls or self.rounds else self.turning.run(TUNING.first_rounds)

    def keep_apart(self, clearance: float, limits: Limits) -> bool:
        """Keep vehicles apart from the latest paths on; tell whether all are.

        Parameters
        ----------
        clearance : float
            Standard deviations that everyone keeps from everything [-].
        limits : Limits
            When to stop.
        """
        successive = self.turning.successive
        if not self.is_placed:
            is_quick, hazards = self.sweeps < TUNING.max_sweeps, successive.hazards
            # In narrow gaps detours are better shared before.
            is_shared = hazards.count <= TUNING.most_together
            is_shared &= hazards.shapes.count < TUNING.many_obstacles
            told = clearance, self.sweeps, limits, self.penalty
            return successive.keep_apart(*told, is_quick=is_quick, is_shared=is_shared)
        from radmpc.planners.certified.turned.narrow.at_pace import keep_places  # noqa: PLC0415 - few need it
        from radmpc.planners.certified.turned.narrow.mending import mended  # noqa: PLC0415 - few need it

        places = successive.paths.means.copy()
        if keep_places(successive, clearance, self.sweeps, self.penalty, limits):
            return True
        if self.rng is None:
            return False
        return mended(successive, places, clearance, self.rng, limits)

    def replan_jointly(self, clearance: float, limits: Limits) -> bool:
        """Plan the few that miss room with those in their way; tell whether turning may succeed.

        Parameters
        ----------
        clearance : float
            Standard deviations that everyone was to keep from everything [-].
        limits : Limits
            When to stop.
        """
        from radmpc.planners.certified.turned.narrow.joint_replanning import replan_jointly  # noqa: PLC0415 - few need it
        from radmpc.planners.certified.turned.narrow.tuning import TUNING as NARROW  # noqa: PLC0415 - few need it

        turning, hopeful = self.turning, TUNING.hopeful * self.turning.task.risk_bound
        if turning.certified() <= turning.task.risk_bound:
            return True
        price = NARROW.joint_price * turning.price
        is_resolved = replan_jointly(turning.successive, clearance, price, hopeful, limits)
        return is_resolved and turning.certified() <= hopeful
