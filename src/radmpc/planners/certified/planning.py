"""Planning a whole fleet at one price of risk, with a certificate and a lower bound."""

from __future__ import annotations

import time
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from radmpc.model.plan import Status
from radmpc.model.scenario import Scenario
from radmpc.planners.certified.fleet import Fleet
from radmpc.planners.certified.incumbent import FleetIncumbent
from radmpc.planners.certified.infeasible.explanation import WhyNot, sure_why_not
from radmpc.planners.certified.search import PriceSearch
from radmpc.planners.certified.turned.turning import turn_half_spaces
from radmpc.planners.draft import Draft
from radmpc.planners.planner import Decomposition, Planner, Run
from radmpc.planners.policies.policy import Family
from radmpc.solvers.branch.branch import Branch
from radmpc.solvers.solution import Solver, relative_gap

__all__ = ["Certified"]

_TURNING_SHARE, _TURNING_SECONDS, _MOST_SHARE = 0.1, 1.0, 0.3
"""Time reserved for turning half-spaces to a plan: a share of the limit [-], or seconds [s] up to a
larger share of it [-]. Turning takes 0.3 to 4 s on the families of the benchmarks."""

_LEAST_TURNING = 6.0
"""Time that turning gets at least, if the limit leaves it [s]."""

_UNSPENT = 0.5
"""Share of Δ below which a certificate leaves so much that other alternatives are tried [-]."""


@dataclass(frozen=True, slots=True)
class Certified(Decomposition):
    """Sets merged where they collide, all at one price of risk, every plan certified."""

    families: ClassVar[frozenset[Family]] = frozenset({"priced"})
    solvers: ClassVar[tuple[type[Solver], ...]] = (Branch,)
    needs_proof: ClassVar[bool] = True
    default_seconds: ClassVar[float | None] = 60.0

    def __str__(self) -> str:
        return "certified"

    def plan(self, scenario: Scenario, planner: Planner, run: Run) -> Draft:
        """Plan a fleet to a proven gap; every plan is certified.

        Parameters
        ----------
        scenario, planner, run
            As in `Decomposition.plan`.

        Returns
        -------
        Draft
            With a lower bound on the cost, and the shadow price of Δ, where there is a plan.
        """
        begun = time.perf_counter()
        ruled_out = sure_why_not(scenario, run.limits)
        if ruled_out is not None:
            return _empty(scenario, ruled_out, begun)
        result = _searched(scenario, planner, run)
        fleet, incumbent = result.search.fleet, result.search.incumbent
        if result.answer is not None and not incumbent.controls:
            return _empty(scenario, result.answer, begun)
        result.search.close()
        run.found(incumbent.cost, _finite(incumbent.reported_bound(fleet, planner.gap)))
        run.progress("improving", 0, 1)
        # Counts end it; the clock, only where a machine is slow: not longer than the search took.
        fleet.limits = run.limits.within(max(_LEAST_TURNING, time.perf_counter() - begun))
        turn_half_spaces(fleet, incumbent, run.judge)
        if incumbent.certified < _UNSPENT * scenario.risk_bound:
            # Not risk but the faces made the plan what it is. (Tried for all
            # fleets of up to four: 0.03 to 0.3 % cheaper, in two to four times the time.)
            from radmpc.planners.certified.turned.noiseless import turn_from_noiseless  # noqa: PLC0415 - few need it

            turn_from_noiseless(fleet, incumbent, run.judge)
        return _draft(result, planner.gap, time.perf_counter() - begun)


@dataclass(frozen=True, slots=True, eq=False)
class _SearchResult:
    """How the search ended.

    Attributes
    ----------
    search : PriceSearch
        With a plan, or without.
    answer : WhyNot or None
        What the last resort says, if it was asked.
    stopped_by : str or None
        The limit that ended the search, if one did.
    """

    search: PriceSearch
    answer: WhyNot | None
    stopped_by: str | None


def _searched(scenario: Scenario, planner: Planner, run: Run) -> _SearchResult:
    """Search for the best plan; where the search finds none, try what else leads to one."""
    limits = run.limits
    seconds = limits.seconds_left
    kept = max(_TURNING_SHARE * seconds, min(_TURNING_SECONDS, _MOST_SHARE * seconds))
    begin = limits if seconds == float("inf") else limits.within(seconds - kept)
    incumbent = FleetIncumbent()

    def tell(done: int, total: int) -> None:
        run.progress("sets", done, total)
        if incumbent.controls:
            run.found(incumbent.cost, _finite(incumbent.reported_bound(fleet, planner.gap)))

    fleet = Fleet(scenario, planner.gap, begin, tell, run.executor)
    search = PriceSearch(fleet, incumbent, planner.gap, run.judge)
    if fleet.budget > 0.0:
        search.run()
    # Turning has time of its own, reserved beforehand.
    stopped_by = begin.reason or None
    if search.incumbent.controls:
        return _SearchResult(search, None, stopped_by)
    from radmpc.planners.certified.fallbacks import last_resort  # noqa: PLC0415 - few need it

    fleet.limits = limits
    search, answer = last_resort(search)
    return _SearchResult(search, answer, stopped_by or begin.reason or None)


def _draft(result: _SearchResult, gap: float, seconds: float) -> Draft:
    """Return the incumbent and what is proven of it."""
    fleet, incumbent, answer = result.search.fleet, result.search.incumbent, result.answer
    closed = gap * (1.0 + 1e-6)
    bound = incumbent.reported_bound(fleet, closed)
    is_closed = relative_gap(incumbent.cost, bound) <= closed
    return Draft(
        Status.OPTIMAL if is_closed else Status.FEASIBLE,
        incumbent.controls,
        incumbent.sets,
        tuple(incumbent.steps),
        (),
        {"sets": seconds},
        (answer.explanation if answer is not None else "") or None,
        lower_bound=_finite(bound),
        price=incumbent.price(fleet),
        couplings=fleet.merging.couplings(incumbent.sets),
        stopped_by=result.stopped_by,
    )


def _empty(scenario: Scenario, answer: WhyNot, begun: float) -> Draft:
    """Return a draft without a plan that says why there is none."""
    status = Status.INFEASIBLE if answer.is_proven else Status.LIMIT
    sets = (tuple(range(scenario.num_vehicles)),) if answer.is_proven else ()
    seconds = {"sets": time.perf_counter() - begun}
    return Draft(status, (), sets, (), (), seconds, answer.explanation)


def _finite(bound: float) -> float | None:
    """Return a lower bound on a cost, 0 at least; None where nothing is proven."""
    return max(bound, 0.0) if np.isfinite(bound) else None
