"""Making a round's plan the incumbent: rescaled to what the referee finds, not to union bounds."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import field

from radmpc.arrays import Vector
from radmpc.planners.certified.fleet import Fleet
from radmpc.planners.certified.merging import Merging
from radmpc.planners.certified.repair import AllocatedPrograms
from radmpc.planners.certified.rescaling import rescaled
from radmpc.planners.certified.rounds import Round
from radmpc.planners.certified.state.search_state import SearchState
from radmpc.planners.certified.tuning import TUNING
from radmpc.planners.verdict import Judge, Verdict
from radmpc.records import dataclass, replace

__all__ = ["Acceptance", "accept_round"]

_TUNED = TUNING.acceptance

_NOTHING = 1e-300
"""Stands for a certificate of 0 where one divides by it [-]."""


@dataclass(frozen=True, slots=True, eq=False)
class Acceptance:
    """What became of a round.

    Attributes
    ----------
    state : SearchState
        With the plan as incumbent if it is certified and cheaper, and the budget set by what the
        referee passed and rejected.
    has_merged : bool
        Whether the referee rejected it for pairs across sets: they are planned together from now
        on, whatever any estimate says.
    first_certificate : float
        What the referee found at the first budget [-]; 0 where it was not asked.
    """

    state: SearchState
    has_merged: bool
    first_certificate: float


def accept_round(fleet: Fleet, state: SearchState, candidate: Round, judge: Judge) -> Acceptance:
    """Make a round's plan the incumbent if it is certified and cheaper.

    What union bounds sum to and what the referee finds differ: the risks of the round are rescaled
    to larger and smaller budgets until its certificate is just below Δ.

    Parameters
    ----------
    fleet : Fleet
        The fleet.
    state : SearchState
        What is known of it.
    candidate : Round
        The plan.
    judge : callable
        The referee.

    Returns
    -------
    Acceptance
        The next state, and what the referee said.
    """
    rescaling = _Rescaling(fleet, candidate, judge, state, state.budget, candidate.inter_set_risk)
    is_over = rescaling.is_good_as_it_is()
    for _ in range(_TUNED.max_rescalings):
        if is_over or not rescaling.step():
            break
    return rescaling.finish()


@dataclass(slots=True, eq=False)
class _Rescaling:
    """How far the search for the budget at which a round's certificate is just below Δ has come.

    It exists while one round is judged, and only this class writes to it.

    Attributes
    ----------
    state : SearchState
        With the best plan so far, and the pairs that were merged.
    budget, inter_set_risk : float
        What union bounds may sum to next, and how much of it is reserved for risk between sets [-].
    low, high : float
        The largest budget that the referee passed, and the least that it rejected [-].
    first, last : Verdict or None
        What the referee said at the first budget, and at the last; None before.
    is_judged : bool
        Whether the referee was asked of the round as it is, not rescaled.
    has_merged : bool
        Whether pairs across sets were merged.
    programs : AllocatedPrograms
        The linear programs of the round, from one budget to the next.
    """

    fleet: Fleet
    candidate: Round
    judge: Judge
    state: SearchState
    budget: float
    inter_set_risk: float
    low: float = 0.0
    high: float = float("inf")
    first: Verdict | None = None
    last: Verdict | None = None
    seen: set[float] = field(default_factory=set)
    is_judged: bool = False
    has_merged: bool = False
    programs: AllocatedPrograms = field(default_factory=AllocatedPrograms)

    def step(self) -> bool:
        """Rescale to one budget; tell whether to go on to the next."""
        limits = self.budget, self.inter_set_risk
        points = rescaled(self.fleet, self.candidate, *limits, self.programs)
        if points is None:
            return self._after_failure()
        risk_bound = self.fleet.scenario.risk_bound
        verdict = self._judge(points, self.budget)
        # The plan of an earlier budget: between that and this one there is no other.
        is_known = verdict.certified in self.seen and self.low > 0.0 and self.high < float("inf")
        self.seen.add(verdict.certified)
        self.first, self.last = self.first or verdict, verdict
        if verdict.certified > risk_bound:
            if self._merge_hidden(verdict):
                return False
            self.high = min(self.high, self.budget)
            self.inter_set_risk = 2.0 * self.inter_set_risk + 0.02 * self.budget
        else:
            self.low = max(self.low, self.budget)
            if verdict.certified >= TUNING.budgets.spent * risk_bound:
                return False
            if self.fleet.is_large and verdict.certified >= TUNING.budgets.nearly * risk_bound:
                # Turning spends the rest sooner than more certificates would.
                if self.candidate.is_initial:
                    self.low = self._next_budget(verdict)
                return False
        if is_known:
            return False
        following = self._next_budget(verdict)
        is_same = abs(following - self.budget) <= _TUNED.same_budget * self.budget
        self.budget = following
        return not is_same

    def is_good_as_it_is(self) -> bool:
        """Ask the referee of a large round as it is: what it leaves of Δ turning spends sooner.

        Fleets of 64 to 1,000 take 0.8 to 1.0 of the time, for the same costs. Along intervals the
        referee finds much less than union bounds, and 96 vehicles took 1.6 of it.
        """
        candidate, scenario = self.candidate, self.fleet.scenario
        if not self.fleet.is_large or scenario.avoidance != "steps":
            return False
        risk_bound = scenario.risk_bound
        union_bound = candidate.risk + candidate.inter_set_risk
        verdict = self._judge([plan.z for plan in candidate.plans], union_bound)
        if verdict.certified > risk_bound:
            # What the referee found tells how much less is enough, which is mostly little.
            self.budget = self._next_budget(verdict, union_bound)
        if not TUNING.budgets.nearly * risk_bound <= verdict.certified <= risk_bound:
            return False
        self.first = self.last = verdict
        self.budget = self.low = max(union_bound, self.budget)
        if candidate.is_initial:
            self.low = self._next_budget(verdict)
        return True

    def _next_budget(self, verdict: Verdict, union_bound: float | None = None) -> float:
        """Return the budget at which the certificate is expected to come to Δ, or one between."""
        aim = _TUNED.aim * self.fleet.scenario.risk_bound
        budget = self.budget if union_bound is None else union_bound
        following = budget * min(_TUNED.stretch, aim / max(verdict.certified, _NOTHING))
        if self.low and self.high < float("inf"):
            following = (self.low * self.high) ** 0.5
        return min(following, self.fleet.most_budget)

    def _after_failure(self) -> bool:
        """Raise the budget where these alternatives exceed it; tell whether to go on."""
        if self.high < float("inf"):
            # Too little for these alternatives, and `high` too much.
            self.budget = 0.5 * (self.budget + self.high)
            return True
        if self.is_judged or self.state.has_plan:
            return False
        self.is_judged = True
        # What union bounds may sum to, by what the referee finds in the round as it is.
        candidate, fleet = self.candidate, self.fleet
        union_bound = candidate.risk + candidate.inter_set_risk
        verdict = self._judge([plan.z for plan in candidate.plans], union_bound)
        left = (
            union_bound * _TUNED.aim * fleet.scenario.risk_bound / max(verdict.certified, _NOTHING)
        )
        budget = min(left, fleet.most_budget)
        if self._merge_hidden(verdict) or budget <= self.budget * (1.0 + _TUNED.same_budget):
            return False
        self.budget = budget
        return True

    def finish(self) -> Acceptance:
        """Set the fleet's budget by what was found, unless sets are merged instead."""
        has_failed = self.high < float("inf") and not self.low
        if not self.has_merged:
            self.state = replace(self.state, has_failed=has_failed)
            if self.low:
                budget = min(self.low, _TUNED.back_off * self.state.rejected_budget)
                self.state = replace(self.state, budget=self.fleet.clipped_budget(budget))
            elif has_failed:
                self._after_rejection()
        first = 0.0 if self.first is None else self.first.certified
        return Acceptance(self.state, self.has_merged, first)

    def _after_rejection(self) -> None:
        """Merge the pairs that are to blame for a rejected plan; without any, lower the budget."""
        fleet, state = self.fleet, self.state
        if self.last is not None and self._merge(
            state.merging.reject(self.candidate.sets, self.last)
        ):
            return
        # The referee finds more in these alternatives: go nearer to Δ, where it cannot.
        self.state = replace(
            state,
            rejected_budget=min(state.rejected_budget, state.budget),
            budget=fleet.clipped_budget(
                _TUNED.back_off * (state.budget * fleet.least_budget) ** 0.5
            ),
        )

    def _merge_hidden(self, verdict: Verdict) -> bool:
        """Merge sets where the referee finds much more between them than was estimated."""
        fleet = self.fleet
        estimate = (
            _TUNED.hidden * self.candidate.inter_set_risk + fleet.gap * fleet.scenario.risk_bound
        )
        merging = self.state.merging
        return self._merge(merging.reject_hidden(self.candidate.sets, verdict, estimate))

    def _merge(self, merging: Merging | None) -> bool:
        """Take the pairs that are planned together from now on; tell whether there are any."""
        if merging is None:
            return False
        self.state, self.has_merged = replace(self.state, merging=merging), True
        return True

    def _judge(self, points: Sequence[Vector], union_bound: float) -> Verdict:
        """Keep a plan if it is certified and the cheapest; return what the referee says of it."""
        fleet, sets = self.fleet, self.candidate.sets
        controls = fleet.programs.controls(sets, points)
        verdict = self.judge(controls)
        pairs = zip(sets, points, strict=True)
        cost = sum(float(fleet.programs.problem(m).program.cost @ z) for m, z in pairs)
        incumbent = self.state.incumbent
        if verdict.certified <= fleet.scenario.risk_bound and cost < incumbent.cost:
            self.state = replace(
                self.state,
                incumbent=replace(
                    incumbent,
                    controls=controls,
                    cost=cost,
                    sets=sets,
                    union_bound=union_bound,
                    certified=verdict.certified,
                ),
                incumbent_parts=fleet.programs.split(sets, points),
            )
        return verdict
