"""The search for a plan: a first plan, what is proven around it, prices, and what is left after."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import closing
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from radmpc.model.scenario import Scenario
from radmpc.planners.certified.fleet import Fleet
from radmpc.planners.certified.infeasible.answer import WhyNot
from radmpc.planners.certified.infeasible.ended import ended
from radmpc.planners.certified.phases.course import (
    is_among_many,
    is_dear_alone,
    is_dear_between_few,
    is_tight_scene,
)
from radmpc.planners.certified.phases.improving import is_searched_nearby
from radmpc.planners.certified.phases.time_shares import but_for_faces, limits_of_search
from radmpc.planners.certified.phases.tuning import TUNING as PHASES
from radmpc.planners.certified.phases.turned_first import FirstReports, at_prices
from radmpc.planners.certified.proof.grouping import Proven
from radmpc.planners.certified.proof.norms import outside_norms_of
from radmpc.planners.certified.proof.tuning import TUNING as PROOF_TUNING
from radmpc.planners.certified.search import PriceSearch
from radmpc.planners.certified.state.bounds import finite
from radmpc.planners.certified.state.incumbent import FleetIncumbent
from radmpc.planners.certified.state.search_state import SearchState
from radmpc.planners.certified.state.task import Task
from radmpc.planners.certified.tuning import TUNING as SEARCH_TUNING
from radmpc.planners.certified.turned.first_plan import first_plan
from radmpc.planners.planner import Planner, Run
from radmpc.program.build import build_program
from radmpc.program.hazards import Hazards
from radmpc.program.program import DisjunctiveProgram
from radmpc.records import dataclass, field, replace
from radmpc.solvers.solution import Limits
from radmpc.system.memory import hand_back_freed

if TYPE_CHECKING:
    # Not along intervals.
    from radmpc.planners.certified.phases.ahead import Ahead

__all__ = ["SearchResult", "searched", "tell"]

_ROUNDING = 1e-9
"""Relative excess of a bound over the cost that it bounds which is taken for none [-]."""


@dataclass(frozen=True, slots=True, eq=False)
class SearchResult:
    """How the search ended.

    Attributes
    ----------
    search : PriceSearch
        The last one.
    state : SearchState
        With a plan, or without.
    first : FleetIncumbent
        A certified plan made before the search, if any. The search does not compare its plans with
        it: they become cheaper once their half-spaces are turned, too.
    answer : WhyNot or None
        What the last resort says, if it was asked.
    stopped_by : str or None
        The limit that ended the search, if one did.
    on_any : float
        What the proof around the first plan says that any certified plan costs at least.
    is_closed : bool
        Whether that proof made the search needless.
    proven : mapping of tuple of int to mapping of tuple of int to RelaxedSet
        Where that proof is taken up again.
    """

    search: PriceSearch
    state: SearchState
    first: FleetIncumbent
    answer: WhyNot | None
    stopped_by: str | None
    on_any: float = -np.inf
    is_closed: bool = False
    proven: Proven = field(default_factory=dict)


def searched(
    scenario: Scenario,
    hazards: Hazards,
    planner: Planner,
    run: Run,
    proof_seconds: float | None,
    *,
    is_persistent: bool,
) -> SearchResult:
    """Search for the best plan; where the search finds none, try what else leads to one.

    Parameters
    ----------
    scenario : Scenario
        The fleet.
    hazards : Hazards
        What its vehicles keep clear of.
    planner, run
        As in `Decomposition.plan`.
    proof_seconds, is_persistent
        As in `Certified`.

    Returns
    -------
    SearchResult
        Where no time was left after the first plan, that one, or none.
    """
    begin = limits_of_search(run.limits)
    is_tight = is_tight_scene(scenario)
    first = _first(scenario, planner.gap, run, begin, hazards, is_needed=is_tight)
    if not is_tight:
        begin = _begin_with(first, scenario, begin, run.limits)
        # What follows builds programs of its own, and may be large.
        hand_back_freed()
    fleet = _fleet(scenario, planner.gap, run, begin, hazards, first.cost)
    state, search = SearchState.of(fleet), PriceSearch.of(fleet, run.judge, first.cost)
    proven: Proven = {}
    on_any, is_dear = -np.inf, False
    if is_tight and first.controls:
        ahead = _ahead(fleet, first, run, proof_seconds)
        first, on_any, proven = ahead.state.incumbent, ahead.on_any, ahead.proven
        if ahead.is_closed:
            return SearchResult(search, ahead.state, first, None, None, on_any, True)
        state = replace(state, outside_bounds=ahead.state.outside_bounds)
        begin = _begin_with(first, scenario, begin, run.limits)
        search = PriceSearch.of(fleet.with_limits(begin), run.judge, first.cost)
        fleet = search.fleet
    if not fleet.programs.build_alone(run.limits):
        return replace(_cut_off(search, state, first, run.limits), on_any=on_any, proven=proven)
    if not is_tight and first.controls:
        first, is_dear = _cheaper_first(fleet, first, run)
        fleet = replace(fleet, found=_telling(run, first.cost))
        search = PriceSearch.of(fleet, run.judge, first.cost)
    on_any = max(on_any, float(sum(outside_norms_of(fleet).base)))
    if state.budget > 0.0 and not is_dear:
        search, state, first = at_prices(search, state, first, run.judge)
    if state.has_plan or is_dear:
        # Turning has time of its own, reserved beforehand.
        found = SearchResult(search, state, first, None, begin.reason or None)
    else:
        limits = begin if first.controls else run.limits
        found = _by_last_resort(
            search.with_limits(limits), state, first, is_persistent=is_persistent
        )
        found = replace(found, stopped_by=begin.reason or None)
    return replace(found, on_any=on_any, proven=proven)


def _ahead(fleet: Fleet, first: FleetIncumbent, run: Run, proof_seconds: float | None) -> Ahead:
    """Prove what any certified plan costs at least before the search."""
    from radmpc.planners.certified.phases.ahead import prove_ahead  # noqa: PLC0415 - not along intervals

    run.progress("proving", 0, 1)
    return prove_ahead(fleet, first, run.judge, proof_seconds)


def _by_last_resort(
    search: PriceSearch, state: SearchState, first: FleetIncumbent, *, is_persistent: bool
) -> SearchResult:
    """Return what else leads to a plan, or why there is none."""
    from radmpc.planners.certified.fallbacks import last_resort  # noqa: PLC0415 - few need it

    last = last_resort(search, state, is_persistent=is_persistent)
    return SearchResult(last.search, last.state, first, last.answer, None)


def _begin_with(first: FleetIncumbent, scenario: Scenario, begin: Limits, limits: Limits) -> Limits:
    """Return when the search ends: among obstacles, or in small fleets, others may come further."""
    if not first.controls:
        return begin
    is_nearby = is_searched_nearby(scenario)
    if is_nearby and scenario.num_vehicles <= PROOF_TUNING.most_together:
        return but_for_faces(begin, limits, PHASES.face_share_in_the_open)
    is_followed = is_nearby or bool(scenario.obstacles)
    return but_for_faces(begin, limits, PHASES.face_share) if is_followed else begin


def _cut_off(
    search: PriceSearch, state: SearchState, first: FleetIncumbent, limits: Limits
) -> SearchResult:
    """Return what there is where a limit leaves no time for a search: the first plan, or none."""
    answer = None
    if not first.controls:
        fleet = search.fleet
        text = ended(fleet.scenario, limits, fleet.programs.models)
        answer = WhyNot(text, is_proven=False)
    return SearchResult(search, state, first, answer, limits.reason or None)


def _cheaper_first(fleet: Fleet, first: FleetIncumbent, run: Run) -> tuple[FleetIncumbent, bool]:
    """Make a first plan cheaper where that leads to what the search for sets does not.

    And tell whether that search is left for something else.
    """
    if is_dear_between_few(fleet, first):
        return _cheaper_nearby(fleet, first, run), True
    if is_among_many(fleet):
        first = _on_sides_alone(fleet, first, run)
    return first, is_dear_alone(fleet, first)


def _on_sides_alone(fleet: Fleet, first: FleetIncumbent, run: Run) -> FleetIncumbent:
    """Turn a first plan to sides on which vehicles are cheaper alone, and tell if that is so."""
    from radmpc.planners.certified.phases.sides_alone import on_sides_alone  # noqa: PLC0415 - few need it

    found = on_sides_alone(fleet, first, run.judge)
    if found.cost < first.cost:
        _tell_first(run, found)
    return found


def _cheaper_nearby(fleet: Fleet, first: FleetIncumbent, run: Run) -> FleetIncumbent:
    """Search neighborhoods of a first plan, and tell of every cheaper one."""
    from radmpc.planners.certified.phases.neighborhoods import search_neighborhoods  # noqa: PLC0415 - few need it

    run.progress("improving", 0, 1)
    limits = fleet.limits
    fleet = fleet.with_limits(limits.within(PHASES.share_among_obstacles * limits.seconds_left))
    on_cheaper = partial(_tell_first, run)
    return search_neighborhoods(fleet, first, run.judge, run.rng.spawn(1)[0], on_cheaper)


def _first(
    scenario: Scenario, gap: float, run: Run, limits: Limits, hazards: Hazards, *, is_needed: bool
) -> FleetIncumbent:
    """Make a plan before the search, if that is quick or needed."""
    visits = None
    if scenario.has_windows:
        # The first plan makes its visits at good steps; the search chooses among all.
        from radmpc.planners.certified.turned.touring.visiting import at_good_visits  # noqa: PLC0415 - few have any

        visits = at_good_visits(hazards)
    reports, risk_bound = FirstReports(run, hazards, scenario.risk_bound), scenario.risk_bound

    def alone(i: int) -> DisjunctiveProgram:
        return build_program(scenario, (hazards.models[i],), risk_bound=risk_bound)

    task = Task(hazards, run.judge, limits, gap, risk_bound, reports, alone)
    price = SEARCH_TUNING.budgets.risk_to_cost
    with closing(reports):
        return first_plan(task, price, run.rng, visits, is_needed=is_needed)


def _fleet(
    scenario: Scenario, gap: float, run: Run, limits: Limits, hazards: Hazards, first_cost: float
) -> Fleet:
    """Return the problem of the search, which tells of no plan dearer than the first one."""
    fleet = Fleet.of(
        scenario,
        gap,
        limits,
        hazards=hazards,
        progress=lambda done, total: run.progress("sets", done, total),
        found=_telling(run, first_cost),
        improved=run.improved,
        executor=run.executor,
    )
    if scenario.has_windows:
        from radmpc.planners.certified.proof.least_visits import with_least_visits  # noqa: PLC0415 - few have any

        fleet = with_least_visits(fleet)
    return fleet


def _telling(run: Run, first_cost: float) -> Callable[[float, float], None]:
    """Return what tells of a plan of the search, or of a cheaper one that was made before it."""
    return lambda cost, bound: tell(run, min(first_cost, cost), bound)


def tell(run: Run, cost: float, bound: float) -> None:
    """Tell of the best plan, and of the bound by faces unless turned half-spaces beat it.

    Parameters
    ----------
    run : Run
        Whom to tell.
    cost, bound : float
        Of the plan, and of all by faces; -inf where nothing is proven.
    """
    cost = max(cost, 0.0)  # of no control programs make a little less than nothing
    is_bound = bound <= cost + _ROUNDING * abs(cost)
    run.found(cost, finite(min(bound, cost)) if is_bound else None)


def _tell_first(run: Run, incumbent: FleetIncumbent) -> None:
    """Tell of a plan made before the search."""
    run.found(incumbent.cost, None)
    run.improved(incumbent.controls)
