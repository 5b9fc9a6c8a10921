"""The best certified plan so far: fitted to what the referee finds, not to simple bounds."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np

from radmpc.arrays import Matrix, Vector
from radmpc.planners.certified.fitting import fitted
from radmpc.planners.certified.fleet import Fleet
from radmpc.planners.certified.rounds import Round
from radmpc.planners.draft import Step
from radmpc.solvers.solution import relative_gap

__all__ = ["Best", "RiskOf", "take"]

_FITS = 5
_SPENT = 0.85
"""Share of Δ from which on the referee's figure counts as used up."""

_AIM = 0.95
_BACK_OFF = 0.97
_STRETCH = 3.0
_CLOSE = 0.03
"""Relative difference below which two budgets are one."""

_NOTHING = 1e-300

RiskOf = Callable[[tuple[Matrix, ...]], float]
"""The referee's certificate of every vehicle's controls."""


@dataclass(slots=True, eq=False)
class Best:
    """The best certified plan so far, and what the rounds proved."""

    controls: tuple[Matrix, ...] = ()
    cost: float = float("inf")
    spent: float = 0.0
    certified: float = 0.0
    too_much: float = float("inf")
    has_failed: bool = False
    sets: tuple[tuple[int, ...], ...] = ()
    rounds: list[tuple[float, float]] = field(default_factory=list)
    steps: list[Step] = field(default_factory=list)

    def bound(self, fleet: Fleet) -> float:
        """Return the least cost of any plan whose simple bounds sum to no more than its own."""
        return self._bound(max(fleet.budget, self.spent) / fleet.unit)

    def reported(self, fleet: Fleet, gap: float) -> float:
        """Return a lower bound on the cost of any plan whose simple bounds sum to Δ at most.

        If the gap is closed, that of plans whose simple bounds sum to what this one's do: lower,
        and saying more.
        """
        bound = self.bound(fleet)
        if relative_gap(self.cost, bound) > gap:
            bound = self._bound((fleet.scenario.risk_bound - fleet.initial) / fleet.unit)
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
        units = max(fleet.budget, self.spent) / fleet.unit
        _, price = max(self.rounds, key=lambda found: found[0] - found[1] * units)
        return price / fleet.unit * self.spent / self.certified

    def _bound(self, units: float) -> float:
        """Return the least cost within a budget."""
        return max((least - price * units for least, price in self.rounds), default=-np.inf)


def take(fleet: Fleet, found: Round, best: Best, risk_of: RiskOf) -> None:
    """Keep a round's plan if it is certified and better than what there is.

    What simple bounds sum to and what the referee finds differ: fitted to more or less of the
    former, the sides of the round come to just below Δ by the latter.
    """
    granted = fleet.scenario.risk_bound
    budget, low, high = fleet.budget, 0.0, float("inf")
    cross, is_judged = found.cross, False
    for _ in range(_FITS):
        points = fitted(fleet, found, budget, cross)
        if points is None and high == float("inf"):
            granted_more = 0.0
            if not is_judged and not best.controls:
                granted_more = _left_by_referee(fleet, found, best, risk_of)
            if granted_more <= budget * (1.0 + _CLOSE):
                break
            is_judged, budget = True, granted_more
            continue
        if points is None:
            # Too little for these sides, and `high` too much.
            budget = 0.5 * (budget + high)
            continue
        risk = _keep(fleet, found, points, best, risk_of, budget)
        if risk > granted:
            high = min(high, budget)
            cross = 2.0 * cross + 0.02 * budget
        else:
            low = max(low, budget)
            if risk >= _SPENT * granted:
                break
        following = budget * min(_STRETCH, _AIM * granted / max(risk, _NOTHING))
        if low and high < float("inf"):
            following = (low * high) ** 0.5
        following = min(following, fleet.most_budget)
        if abs(following - budget) <= _CLOSE * budget:
            break
        budget = following
    best.has_failed = high < float("inf") and not low
    if low:
        fleet.set_budget(min(low, _BACK_OFF * best.too_much))
    elif best.has_failed:
        # The referee finds more in these sides: nearer to Δ, where it cannot.
        best.too_much = min(best.too_much, fleet.budget)
        # Where the starts alone run more by simple bounds, what is left is the referee's leave.
        nearer = max(granted - fleet.initial, _BACK_OFF * 0.25 * fleet.budget)
        fleet.set_budget(_BACK_OFF * (fleet.budget * nearer) ** 0.5)


def _left_by_referee(fleet: Fleet, found: Round, best: Best, risk_of: RiskOf) -> float:
    """Return what simple bounds may sum to, by what the referee finds in a round as it is."""
    spent = found.risk + found.cross
    raw = [plan.z for plan in found.plans]
    risk = _keep(fleet, found, raw, best, risk_of, spent)
    return min(spent * _AIM * fleet.scenario.risk_bound / max(risk, _NOTHING), fleet.most_budget)


def _keep(
    fleet: Fleet,
    found: Round,
    points: Sequence[Vector],
    best: Best,
    risk_of: RiskOf,
    spent: float,
) -> float:
    """Keep a plan if it is certified and the best; return what the referee says it risks."""
    controls = fleet.controls(found.sets, points)
    risk = risk_of(controls)
    pairs = zip(found.sets, points, strict=True)
    cost = sum(float(fleet.problems[m].program.cost @ z) for m, z in pairs)
    if risk <= fleet.scenario.risk_bound and cost < best.cost:
        best.controls, best.cost, best.sets, best.spent = controls, cost, found.sets, spent
        best.certified = risk
        fleet.known = fleet.parted(found.sets, points)
    return risk
