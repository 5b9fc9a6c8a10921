"""The best certified plan so far: fitted to what the referee finds, not to simple bounds."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from radmpc.arrays import Matrix, Vector
from radmpc.planners.certified.fleet import Fleet
from radmpc.planners.certified.rescaling import fitted
from radmpc.planners.certified.rounds import Round
from radmpc.planners.draft import Step
from radmpc.planners.verdict import Judge, Verdict
from radmpc.solvers.solution import relative_gap

__all__ = ["Best", "take"]

_FITS = 5
_SPENT = 0.85
"""Share of Δ from which on the referee's figure counts as used up."""

_AIM = 0.95
_BACK_OFF = 0.97
_STRETCH = 3.0
_CLOSE = 0.03
"""Relative difference below which two budgets are one."""

_NOTHING = 1e-300

_HIDDEN = 2.0
"""Multiple of what was estimated between sets from which on the estimate hid something."""


@dataclass(slots=True, eq=False)
class Best:
    """The best certified plan so far, and what the rounds proved."""

    controls: tuple[Matrix, ...] = ()
    cost: float = float("inf")
    spent: float = 0.0
    certified: float = 0.0
    too_much: float = float("inf")
    has_failed: bool = False
    asked: float = 0.0
    """What the referee found in the last plan taken as it came; 0 where it was not asked."""
    sets: tuple[tuple[int, ...], ...] = ()
    rounds: list[tuple[float, float]] = field(default_factory=list)
    """Of each round, the least cost and priced risk of any plan, and the price."""
    within: list[tuple[float, float]] = field(default_factory=list)
    """What simple bounds may sum to beyond the starts, and the least cost of any plan within."""
    steps: list[Step] = field(default_factory=list)
    turned_price: float | None = None
    """What a little more Δ would save by half-spaces turned to the plan; None if it has none."""

    def bound(self, fleet: Fleet) -> float:
        """Return the least cost of any plan whose simple bounds sum to no more than its own."""
        return self._bound(fleet, max(fleet.budget, self.spent))

    def reported(self, fleet: Fleet, gap: float) -> float:
        """Return a lower bound on the cost of any plan whose simple bounds sum to Δ at most.

        If the gap is closed, that of plans whose simple bounds sum to what this one's do: lower,
        and saying more.
        """
        bound = self.bound(fleet)
        granted = fleet.scenario.risk_bound - fleet.initial
        if relative_gap(self.cost, bound) > gap and granted > 0.0:
            bound = self._bound(fleet, granted)
        return min(bound, self.cost)

    def price(self, fleet: Fleet) -> float | None:
        """Return what a little more Δ would save, per unit of probability; None if unknown.

        The simple bounds may sum to more in proportion to Δ, and what that saves is the price of
        the round with the best bound. Where the plan leaves much of Δ, Δ is not what limits it.
        """
        granted = fleet.scenario.risk_bound
        if not self.rounds or not self.controls or self.certified <= 0.0:
            return None
        if self.certified < _SPENT * granted:
            return 0.0 if self.spent < _SPENT * fleet.most_budget else None
        if self.turned_price is not None:
            return self.turned_price
        units = max(fleet.budget, self.spent) / fleet.unit
        _, price = max(self.rounds, key=lambda found: found[0] - found[1] * units)
        return price / fleet.unit * self.spent / self.certified

    def _bound(self, fleet: Fleet, budget: float) -> float:
        """Return the least cost within a budget."""
        bounds = [least - price * budget / fleet.unit for least, price in self.rounds]
        bounds += [bound for most, bound in self.within if budget <= most * (1.0 + 1e-12)]
        return max(bounds, default=-np.inf)


def take(fleet: Fleet, found: Round, best: Best, judge: Judge) -> bool:
    """Keep a round's plan if it is certified and better than what there is.

    What simple bounds sum to and what the referee finds differ: fitted to more or less of the
    former, the sides of the round come to just below Δ by the latter.

    Returns
    -------
    bool
        Whether the referee rejected it for pairs across sets: they are planned together from now
        on, whatever any estimate says.
    """
    fit = _Fit(fleet, found, best, judge, fleet.budget, found.cross)
    for _ in range(_FITS):
        if not fit.step():
            break
    return fit.settle()


@dataclass(slots=True, eq=False)
class _Fit:
    """How far a round's fitting to the referee has come.

    Attributes
    ----------
    budget, cross : float
        What simple bounds may sum to next, and what of it is kept for risk between sets.
    low, high : float
        The most that the referee left within Δ, and the least that it did not.
    """

    fleet: Fleet
    found: Round
    best: Best
    judge: Judge
    budget: float
    cross: float
    low: float = 0.0
    high: float = float("inf")
    verdict: Verdict | None = None
    is_judged: bool = False
    has_merged: bool = False

    def step(self) -> bool:
        """Fit to one budget; tell whether to go on to the next."""
        points = fitted(self.fleet, self.found, self.budget, self.cross)
        if points is None:
            return self._after_no_fit()
        granted = self.fleet.scenario.risk_bound
        is_first = self.verdict is None
        verdict = self.verdict = _keep(
            self.fleet, self.found, points, self.best, self.judge, self.budget
        )
        if is_first:
            self.best.asked = verdict.certified
        if verdict.certified > granted:
            self.has_merged = _is_hidden(self.fleet, self.found, verdict)
            if self.has_merged:
                return False
            self.high = min(self.high, self.budget)
            self.cross = 2.0 * self.cross + 0.02 * self.budget
        else:
            self.low = max(self.low, self.budget)
            if verdict.certified >= _SPENT * granted:
                return False
        following = self.budget * min(_STRETCH, _AIM * granted / max(verdict.certified, _NOTHING))
        if self.low and self.high < float("inf"):
            following = (self.low * self.high) ** 0.5
        following = min(following, self.fleet.most_budget)
        is_same = abs(following - self.budget) <= _CLOSE * self.budget
        self.budget = following
        return not is_same

    def _after_no_fit(self) -> bool:
        """Grant more where the sides do not fit; tell whether to go on."""
        if self.high < float("inf"):
            # Too little for these sides, and `high` too much.
            self.budget = 0.5 * (self.budget + self.high)
            return True
        if self.is_judged or self.best.controls:
            return False
        self.is_judged = True
        granted, verdict = _left_by_referee(self.fleet, self.found, self.best, self.judge)
        self.has_merged = _is_hidden(self.fleet, self.found, verdict)
        if self.has_merged or granted <= self.budget * (1.0 + _CLOSE):
            return False
        self.budget = granted
        return True

    def settle(self) -> bool:
        """Set the fleet's budget by what was found; tell whether sets were merged instead."""
        fleet, best = self.fleet, self.best
        if self.has_merged:
            return True
        best.has_failed = self.high < float("inf") and not self.low
        if self.low:
            fleet.set_budget(min(self.low, _BACK_OFF * best.too_much))
        elif best.has_failed:
            if self.verdict is not None and fleet.part_of_one(self.found.sets, self.verdict):
                return True
            # The referee finds more in these sides: nearer to Δ, where it cannot.
            best.too_much = min(best.too_much, fleet.budget)
            fleet.set_budget(_BACK_OFF * (fleet.budget * fleet.least_budget) ** 0.5)
        return False


def _is_hidden(fleet: Fleet, found: Round, verdict: Verdict) -> bool:
    """Merge sets where the referee finds much more between them than was estimated; tell if so."""
    across = verdict.across(fleet.owners(found.sets), fleet.numbers)
    estimated = _HIDDEN * found.cross + fleet.gap * fleet.scenario.risk_bound
    return sum(across.values()) > estimated and fleet.part_of_one(found.sets, verdict)


def _left_by_referee(fleet: Fleet, found: Round, best: Best, judge: Judge) -> tuple[float, Verdict]:
    """Return what simple bounds may sum to, by what the referee finds in a round as it is."""
    spent = found.risk + found.cross
    raw = [plan.z for plan in found.plans]
    verdict = _keep(fleet, found, raw, best, judge, spent)
    left = spent * _AIM * fleet.scenario.risk_bound / max(verdict.certified, _NOTHING)
    return min(left, fleet.most_budget), verdict


def _keep(
    fleet: Fleet,
    found: Round,
    points: Sequence[Vector],
    best: Best,
    judge: Judge,
    spent: float,
) -> Verdict:
    """Keep a plan if it is certified and the best; return what the referee says of it."""
    controls = fleet.controls(found.sets, points)
    verdict = judge(controls)
    pairs = zip(found.sets, points, strict=True)
    cost = sum(float(fleet.problems[m].program.cost @ z) for m, z in pairs)
    if verdict.certified <= fleet.scenario.risk_bound and cost < best.cost:
        best.controls, best.cost, best.sets, best.spent = controls, cost, found.sets, spent
        best.certified = verdict.certified
        fleet.known = fleet.parted(found.sets, points)
    return verdict
