"""Making a round's plan the incumbent: rescaled to what the referee finds, not to union bounds."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from radmpc.arrays import Vector
from radmpc.planners.certified.fleet import Fleet
from radmpc.planners.certified.incumbent import SPENT, FleetIncumbent
from radmpc.planners.certified.rescaling import rescaled
from radmpc.planners.certified.rounds import Round
from radmpc.planners.verdict import Judge, Verdict

__all__ = ["accept_round"]

_MAX_RESCALINGS = 5
"""Budgets that the plan of one round is rescaled to at most [-]: each costs a linear program per
set and a certificate."""

_AIM = 0.95
"""Share of Δ that the certificate is to come to at the next budget [-]: it grows a little faster
than in proportion."""

_BACK_OFF = 0.97
"""Factor that keeps the next budget below one that the referee rejected [-]."""

_STRETCH = 3.0
"""Factor by which a budget grows at most from one rescaling to the next [-]."""

_CLOSE = 0.03
"""Relative difference below which two budgets are one [-]."""

_NOTHING = 1e-300
"""Stands for a certificate of 0 where one divides by it [-]."""

_HIDDEN = 2.0
"""Multiple of the risk estimated between sets up to which the referee's counts as explained [-]."""


def accept_round(fleet: Fleet, candidate: Round, incumbent: FleetIncumbent, judge: Judge) -> bool:
    """Make a round's plan the incumbent if it is certified and cheaper.

    What union bounds sum to and what the referee finds differ: the risks of the round are rescaled
    to larger and smaller budgets until its certificate is just below Δ.

    Parameters
    ----------
    fleet : Fleet
        The fleet; its budget is set by what the referee passed and rejected.
    candidate : Round
        The plan.
    incumbent : FleetIncumbent
        Takes the plan.
    judge : callable
        The referee.

    Returns
    -------
    bool
        Whether the referee rejected it for pairs across sets: they are planned together from now
        on, whatever any estimate says.
    """
    rescaling = _Rescaling(
        fleet, candidate, incumbent, judge, fleet.budget, candidate.inter_set_risk
    )
    for _ in range(_MAX_RESCALINGS):
        if not rescaling.step():
            break
    return rescaling.finish()


@dataclass(slots=True, eq=False)
class _Rescaling:
    """How far the search for the budget at which a round's certificate is just below Δ has come.

    Attributes
    ----------
    budget, inter_set_risk : float
        What union bounds may sum to next, and how much of it is reserved for risk between sets [-].
    low, high : float
        The largest budget that the referee passed, and the least that it rejected [-].
    """

    fleet: Fleet
    candidate: Round
    incumbent: FleetIncumbent
    judge: Judge
    budget: float
    inter_set_risk: float
    low: float = 0.0
    high: float = float("inf")
    verdict: Verdict | None = None
    is_judged: bool = False
    has_merged: bool = False

    def step(self) -> bool:
        """Rescale to one budget; tell whether to go on to the next."""
        points = rescaled(self.fleet, self.candidate, self.budget, self.inter_set_risk)
        if points is None:
            return self._after_failure()
        risk_bound = self.fleet.scenario.risk_bound
        is_first = self.verdict is None
        verdict = self.verdict = _accept(
            self.fleet, self.candidate, points, self.incumbent, self.judge, self.budget
        )
        if is_first:
            self.incumbent.first_certificate = verdict.certified
        if verdict.certified > risk_bound:
            self.has_merged = _is_hidden(self.fleet, self.candidate, verdict)
            if self.has_merged:
                return False
            self.high = min(self.high, self.budget)
            self.inter_set_risk = 2.0 * self.inter_set_risk + 0.02 * self.budget
        else:
            self.low = max(self.low, self.budget)
            if verdict.certified >= SPENT * risk_bound:
                return False
        following = self.budget * min(
            _STRETCH, _AIM * risk_bound / max(verdict.certified, _NOTHING)
        )
        if self.low and self.high < float("inf"):
            following = (self.low * self.high) ** 0.5
        following = min(following, self.fleet.most_budget)
        is_same = abs(following - self.budget) <= _CLOSE * self.budget
        self.budget = following
        return not is_same

    def _after_failure(self) -> bool:
        """Raise the budget where these alternatives exceed it; tell whether to go on."""
        if self.high < float("inf"):
            # Too little for these alternatives, and `high` too much.
            self.budget = 0.5 * (self.budget + self.high)
            return True
        if self.is_judged or self.incumbent.controls:
            return False
        self.is_judged = True
        budget, verdict = _left_by_referee(self.fleet, self.candidate, self.incumbent, self.judge)
        self.has_merged = _is_hidden(self.fleet, self.candidate, verdict)
        if self.has_merged or budget <= self.budget * (1.0 + _CLOSE):
            return False
        self.budget = budget
        return True

    def finish(self) -> bool:
        """Set the fleet's budget by what was found; tell whether sets were merged instead."""
        fleet, incumbent = self.fleet, self.incumbent
        if self.has_merged:
            return True
        incumbent.has_failed = self.high < float("inf") and not self.low
        if self.low:
            fleet.set_budget(min(self.low, _BACK_OFF * incumbent.rejected_budget))
        elif incumbent.has_failed:
            if self.verdict is not None and fleet.merging.reject(self.candidate.sets, self.verdict):
                return True
            # The referee finds more in these alternatives: go nearer to Δ, where it cannot.
            incumbent.rejected_budget = min(incumbent.rejected_budget, fleet.budget)
            fleet.set_budget(_BACK_OFF * (fleet.budget * fleet.least_budget) ** 0.5)
        return False


def _is_hidden(fleet: Fleet, candidate: Round, verdict: Verdict) -> bool:
    """Merge sets where the referee finds much more between them than was estimated; tell if so."""
    estimate = _HIDDEN * candidate.inter_set_risk + fleet.gap * fleet.scenario.risk_bound
    return fleet.merging.is_hidden(candidate.sets, verdict, estimate)


def _left_by_referee(
    fleet: Fleet, candidate: Round, incumbent: FleetIncumbent, judge: Judge
) -> tuple[float, Verdict]:
    """Return what union bounds may sum to, by what the referee finds in a round as it is."""
    union_bound = candidate.risk + candidate.inter_set_risk
    raw = [plan.z for plan in candidate.plans]
    verdict = _accept(fleet, candidate, raw, incumbent, judge, union_bound)
    left = union_bound * _AIM * fleet.scenario.risk_bound / max(verdict.certified, _NOTHING)
    return min(left, fleet.most_budget), verdict


def _accept(
    fleet: Fleet,
    candidate: Round,
    points: Sequence[Vector],
    incumbent: FleetIncumbent,
    judge: Judge,
    union_bound: float,
) -> Verdict:
    """Keep a plan if it is certified and the cheapest; return what the referee says of it."""
    controls = fleet.programs.controls(candidate.sets, points)
    verdict = judge(controls)
    pairs = zip(candidate.sets, points, strict=True)
    cost = sum(float(fleet.programs.problems[m].program.cost @ z) for m, z in pairs)
    if verdict.certified <= fleet.scenario.risk_bound and cost < incumbent.cost:
        incumbent.controls, incumbent.cost, incumbent.sets = controls, cost, candidate.sets
        incumbent.union_bound = union_bound
        incumbent.certified = verdict.certified
        fleet.incumbent_parts = fleet.programs.split(candidate.sets, points)
    return verdict
