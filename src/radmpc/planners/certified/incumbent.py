"""The best certified plan of a fleet: rescaled to what the referee finds, not to union bounds."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from radmpc.arrays import Matrix, Vector
from radmpc.planners.certified.fleet import Fleet
from radmpc.planners.certified.rescaling import rescaled
from radmpc.planners.certified.rounds import Round
from radmpc.planners.draft import Step
from radmpc.planners.verdict import Judge, Verdict
from radmpc.solvers.solution import relative_gap

__all__ = ["FleetIncumbent", "accept_round"]

_MAX_RESCALINGS = 5
"""Budgets that the plan of one round is rescaled to at most [-]: each costs a linear program per
set and a certificate."""

_SPENT = 0.85
"""Share of Δ from which on the certificate counts as having used it up [-]."""

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


@dataclass(slots=True, eq=False)
class FleetIncumbent:
    """The best certified plan so far, and what the rounds proved.

    Attributes
    ----------
    controls : tuple of (T, m) array
        Its controls, in the scenario's order; empty without a plan.
    cost : float
        Its cost; inf without a plan.
    union_bound : float
        What its union bounds sum to beyond the starts, at most [-].
    certified : float
        Its certificate [-].
    rejected_budget : float
        The least budget for which the referee rejected the plan of a round [-].
    has_failed : bool
        Whether the referee rejected the last round at every budget tried.
    first_certificate : float
        What the referee found in the last round at its first budget [-]; 0 where it was not asked.
    sets : tuple of tuple of int
        Who was planned together.
    round_bounds : list of (float, float)
        Of each round, the least cost plus priced risk of any plan, and the unit price.
    budget_bounds : list of (float, float)
        Budgets [-], and the least cost of any plan within each.
    steps : list of Step
        The record of the rounds.
    turned_price : float or None
        What a little more Δ would save by half-spaces turned to the plan, per unit of probability;
        None if it has none.
    """

    controls: tuple[Matrix, ...] = ()
    cost: float = float("inf")
    union_bound: float = 0.0
    certified: float = 0.0
    rejected_budget: float = float("inf")
    has_failed: bool = False
    first_certificate: float = 0.0
    sets: tuple[tuple[int, ...], ...] = ()
    round_bounds: list[tuple[float, float]] = field(default_factory=list)
    budget_bounds: list[tuple[float, float]] = field(default_factory=list)
    steps: list[Step] = field(default_factory=list)
    turned_price: float | None = None

    def bound(self, fleet: Fleet) -> float:
        """Return a lower bound on the cost of any plan within its budget or the fleet's."""
        return self._bound(fleet, max(fleet.budget, self.union_bound))

    def reported_bound(self, fleet: Fleet, gap: float) -> float:
        """Return a lower bound on the cost of any plan whose union bounds sum to Δ at most.

        If the gap is closed, that of all plans whose union bounds sum to no more than this one's:
        it is lower and holds for more plans.

        Parameters
        ----------
        fleet : Fleet
            The fleet.
        gap : float
            The relative gap asked for [-].

        Returns
        -------
        float
            No more than the cost of the incumbent; -inf where nothing is proven.
        """
        bound = self.bound(fleet)
        left = fleet.scenario.risk_bound - fleet.initial
        if relative_gap(self.cost, bound) > gap and left > 0.0:
            bound = self._bound(fleet, left)
        return min(bound, self.cost)

    def price(self, fleet: Fleet) -> float | None:
        """Return what a little more Δ would save, per unit of probability; None if unknown.

        It is the shadow price of Δ: the union bounds may sum to more in proportion to Δ, and what
        that saves is the price of the round with the best bound. Where the plan leaves much of Δ
        unused, Δ is not what limits it.
        """
        risk_bound = fleet.scenario.risk_bound
        if not self.round_bounds or not self.controls or self.certified <= 0.0:
            return None
        if self.certified < _SPENT * risk_bound:
            return 0.0 if self.union_bound < _SPENT * fleet.most_budget else None
        if self.turned_price is not None:
            return self.turned_price
        units = max(fleet.budget, self.union_bound) / fleet.unit
        _, unit_price = max(self.round_bounds, key=lambda bound: bound[0] - bound[1] * units)
        return unit_price / fleet.unit * self.union_bound / self.certified

    def _bound(self, fleet: Fleet, budget: float) -> float:
        """Return the least cost within a budget."""
        bounds = [
            least - unit_price * budget / fleet.unit for least, unit_price in self.round_bounds
        ]
        bounds += [bound for most, bound in self.budget_bounds if budget <= most * (1.0 + 1e-12)]
        return max(bounds, default=-np.inf)


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
    return rescaling.settle()


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
            if verdict.certified >= _SPENT * risk_bound:
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

    def settle(self) -> bool:
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
