"""The first plan of a search by faces, turned before it is reported where it costs much."""

from __future__ import annotations

from dataclasses import dataclass, field

from radmpc.arrays import Matrix
from radmpc.planners.certified.fleet import Fleet
from radmpc.planners.certified.search import PriceSearch
from radmpc.planners.certified.state.incumbent import FleetIncumbent
from radmpc.planners.certified.state.search_state import SearchState
from radmpc.planners.certified.state.task import task_of
from radmpc.planners.certified.turned.tuning import TUNING
from radmpc.planners.verdict import Judge
from radmpc.records import replace

__all__ = ["at_prices"]

_DEAR = 2.0
"""Multiple of what vehicles take in empty space above which a first plan is turned [-]: those of
faces in db-CBS's alcove and beside its goals cost 1.6 times the best known plan, and 1.05 so."""

_ROUNDS = 5
"""Turns at most [-], of two vehicles 20 to 30 ms each."""


def at_prices(
    search: PriceSearch, state: SearchState, first: FleetIncumbent, judge: Judge
) -> tuple[PriceSearch, SearchState, FleetIncumbent]:
    """Search sets at prices; turn the first plan where there was none before and it costs much.

    Parameters
    ----------
    search : PriceSearch
        The search.
    state : SearchState
        Where it begins.
    first : FleetIncumbent
        A plan made before, if any.
    judge : callable
        The referee.

    Returns
    -------
    (PriceSearch, SearchState, FleetIncumbent)
        The search as it was run, where it ended, and the plan made beside it, if any.
    """
    fleet = search.fleet
    if first.controls or fleet.is_large:
        return search, search.run(state), first
    turned = _TurnedFirst(fleet, judge)
    search = PriceSearch.of(turned.reporting(), judge)
    return search, search.run(state), turned.plan


@dataclass(eq=False)
class _TurnedFirst:
    """Reports the plans of a search; of the first one it tries half-spaces of any direction before.

    Attributes
    ----------
    fleet : Fleet
        The fleet, with the functions that plans are reported to.
    judge : callable
        The referee.
    plan : FleetIncumbent
        The first plan with its half-spaces turned; none before it, or where it is not turned.
    """

    fleet: Fleet
    judge: Judge
    plan: FleetIncumbent = field(default_factory=FleetIncumbent)
    _has_seen: bool = False

    def reporting(self) -> Fleet:
        """Return the fleet of a search that reports its plans here."""
        return replace(self.fleet, found=self._found, improved=self._improved)

    def _improved(self, controls: tuple[Matrix, ...]) -> None:
        """Hand on a plan as it is, so that an interrupt loses none; turn the first one."""
        if not self.plan.controls:
            self.fleet.improved(controls)
        if not self._has_seen:
            self._has_seen = True
            self._turn(controls)

    def _found(self, cost: float, bound: float) -> None:
        """Report the cost of the best plan."""
        self.fleet.found(min(cost, self.plan.cost), bound)

    def _turn(self, controls: tuple[Matrix, ...]) -> None:
        """Turn half-spaces to the first plan, where it costs much."""
        from radmpc.planners.certified.turned.turning import Turning  # noqa: PLC0415 - vehicles without conflicts do without

        fleet, everyone = self.fleet, tuple(range(self.fleet.scenario.num_vehicles))
        price = fleet.first_unit_price(fleet.first_budget) / fleet.unit
        turning = Turning(
            task_of(fleet, self.judge, controls), FleetIncumbent(), (everyone,), price
        )
        turning.successive.begin(controls)
        is_dear = turning.successive.paths.cost() > _DEAR * float(sum(fleet.base))
        if is_dear and len(everyone) <= TUNING.few:
            self.plan = turning.run(_ROUNDS)
