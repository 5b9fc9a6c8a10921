"""Planning a whole fleet at one price of risk, with a certificate and a lower bound."""

from __future__ import annotations

import time
from functools import partial
from typing import ClassVar

import numpy as np

from radmpc.arguments import is_number, told
from radmpc.errors import ScenarioError
from radmpc.model.plan import Status
from radmpc.model.scenario import Scenario
from radmpc.planners.certified.closing import close_gap
from radmpc.planners.certified.fleet import Fleet
from radmpc.planners.certified.infeasible.answer import WhyNot
from radmpc.planners.certified.infeasible.sure import sure_why_not
from radmpc.planners.certified.phases.improving import improved, turned_to_others
from radmpc.planners.certified.phases.time_shares import but_for_proof, limits_of_search
from radmpc.planners.certified.proof.grouping import Known
from radmpc.planners.certified.proof.prove import Proof, bound_on_any
from radmpc.planners.certified.proof.tuning import TUNING as PROOF_TUNING
from radmpc.planners.certified.search import PriceSearch
from radmpc.planners.certified.state.bounds import reported_bound, shadow_price
from radmpc.planners.certified.state.incumbent import FleetIncumbent
from radmpc.planners.certified.state.search_state import SearchState
from radmpc.planners.certified.state.task import Task
from radmpc.planners.certified.tuning import TUNING as SEARCH_TUNING
from radmpc.planners.certified.turned.first_plan import first_plan
from radmpc.planners.certified.turned.tuning import TUNING
from radmpc.planners.draft import Draft
from radmpc.planners.planner import Decomposition, Planner, Run
from radmpc.planners.policies.policy import Family
from radmpc.program.build import condensed_models
from radmpc.program.hazards import Hazards
from radmpc.records import dataclass, field, replace
from radmpc.solvers.branch.branch import Branch
from radmpc.solvers.solution import Limits, Solver, relative_gap

__all__ = ["Certified"]

_ROUNDING = 1e-9
"""Relative excess of a bound over the cost that it bounds which is taken for none [-]."""


@dataclass(frozen=True, slots=True)
class Certified(Decomposition):
    """Sets merged where they collide, all at one price of risk, every plan certified.

    Attributes
    ----------
    proof_seconds : float or None
        How long the bound on any certified plan may be searched for [s]; None for as long as
        the plan took, a fifth of a second at least.
    is_persistent : bool
        Whether more faces, more effort and the reasons are tried where the search finds no plan,
        which takes many times as long. Else it says no more than that none was found.
    """

    proof_seconds: float | None = None
    is_persistent: bool = True

    families: ClassVar[frozenset[Family]] = frozenset({"priced"})
    solvers: ClassVar[tuple[type[Solver], ...]] = (Branch,)
    needs_proof: ClassVar[bool] = True
    default_seconds: ClassVar[float | None] = 60.0

    def __post_init__(self) -> None:
        """Refuse what is no time."""
        seconds = self.proof_seconds
        if seconds is not None and not (is_number(seconds) and 0.0 <= seconds < float("inf")):
            raise ScenarioError(f"proof_seconds must be a number >= 0, got {told(seconds)}")

    def __str__(self) -> str:
        return "certified" if self.proof_seconds is None else f"certified({self.proof_seconds:g})"

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
        result = _searched(scenario, planner, run, self)
        has_any = result.state.has_plan or result.first.controls
        if result.answer is not None and not has_any:
            return _empty(scenario, result.answer, begun)
        fleet, state, first = result.search.fleet, result.state, result.first
        if result.is_closed:
            run.found(first.cost, _finite(result.on_any))
            return _draft(fleet, state, result, begun, result.on_any)
        # In a large fleet turning gains more, and a search tree is kept for each of its sets.
        if state.has_plan and not fleet.is_large:
            state = close_gap(result.search.within, state)
        cost = min(first.cost, state.incumbent.cost)
        _tell(run, cost, reported_bound(fleet, state, planner.gap))
        best = first if first.cost < state.incumbent.cost else state.incumbent
        run.improved(best.controls)
        run.progress("improving", 0, 1)
        improving = fleet.with_limits(but_for_proof(run.limits, time.perf_counter() - begun))
        state = improved(improving, state, first, run.judge)
        run.progress("proving", 0, 1)
        proof = self._proof(fleet.with_limits(run.limits), state, result.known)
        state = turned_to_others(fleet.with_limits(run.limits), state, proof, run.judge)
        on_any = min(max(proof.bound, result.on_any), state.incumbent.cost)
        return _draft(fleet, state, result, begun, on_any)

    def _proof(self, fleet: Fleet, state: SearchState, known: Known) -> Proof:
        """Bound the cost of any certified plan; for so many nodes, or so many seconds if asked."""
        price, most_nodes = shadow_price(fleet, state), float("inf")
        if self.proof_seconds is not None:
            fleet = fleet.with_limits(fleet.limits.within(self.proof_seconds))
        else:
            searched = sum(known.all_nodes for known in state.set_states.values())
            few = min(fleet.scenario.num_vehicles, PROOF_TUNING.most_together)
            least = PROOF_TUNING.least_nodes * few
            most_nodes = max(least, PROOF_TUNING.node_share * searched)
        return bound_on_any(fleet, state.incumbent, price, most_nodes, known)


@dataclass(frozen=True, slots=True, eq=False)
class _SearchResult:
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
    known : mapping of tuple of int to mapping of tuple of int to RelaxedSet
        Where that proof is taken up again.
    """

    search: PriceSearch
    state: SearchState
    first: FleetIncumbent
    answer: WhyNot | None
    stopped_by: str | None
    on_any: float = -np.inf
    is_closed: bool = False
    known: Known = field(default_factory=dict)


def _searched(scenario: Scenario, planner: Planner, run: Run, record: Certified) -> _SearchResult:
    """Search for the best plan; where the search finds none, try what else leads to one."""
    begin = limits_of_search(run.limits)
    hazards = Hazards.of(scenario, condensed_models(scenario))
    is_tight = _is_tight(scenario)
    first = _first(scenario, planner.gap, run, begin, hazards, is_needed=is_tight)
    fleet = _fleet(scenario, planner.gap, run, begin, hazards, first.cost)
    search, state = PriceSearch.of(fleet, run.judge), SearchState.of(fleet)
    on_any: float = -np.inf
    known: Known = {}
    if is_tight and first.controls:
        from radmpc.planners.certified.phases.ahead import prove_ahead  # noqa: PLC0415 - not along intervals

        run.progress("proving", 0, 1)
        ahead = prove_ahead(fleet, first, run.judge, record.proof_seconds)
        first, on_any, known = ahead.state.incumbent, ahead.on_any, ahead.known
        if ahead.is_closed:
            return _SearchResult(search, ahead.state, first, None, None, on_any, True)
        state = replace(state, budget_bounds=ahead.state.budget_bounds)
    if state.budget > 0.0:
        state = search.run(state)
    # Turning has time of its own, reserved beforehand.
    stopped_by = begin.reason or None
    if state.has_plan:
        return _SearchResult(search, state, first, None, stopped_by, on_any, known=known)
    from radmpc.planners.certified.fallbacks import last_resort  # noqa: PLC0415 - few need it

    limits = begin if first.controls else run.limits
    last = last_resort(search.with_limits(limits), state, is_persistent=record.is_persistent)
    stopped_by = stopped_by or begin.reason or None
    found = _SearchResult(last.search, last.state, first, last.answer, stopped_by, on_any)
    return replace(found, known=known)


def _is_tight(scenario: Scenario) -> bool:
    """Whether the relaxation mostly comes as near to certified plans as is asked, and soon.

    In larger fleets the search over faces takes no longer; among many obstacles this has no end.
    """
    is_small = scenario.num_vehicles <= TUNING.few
    is_small &= len(scenario.obstacles) < max(PROOF_TUNING.many_obstacles, scenario.num_vehicles)
    is_planar = scenario.dimension == 2 and not scenario.has_windows
    return scenario.avoidance == "steps" and is_planar and is_small


def _first(
    scenario: Scenario, gap: float, run: Run, limits: Limits, hazards: Hazards, *, is_needed: bool
) -> FleetIncumbent:
    """Make a plan before the search, if that is quick or needed."""
    visits = None
    if scenario.has_windows:
        # The first plan makes its visits at good steps; the search chooses among all.
        from radmpc.planners.certified.turned.visiting import at_good_visits  # noqa: PLC0415 - few have any

        visits = at_good_visits(hazards)
    task = Task(hazards, run.judge, limits, gap, scenario.risk_bound, partial(_tell_first, run))
    price = SEARCH_TUNING.budgets.risk_to_cost
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
        found=lambda cost, bound: _tell(run, min(first_cost, cost), bound),
        improved=run.improved,
        executor=run.executor,
    )
    if scenario.has_windows:
        from radmpc.planners.certified.proof.least_visits import with_least_visits  # noqa: PLC0415 - few have any

        fleet = with_least_visits(fleet)
    return fleet


def _tell(run: Run, cost: float, bound: float) -> None:
    """Tell of the best plan, and of the bound by faces unless turned half-spaces beat it."""
    is_bound = bound <= cost + _ROUNDING * abs(cost)
    run.found(cost, _finite(min(bound, cost)) if is_bound else None)


def _tell_first(run: Run, incumbent: FleetIncumbent) -> None:
    """Tell of a plan made before the search."""
    run.found(incumbent.cost, None)
    run.improved(incumbent.controls)


def _draft(
    fleet: Fleet, state: SearchState, result: _SearchResult, begun: float, on_any: float
) -> Draft:
    """Return the incumbent and what is proven of it."""
    incumbent, answer = state.incumbent, result.answer
    closed = fleet.gap * (1.0 + 1e-6)
    # What bounds any certified plan bounds those by faces.
    bound = max(reported_bound(fleet, state, closed), on_any)
    is_closed = relative_gap(incumbent.cost, bound) <= closed
    return Draft(
        Status.OPTIMAL if is_closed else Status.FEASIBLE,
        incumbent.controls,
        incumbent.sets,
        state.steps,
        (),
        {"sets": time.perf_counter() - begun},
        (answer.explanation if answer is not None and result.state.has_plan else "") or None,
        lower_bound=_finite(bound),
        certified_lower_bound=_finite(on_any),
        price=shadow_price(fleet, state),
        couplings=state.merging.couplings(incumbent.sets),
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
