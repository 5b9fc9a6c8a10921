"""Planning a whole fleet at one price of risk, with a certificate and a lower bound."""

from __future__ import annotations

import time
from typing import ClassVar

from radmpc.arguments import is_number, value_text
from radmpc.errors import ScenarioError
from radmpc.model.limits import all_outside_norms
from radmpc.model.plan import Status
from radmpc.model.scenario import Scenario
from radmpc.planners.certified.closing import close_gap
from radmpc.planners.certified.fleet import Fleet
from radmpc.planners.certified.infeasible.answer import WhyNot
from radmpc.planners.certified.infeasible.sure import sure_why_not
from radmpc.planners.certified.phases.by_faces import bound_faces_of_each
from radmpc.planners.certified.phases.improving import (
    cheaper,
    improved,
    searched_nearby,
    turned_to_others,
)
from radmpc.planners.certified.phases.norms import turned_to_norms
from radmpc.planners.certified.phases.searching import SearchResult, searched, tell
from radmpc.planners.certified.phases.time_shares import (
    but_for_certificates,
    but_for_proof,
)
from radmpc.planners.certified.proof.grouping import Proven
from radmpc.planners.certified.proof.norms import outside_norms_of
from radmpc.planners.certified.proof.prove import Proof, bound_on_any
from radmpc.planners.certified.proof.tuning import TUNING as PROOF_TUNING
from radmpc.planners.certified.state.bounds import finite, is_told, reported_bound, shadow_price
from radmpc.planners.certified.state.outdone import is_outdone
from radmpc.planners.certified.state.search_state import SearchState
from radmpc.planners.certified.state.timed_judge import TimedJudge
from radmpc.planners.draft import Draft
from radmpc.planners.planner import Decomposition, Planner, Run
from radmpc.planners.policies.policy import Family
from radmpc.planners.units.planned import planned_in_units
from radmpc.planners.within_norms import models_within_norms
from radmpc.program.build import condensed_models
from radmpc.program.condensed import CondensedModel
from radmpc.program.hazards import Hazards
from radmpc.records import dataclass, replace
from radmpc.solvers.branch.branch import Branch
from radmpc.solvers.solution import Limits, Solver, relative_gap
from radmpc.system.memory import hand_back_freed
from radmpc.wording import number_text, with_options

__all__ = ["Certified"]

_WITHIN_NORMS = (
    "Plans keep to polytopes within limits of norms: whether these leave one is not known."
)
"""Said where only that is what leaves no plan."""


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
            raise ScenarioError(f"proof_seconds must be a number >= 0, got {value_text(seconds)}")

    def __str__(self) -> str:
        # What is tried where there is no plan makes no other plan, and is not told.
        seconds = "" if self.proof_seconds is None else number_text(self.proof_seconds)
        return with_options("certified", seconds)

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

        def there(other: Scenario, asked: Run) -> Draft:
            return self._plan(other, planner, asked)

        def why_not() -> str | None:
            answer = sure_why_not(scenario, models_within_norms(scenario), run.limits)
            return None if answer is None else answer.explanation

        told = planned_in_units(scenario, run, there, why_not)
        if told is not None:
            return told
        return self._plan(scenario, planner, run)

    def _plan(self, scenario: Scenario, planner: Planner, run: Run) -> Draft:
        """Plan a fleet in the units that it is in."""
        begun, judge = time.perf_counter(), TimedJudge(run.judge, scenario.risk_bound)
        run = replace(run, judge=judge)
        models = models_within_norms(scenario)
        ruled_out = sure_why_not(scenario, models, run.limits)
        if ruled_out is not None:
            return self._empty(scenario, ruled_out, planner, run, begun)
        hazards = Hazards.of(scenario, models)
        result = searched(
            scenario, hazards, planner, run, self.proof_seconds, is_persistent=self.is_persistent
        )
        has_any = result.state.has_plan or result.first.controls
        if result.answer is not None and not has_any:
            return self._empty(scenario, result.answer, planner, run, begun)
        fleet, state, first = result.search.fleet, result.state, result.first
        if result.is_closed:
            state = turned_to_norms(fleet, state, run.judge)
            if not fleet.keeps_norms or is_told(fleet, state, result.on_any):
                run.found(state.incumbent.cost, finite(result.on_any))
                return _draft(fleet, state, result, begun, result.on_any)
        if run.limits.reached:
            # All that follows would begin only to end. The plan may be of the last moment.
            state = cheaper(state, first)
            if state.has_plan:
                tell(run, state.incumbent.cost, reported_bound(fleet, state, planner.gap))
                run.improved(state.incumbent.controls)
            return _draft(fleet, state, result, begun, result.on_any)
        found = replace(result, state=state)
        limits = but_for_certificates(run.limits, judge.seconds)
        return self._finished(found, planner.gap, replace(run, limits=limits), begun)

    def _empty(
        self, scenario: Scenario, answer: WhyNot, planner: Planner, run: Run, begun: float
    ) -> Draft:
        """Return a draft without a plan that says why there is none."""
        text, is_proven = answer.explanation, answer.is_proven
        rules_out_any = is_proven and answer.rules_out_any
        if is_proven and all_outside_norms(scenario) is not scenario:
            rules_out_any = _is_sure_outside_norms(scenario, run.limits)
            is_proven = rules_out_any or self._holds_outside_norms(scenario, planner, run)
            if not is_proven and "polytope" not in text:
                text = f"{text} {_WITHIN_NORMS}"
        status = Status.INFEASIBLE if is_proven else Status.LIMIT
        sets = (tuple(range(scenario.num_vehicles)),) if is_proven else ()
        seconds = {"sets": time.perf_counter() - begun}
        return Draft(status, (), sets, (), (), seconds, text, rules_out_any=rules_out_any)

    def _holds_outside_norms(self, scenario: Scenario, planner: Planner, run: Run) -> bool:
        """Tell whether what programs say of having no plan holds of the limits of norms themselves.

        Programs keep to polytopes within these. It does where there is no plan between polytopes
        around these, either.
        """
        outside, models = _outside_norms(scenario)
        hazards, quiet = Hazards.of(outside, models), run.in_silence()
        found = searched(outside, hazards, planner, quiet, self.proof_seconds, is_persistent=True)
        has_any = found.state.has_plan or found.first.controls
        return found.answer is not None and found.answer.is_proven and not has_any

    def _finished(self, result: SearchResult, gap: float, run: Run, begun: float) -> Draft:
        """Make the plan of a search cheaper, and prove how good it is."""
        fleet, state, first = result.search.fleet, result.state, result.first
        is_left = not state.has_plan or is_outdone(fleet, state, first.cost)
        # In a large fleet turning gains more, and a search tree is kept for each of its sets.
        if state.has_plan and not (fleet.is_large or is_left or result.is_closed):
            state = close_gap(result.search.within, state)
        best = first if first.cost < state.incumbent.cost else state.incumbent
        tell(run, best.cost, reported_bound(fleet, state, gap))
        run.improved(best.controls)
        run.progress("improving", 0, 1)
        # Turning and the proof build what they need of them, and both take memory of their own.
        fleet.programs.forget()
        improving = fleet.with_limits(but_for_proof(run.limits, time.perf_counter() - begun))
        if not result.is_closed:
            state = improved(improving, state, first, run.judge)
            state = searched_nearby(improving, state, run)
            state = turned_to_norms(improving, state, run.judge)
        state, on_any = self._proven(improving, state, result, run, is_left=is_left)
        draft = _draft(fleet, state, result, begun, on_any)
        return replace(draft, stopped_by=draft.stopped_by or run.limits.reason or None)

    def _proven(
        self, improving: Fleet, state: SearchState, result: SearchResult, run: Run, *, is_left: bool
    ) -> tuple[SearchState, float]:
        """Bound plans by faces in the time for improving, then any, and turn to others."""
        run.progress("proving", 0, 1)
        hand_back_freed()
        fleet = result.search.fleet.with_limits(run.limits)
        # The nodes of a search that was left say nothing of how hard the proof is.
        is_untold = is_left and run.limits.seconds_left < float("inf")
        is_timed = is_untold or result.stopped_by is not None
        most_nodes = _nodes_of_proof(fleet, state, is_timed)
        state = bound_faces_of_each(improving, state, most_nodes, run.judge)
        tell(run, state.incumbent.cost, reported_bound(fleet, state, fleet.gap))
        most_nodes = _nodes_of_proof(fleet, state, is_untold)
        proof = self._proof(fleet, state, result.proven, most_nodes)
        state = turned_to_others(fleet, state, proof, run.judge)
        return state, min(max(proof.bound, result.on_any), state.incumbent.cost)

    def _proof(self, fleet: Fleet, state: SearchState, proven: Proven, most_nodes: float) -> Proof:
        """Bound the cost of any certified plan; for so many nodes, or so many seconds if asked."""
        price = shadow_price(fleet, state)
        if self.proof_seconds is not None:
            most_nodes = float("inf")
            fleet = fleet.with_limits(fleet.limits.within(self.proof_seconds))
        outside = outside_norms_of(fleet, state.incumbent.controls)
        proof = bound_on_any(outside, state.incumbent, price, most_nodes, proven)
        return replace(proof, is_outside=outside is not fleet)


def _outside_norms(scenario: Scenario) -> tuple[Scenario, tuple[CondensedModel, ...]]:
    """Return a scenario between polytopes around its norms, condensed."""
    # Twice, as what looks for reasons may turn its polytopes, too.
    outside = all_outside_norms(all_outside_norms(scenario))
    return outside, condensed_models(outside)


def _is_sure_outside_norms(scenario: Scenario, limits: Limits) -> bool:
    """Whether no plan keeps the norms, as far as no search is needed to know."""
    return sure_why_not(*_outside_norms(scenario), limits) is not None


def _nodes_of_proof(fleet: Fleet, state: SearchState, is_timed: bool) -> float:
    """Return the nodes that a bound may take after the search, any if only time ends it."""
    if is_timed:
        return float("inf")
    searched = sum(each.all_nodes for each in state.set_states.values())
    few = min(fleet.scenario.num_vehicles, PROOF_TUNING.most_together)
    least = max(PROOF_TUNING.least_nodes, PROOF_TUNING.least_nodes_each * few)
    return max(least, PROOF_TUNING.node_share * searched)


def _draft(
    fleet: Fleet, state: SearchState, result: SearchResult, begun: float, on_any: float
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
        lower_bound=finite(bound),
        certified_lower_bound=finite(on_any),
        price=shadow_price(fleet, state),
        couplings=state.merging.couplings(incumbent.sets),
        stopped_by=result.stopped_by,
    )
