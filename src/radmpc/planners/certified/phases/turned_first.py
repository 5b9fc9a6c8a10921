"""First plans that cost much: reported after half-spaces were turned to them."""

from __future__ import annotations

from dataclasses import dataclass, field

from radmpc.arrays import Matrix
from radmpc.planners.certified.fleet import Fleet
from radmpc.planners.certified.search import PriceSearch
from radmpc.planners.certified.state.incumbent import FleetIncumbent
from radmpc.planners.certified.state.search_state import SearchState
from radmpc.planners.certified.state.task import task_of
from radmpc.planners.certified.turned.successive import SuccessiveLp
from radmpc.planners.certified.turned.tuning import TUNING
from radmpc.planners.planner import Run
from radmpc.planners.verdict import Judge
from radmpc.program.hazards import Hazards
from radmpc.records import replace
from radmpc.solvers.solution import Limits

__all__ = ["FirstReports", "at_prices"]

_DEAR = 2.0
"""Multiple of what vehicles take in empty space above which a first plan is turned [-]: those of
faces in db-CBS's alcove and beside its goals cost 1.6 times the best known plan, and 1.05 so."""

_ROUNDS = 5
"""Turns at most [-], of two vehicles 20 to 30 ms each."""

_FEW = 4
"""Vehicles up to which a plan may wait for the next turn [-], 20 to 200 ms: of those placed on a
lattice beside db-CBS's goals it costs 1.17 times the best known plan instead of 1.64, of two that
pass in libMultiRobotPlanning's `mapf_simple1` 4.34 instead of 5.26."""

_UNUSED = 0.2
"""Share of Δ that such a plan uses at most among many obstacles [-]: there beginnings have been
compared, and the next turn of one that uses more, up to 0.4 s, saves 0.05 % at most."""


class FirstReports:
    """Reports plans made before the search; a first one that costs much waits for the next.

    It is handed on at once all the same, so that an interrupt loses none.

    Parameters
    ----------
    run : Run
        Where plans are reported to.
    hazards : Hazards
        The fleet.
    risk_bound : float
        Δ [-].
    """

    def __init__(self, run: Run, hazards: Hazards, risk_bound: float) -> None:
        self._run, self._hazards = run, hazards
        is_among_many = hazards.shapes.count >= TUNING.many_obstacles
        self._least = _UNUSED * risk_bound if is_among_many else float("inf")
        self._waiting: float | None = None
        self._is_first = hazards.count <= _FEW

    def __call__(self, incumbent: FleetIncumbent) -> None:
        """Report a plan, or let it wait."""
        if self._is_first and incumbent.certified < self._least and self._is_dear(incumbent.cost):
            self._waiting = incumbent.cost
        else:
            self._waiting = None
            self._run.found(incumbent.cost, None)
        self._is_first = False
        self._run.improved(incumbent.controls)

    def _is_dear(self, cost: float) -> bool:
        """Whether a plan costs much more than its vehicles alone do."""
        alone = SuccessiveLp(self._hazards, Limits())
        return alone.begin_alone() and cost > _DEAR * alone.paths.cost()

    def close(self) -> None:
        """Report the plan that waits, if any."""
        if self._waiting is not None:
            self._run.found(self._waiting, None)
            self._waiting = None


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
