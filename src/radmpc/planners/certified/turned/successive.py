"""Successive linear programs: half-spaces turned to the latest paths, paths planned between them.

Paths that keep every side of each other and of all obstacles on which they pass, at least effort:
the half-spaces that say so are turned to the latest paths, a linear program plans between them, and
so on until nothing moves. Vehicles are planned one after the other while paths are far from each
keeping its distance, and in groups at a price of risk to share room and risk at least effort.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from radmpc.arrays import Matrix
from radmpc.gaussian import Tail
from radmpc.planners.certified.turned.half_spaces import half_spaces
from radmpc.planners.certified.turned.linear.group_plan import GroupPlan
from radmpc.planners.certified.turned.linear.margins import (
    cheapest_meter,
    far_of,
    fixed_margins,
    priced_margins,
)
from radmpc.planners.certified.turned.linear.warm_programs import Group, WarmPrograms
from radmpc.planners.certified.turned.looks import keep_clear, unforeseen
from radmpc.planners.certified.turned.near import Near
from radmpc.planners.certified.turned.neighbors import reached_by
from radmpc.planners.certified.turned.normals.spaces import HalfSpaces
from radmpc.planners.certified.turned.paths import Paths, SavedPaths
from radmpc.planners.certified.turned.tuning import TUNING
from radmpc.planners.least_effort import least_effort
from radmpc.program.hazards import Hazards
from radmpc.solvers.solution import Limits

__all__ = ["SuccessiveLp"]

_MISSED = 1e-7
"""What half-spaces may be missed by in all [m]."""

_STAYED = 1e-9
"""What a path moves by at most, and misses at most, where planning it again changed nothing [m]."""


class SuccessiveLp:
    """The fleet's latest paths, and the linear programs that improve them.

    Parameters
    ----------
    hazards : Hazards
        The fleet.
    limits : Limits
        When to stop early.
    programs : WarmPrograms or None
        Linear programs of the same fleet to go on with; None is to begin with none.

    Attributes
    ----------
    programs : WarmPrograms
        Linear programs of groups.
    paths : Paths
        Everyone's latest paths.
    missed : (N,) array
        How far half-spaces were missed when each vehicle was planned last; inf before [m].
    ahead : Paths
        Where these are expected to move: half-spaces are turned to that at a price of risk.
    asks_nearest : bool
        Whether half-spaces that risk is shared between may turn about the point where a path is
        nearest, see `nearest_shares`, instead of holding both ends of its windows.
    meter : float
        What a meter at the goal costs the vehicle that moves with least effort.
    work : float
        What sharing risk took, see `ExchangeLp` [-].
    least : dict of int to (T, m) array
        Controls of least effort with nothing in the way, of vehicles that began with them.
    """

    def __init__(
        self,
        hazards: Hazards,
        limits: Limits,
        programs: WarmPrograms | None = None,
    ) -> None:
        self.hazards = hazards
        self.limits = limits
        self.paths = Paths(hazards)
        self.missed = np.full(hazards.count, np.inf)
        self.work = 0.0
        self.asks_nearest = False
        self.least: dict[int, Matrix] = {}
        self.ahead = Paths(hazards)
        self.programs = WarmPrograms(hazards, {}) if programs is None else programs
        self.meter = cheapest_meter(hazards)
        self._has_visits = any(model.vehicle.via for model in hazards.models)

    def begin(self, controls: Sequence[Matrix]) -> None:
        """Begin with given controls of every vehicle, (T, m) each."""
        for i, each in enumerate(controls):
            self.paths.fly(i, each)
        self.ahead.restore(self.paths.state())

    def refer(self, vehicle: int, positions: Matrix) -> None:
        """Turn half-spaces of a vehicle to a path next that no controls need follow.

        Parameters
        ----------
        vehicle : int
            Its number.
        positions : (T+1, d) array
            Positions at the steps [m].
        """
        self.least.pop(vehicle, None)
        self.paths.refer(vehicle, positions)
        self.ahead.refer(vehicle, positions)

    def begin_alone(self) -> bool:
        """Begin with what every vehicle does alone; tell whether all reach goals, and in time."""
        for i in range(self.hazards.count):
            if self.limits.reached:
                return False
            alone = least_effort(self.hazards.models[i]).controls
            if alone is None:
                found = self.programs.of((i,)).alone()
                if found is None:
                    return False
                alone = found[0]
            self.paths.fly(i, alone)
            self.ahead.fly(i, alone)
        return True

    def restore(self, state: SavedPaths) -> None:
        """Come back to paths that `state` returned, and turn half-spaces to them next."""
        self.paths.restore(state)
        self.ahead.restore(state)

    def keep_apart(
        self,
        clearance: float,
        max_sweeps: int,
        limits: Limits | None = None,
        first_penalty: float = TUNING.first_penalty,
        *,
        is_quick: bool = False,
        is_shared: bool = False,
    ) -> bool:
        """Plan one vehicle after the other until all keep a clearance, or nothing helps.

        Parameters
        ----------
        clearance : float
            Standard deviations that everyone keeps from everything [-].
        max_sweeps : int
            Sweeps over the fleet at most [-].
        limits : Limits or None
            When to stop earlier than at the end of all.
        first_penalty : float
            Of a meter missed in the first sweep, see `Tuning.first_penalty` [-].
        is_quick : bool
            Whether it is left where so much is missed that it leads to nothing, as a rule.
        is_shared : bool
            Whether a program of all follows, in which they share detours: until then it is enough
            that nobody misses anything.

        Returns
        -------
        bool
            Whether all do.
        """
        least, num_stuck, cost = np.inf, 0, np.inf
        penalty = first_penalty
        order, is_still = range(self.hazards.count), self._clear_alone(clearance)
        self.missed[is_still] = 0.0
        # Where other attempts follow, what misses that much is left to them.
        most_missed = TUNING.most_missed * float(self.hazards.radii.sum())
        for number in range(max_sweeps):
            for i in order:
                if (limits or self.limits).reached:
                    return False
                # A vehicle that misses nothing and stayed would stay again, until one near moves.
                if not is_still[i]:
                    before = self.paths.means[i].copy()
                    self.plan_alone(i, clearance, penalty)
                    moved = float(np.abs(self.paths.means[i] - before).max())
                    if moved > _STAYED:
                        is_still &= ~reached_by(self.hazards, self.paths, (i, before), clearance)
                    is_still[i] = moved <= _STAYED and self.missed[i] <= _STAYED
            order = order[::-1]
            missed, previous, cost = float(self.missed.sum()), cost, self.paths.cost()
            is_steady = is_shared or abs(previous - cost) <= TUNING.steady * abs(cost)
            if missed <= _MISSED and is_steady:
                return True
            num_stuck = num_stuck + 1 if missed > 0.9 * least else 0
            least = min(least, missed)
            if missed > _MISSED and num_stuck >= TUNING.stuck:
                return False
            sooner = TUNING.sooner ** max(TUNING.telling - number, 0)
            if is_quick and missed > sooner * most_missed:
                return False
            penalty = min(TUNING.penalty_growth * penalty, TUNING.last_penalty)
        return float(self.missed.sum()) <= _MISSED

    def _clear_alone(self, clearance: float) -> npt.NDArray[np.bool_]:
        """Return which move as if alone and keep clear of all others, (N,)."""
        alone = [i for i in range(self.hazards.count) if self._is_alone(i)]
        near = Near(clearance, 0.0, is_refined=False, is_start_given=self._has_visits)
        return keep_clear(self.hazards, self.paths, alone, near)

    def _is_alone(self, i: int) -> bool:
        """Whether a vehicle moves with least effort, as if nothing were in its way."""
        return self.paths.controls[i] is self.least.get(i)

    def plan_alone(self, i: int, clearance: float, penalty: float, reach: float = 0.0) -> None:
        """Plan one vehicle between half-spaces turned to its latest path.

        Parameters
        ----------
        i : int
            Its number.
        clearance : float
            Standard deviations that it keeps [-].
        penalty : float
            Of a meter missed, see `Tuning.first_penalty` [-].
        reach : float
            How far around that path one looks; what it moves by in a step, at least [m].
        """
        reach = max(reach, float(self.hazards.reaches[i]))
        near = Near(clearance, reach, is_refined=False, is_start_given=self._has_visits)
        spaces = half_spaces(self.hazards, self.paths, (i,), near)
        if self._is_alone(i) and np.all(spaces.clearances >= clearance):
            self.missed[i] = 0.0
            return
        margins = fixed_margins(spaces.deviations, clearance, penalty * self.meter)
        plan = self.programs.plan_alone(i, spaces, self.paths, margins)
        if plan is not None:
            self.paths.fly(i, plan.controls[0])
            self.missed[i] = plan.shortfall

    def share_risk(self, group: Group, price: float, spacing: float) -> float:
        """Plan a group at a price of risk; return the risk that its half-spaces say it runs [-].

        Parameters
        ----------
        group : tuple of int
            Vehicles planned together; all others stay on their paths.
        price : float
            Cost of a unit of probability.
        spacing : float
            Between the clearances around the latest at which risk is interpolated [-].
        """
        reach = float(self.hazards.reaches[list(group)].max())
        before, plan = self.paths.state(), None
        program = self.programs.of(group)
        worked = program.work
        far = far_of(self.hazards.tail, TUNING.compared)
        for _ in range(TUNING.looks):
            near = Near(far, reach, is_refined=True, is_nearest_asked=self.asks_nearest)
            spaces = half_spaces(self.hazards, self.paths, group, near, self.ahead)
            margins = priced_margins(
                spaces.deviations,
                spaces.clearances,
                (price, TUNING.last_penalty * self.meter),
                spacing,
                self.hazards.tail,
            )
            plan = program.solve(spaces, self.paths, margins, self.limits)
            if plan is None:
                break
            self._fly(group, plan)
            had = spaces.keys, reach
            new = unforeseen(self.hazards, self.paths, group, before[1], had)
            if new is None or not new.count:
                break
            # The paths went where nothing was near them before: look further around the old ones.
            self.paths.restore(before)
            reach *= TUNING.further
            if self.limits.reached:
                plan = None
                break
        else:
            if plan is not None:
                self._fly(group, plan)
        self.work += program.work - worked
        if plan is None:
            self.paths.restore(before)
            return _risk(half_spaces(self.hazards, self.paths, group, near), self.hazards.tail)
        self.ahead.lead(self.paths, before, group)
        return plan.risk

    def _fly(self, group: Group, plan: GroupPlan) -> None:
        """Give a group the controls of a plan."""
        for i, controls in zip(group, plan.controls, strict=True):
            self.paths.fly(i, controls)


def _risk(spaces: HalfSpaces, tail: Tail) -> float:
    """Return what the risks of half-spaces sum to on the latest paths."""
    return float(np.sum(tail.probability(spaces.clearances)))
