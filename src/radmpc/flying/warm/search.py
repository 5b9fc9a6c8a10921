"""From the paths in the air to better ones: one to three linear programs per group, kept warm."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from radmpc.arrays import Matrix
from radmpc.flying.warm.ahead import Ahead
from radmpc.flying.warm.goals import reached, widened
from radmpc.flying.warm.kept_lp import KeptLp
from radmpc.flying.warm.tuning import TUNING
from radmpc.model.scenario import Scenario
from radmpc.planners.certified.turned.half_spaces import half_spaces
from radmpc.planners.certified.turned.linear.warm_programs import WarmPrograms
from radmpc.planners.certified.turned.near import Near
from radmpc.planners.certified.turned.successive import SuccessiveLp
from radmpc.planners.components import components
from radmpc.program.hazards import Hazards
from radmpc.records import dataclass, field
from radmpc.referee.conditional.scales import Scale
from radmpc.solvers.solution import Limits

__all__ = ["Try", "WarmSearch"]

Group = tuple[int, ...]


@dataclass(frozen=True, slots=True, eq=False)
class Try:
    """What is asked of a warm search.

    Attributes
    ----------
    left : Scenario
        The steps that are left, from measured states, under the bound that is allowed.
    controls : tuple of (T, m) array
        What flies already, of which each hazard keeps its side.
    is_safest : bool
        Whether the least risk is asked for instead of the least effort.
    is_stopped : callable
        Returns True once there is no time left.
    scale : Scale or None
        What is known by now of the factor of the mission's covariances; None where they are known.
    miss_price : float or None
        Effort that a meter beside a goal is worth, where goals may be missed [1/m]; None is where
        they are to be reached, or missed by the least that limits leave.
    """

    left: Scenario
    controls: tuple[Matrix, ...]
    is_safest: bool
    is_stopped: Callable[[], bool]
    scale: Scale | None = None
    miss_price: float | None = None


@dataclass(slots=True, eq=False)
class _Kept:
    """Programs to the goals, or beside them, and what came of them.

    Attributes
    ----------
    programs : dict
        One for each group; none before they are first asked for.
    price : float or None
        Shadow price of the risk when last asked, per unit of probability; None before.
    is_out_of_reach : bool
        Whether they then risked too much near the highest price.
    """

    programs: dict[Group, KeptLp] = field(default_factory=dict)
    price: float | None = None
    is_out_of_reach: bool = False


class WarmSearch:
    """Half-spaces turned to the paths in the air from tick to tick, with programs kept warm.

    Parameters
    ----------
    scenario : Scenario
        The mission, over all its steps.
    """

    def __init__(self, scenario: Scenario) -> None:
        self._horizon = scenario.horizon
        self._scenario = scenario
        self._ahead: Ahead | None = None
        self._to_goals, self._beside = _Kept(), _Kept()
        self._groups: tuple[Group, ...] = ()
        # What half-spaces sum to is more than the certificate finds: by how much, last time.
        self._ratio = TUNING.first_ratio
        self._risk = 0.0

    @property
    def is_out_of_reach(self) -> bool:
        """Whether the last plan to the goals risked too much near the highest price."""
        return self._to_goals.is_out_of_reach

    def search(self, asked: Try) -> tuple[tuple[Matrix, ...], Scenario] | None:
        """Return other controls, and the scenario with the goals that they reach; None without.

        Parameters
        ----------
        asked : Try
            From where, within what.
        """
        left = asked.left
        found = self._turned(asked, left)
        if found is not None and asked.miss_price is not None:
            left = reached(left, self._left(left, asked.scale).models, found)
        if found is None and not asked.is_stopped():
            # Limits may leave no way to the goals: these give way by the least that will do.
            left = widened(left, self._left(left, asked.scale).models)
            found = None if left is asked.left else self._turned(asked, left)
        return None if found is None else (found, left)

    def learn(self, certified: float) -> None:
        """Take note of what became of the last controls returned.

        Parameters
        ----------
        certified : float
            What the referee found of them [-].
        """
        if self._risk > 0.0 and certified > 0.0:
            low, high = TUNING.ratios
            self._ratio = float(np.clip(certified / self._risk, low, high))

    def forget(self) -> None:
        """Keep nothing of earlier searches: the next one is as the first."""
        self._to_goals, self._beside, self._groups = _Kept(), _Kept(), ()
        self._ratio, self._risk = TUNING.first_ratio, 0.0

    def dearer(self, asked: Try, certified: float) -> None:
        """Raise the price after controls that risk too much.

        Parameters
        ----------
        asked : Try
            What they were an answer to.
        certified : float
            What the referee found of them [-].
        """
        kept, grant = self._of(asked), asked.left.risk_bound
        if kept.price is not None and certified > grant:
            kept.price *= (certified / grant) ** TUNING.damping

    def _turned(self, asked: Try, left: Scenario) -> tuple[Matrix, ...] | None:
        """Return better controls within given goals; None if limits leave none."""
        hazards = self._left(left, asked.scale)
        programs = self._made(asked, hazards)
        for program in programs.values():
            program.move(hazards)
        limits = Limits(is_stopped=asked.is_stopped)
        successive = SuccessiveLp(hazards, limits, WarmPrograms(hazards, programs))
        successive.begin(asked.controls)
        is_found = (
            self._safer(successive, asked) if asked.is_safest else self._cheaper(successive, asked)
        )
        return tuple(successive.paths.controls) if is_found else None

    def _made(self, asked: Try, hazards: Hazards) -> dict[Group, KeptLp]:
        """Return the groups' programs, made when they are first needed."""
        if not self._groups:
            self._groups = _groups(hazards, asked.controls)
        kept = self._of(asked)
        if not kept.programs:
            whole, price = self._all().whole, asked.miss_price
            kept.programs = {g: KeptLp(whole, g, price) for g in self._groups}
        return kept.programs

    def _of(self, asked: Try) -> _Kept:
        """Return what is kept of programs to the goals, or beside them."""
        return self._to_goals if asked.miss_price is None else self._beside

    def _all(self) -> Ahead:
        """Return the mission over all of its steps."""
        if self._ahead is None:
            self._ahead = Ahead.of(self._scenario)
        return self._ahead

    def _left(self, left: Scenario, scale: Scale | None) -> Hazards:
        """Return the fleet over the steps that are left."""
        goals = [vehicle.goal for vehicle in left.vehicles]
        return self._all().left(self._horizon - left.horizon, left.vehicles, goals, scale)

    def _safer(self, successive: SuccessiveLp, asked: Try) -> bool:
        """Turn half-spaces at a price at which risk is nearly all that counts."""
        cost = max(successive.paths.cost(), TUNING.least_cost)
        price = max(self._of(asked).price or 0.0, TUNING.safest * cost / asked.left.risk_bound)
        return all(self._turn(successive, asked, price) for _ in range(TUNING.safest_rounds))

    def _cheaper(self, successive: SuccessiveLp, asked: Try) -> bool:
        """Turn half-spaces at a price that follows the risk, until that is what is allowed."""
        grant = asked.left.risk_bound
        cost = max(successive.paths.cost(), TUNING.least_cost)
        least, most = TUNING.cheapest * cost / grant, TUNING.dearest * cost / grant
        kept, wasted = self._of(asked), 0.0 if asked.miss_price is None else TUNING.wasted * grant
        # No price leads to what cannot be had: the next plan begins below what that came to.
        price = min(kept.price or TUNING.first_dear * cost / self._scenario.risk_bound, most)
        for _ in range(TUNING.rounds):
            if not self._turn(successive, asked, price):
                return False
            expected = self._ratio * self._risk
            aimed = price * float(np.clip(expected / (TUNING.aim * grant), *TUNING.price_steps))
            kept.price = price = float(np.clip(aimed, least, most))
            kept.is_out_of_reach = expected > grant and price > TUNING.out_of_reach * most
            # A price at which nearly none of the grant is used leads too far around.
            if wasted <= expected <= grant:
                break
        return True

    def _turn(self, successive: SuccessiveLp, asked: Try, price: float) -> bool:
        """Plan every group once; tell whether there was time and a plan."""
        self._risk = 0.0
        for group in self._groups:
            if asked.is_stopped():
                return False
            self._risk += successive.share_risk(group, price, TUNING.spacing)
            if self._of(asked).programs[group].has_failed:
                return False
        return True


def _groups(hazards: Hazards, controls: Sequence[Matrix]) -> tuple[Group, ...]:
    """Return vehicles near each other or in a range, also through others: one program each."""
    successive = SuccessiveLp(hazards, Limits())
    successive.begin(controls)
    near = Near(TUNING.near, 0.0, is_refined=False)
    spaces = half_spaces(hazards, successive.paths, tuple(range(hazards.count)), near)
    meets = (spaces.second >= 0) & (spaces.clearances < TUNING.near).any(axis=1)
    edges = list(zip(spaces.first[meets].tolist(), spaces.second[meets].tolist(), strict=True))
    return components(hazards.count, edges + [(i, j) for i, j, _ in hazards.ranges])
