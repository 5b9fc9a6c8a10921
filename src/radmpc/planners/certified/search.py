"""The search for the price at which a fleet just uses its budget of risk."""

from __future__ import annotations

import logging
import time
from dataclasses import dataclass, field

from radmpc.planners.certified.fleet import Fleet
from radmpc.planners.certified.incumbent import Best, take
from radmpc.planners.certified.pricing import MORE_EFFORT, OVERDRAWN, next_price, price_alone
from radmpc.planners.certified.rounds import Round, run_round
from radmpc.planners.certified.within_budget import WithinBudget
from radmpc.planners.draft import Step
from radmpc.planners.verdict import Judge
from radmpc.solvers.priced.budget import OVER
from radmpc.solvers.solution import relative_gap

__all__ = ["PriceSearch"]

_LOG = logging.getLogger(__name__)

_MAX_ROUNDS = 40
_SEARCH_SHARE = 0.5
_MAX_SKETCHES = 8
_DOUBTFUL = 1e2
"""Multiple of the first price at which, without any plan, the bound itself is doubted: the safest
plan tells."""

_DEAREST = 1e7
"""Multiple of the first price beyond which a price changes nothing any more."""

_FAR = 1.6
"""Multiple of the budget beyond which a sketch is drawn again."""

_SAME = 1e-4
"""Relative difference below which two prices are one."""

_STUBBORN = 1e-3
"""Relative difference below which two plans risk the same, whatever the price."""

_NODES_WITHIN = 400
"""Nodes per vehicle of a set, and effort, of a search within the budget."""

_MAX_WITHIN = 12
_AIM = 0.97
_SAME_BUDGET = 0.02
"""Relative difference below which two budgets are one."""

_WORTHWHILE = 0.1
"""Share of the gap by which a search within the budget must gain to be done again."""

_FINE = 2e-3
"""Gap to plans that spend as much that is small enough once Δ itself is proven."""


@dataclass(slots=True, eq=False)
class PriceSearch:
    """The search's state: it goes on from there when run again.

    Attributes
    ----------
    fleet : Fleet
        The fleet.
    best : Best
        What was found.
    gap : float
        The relative gap asked for.
    judge : callable
        The referee.
    tried : list of (float, float)
        Prices, and the risk at them.
    price : float
        The next.
    effort : int
        Multiplies the nodes that every set gets.
    """

    fleet: Fleet
    best: Best
    gap: float
    judge: Judge
    tried: list[tuple[float, float]] = field(default_factory=list)
    price: float = 0.0
    effort: int = 1
    within: WithinBudget = field(init=False)

    def __post_init__(self) -> None:
        """Make the search for where no price leads."""
        self.within = WithinBudget(self.fleet, self.best, self.gap, self.judge)

    def run(self) -> None:
        """Plan the fleet at prices, until the gap is closed, or none can close it, or a limit.

        Without any plan it stops where none is likely to come of a higher price, and goes on from
        there when run again.
        """
        fleet, best = self.fleet, self.best
        if self.price == 0.0:
            self.price = price_alone(fleet, self.tried)
        for _ in range(_MAX_ROUNDS):
            began = time.perf_counter()
            found = run_round(fleet, self.price, self.effort)
            if found is None:
                if fleet.limits.reached or fleet.without_plan() is not None:
                    return
                self.effort *= MORE_EFFORT
                continue
            best.rounds.append((found.least, self.price))
            has_merged = take(fleet, found, best, self.judge)
            best.steps.append(_step(fleet, found, best, time.perf_counter() - began))
            _tell(fleet, found, best)
            if fleet.limits.reached or self._is_closed():
                return
            if has_merged:
                # What other sets risked says little of these.
                self.tried.clear()
                continue
            if found.is_sketch:
                self._after_sketch(found)
            elif self._is_over(found):
                return

    def close(self, found: Round | None = None) -> None:
        """Search within the budget where prices leave a gap.

        Parameters
        ----------
        found : Round or None
            A plan of one set at a price that risks too much, where there is no other.
        """
        fleet, best, within = self.fleet, self.best, self.within
        granted = fleet.scenario.risk_bound
        max_nodes = _NODES_WITHIN * self.effort
        budget = fleet.budget if found is not None else max(fleet.budget, best.spent)
        passed, failed = 0.0, float("inf")
        for _ in range(_MAX_WITHIN):
            if fleet.limits.reached or self._is_proven():
                break
            sets, plans = best.sets, within.plans()
            if not best.controls and found is not None:
                sets, plans = found.sets, list(found.plans)
            cost, best.asked = best.cost, 0.0
            is_limited = within.search(sets, plans, budget, max_nodes)
            if is_limited and len(sets) == 1:
                max_nodes *= MORE_EFFORT
            if best.asked > granted:
                failed = min(failed, budget)
            elif best.asked > 0.0:
                passed = max(passed, budget)
            has_gained = best.cost < cost - _WORTHWHILE * self.gap * abs(best.cost)
            following = self._next_budget(budget, passed, failed)
            if failed == float("inf") and has_gained:
                following = max(fleet.budget, best.spent)
            if abs(following - budget) <= _SAME_BUDGET * budget and not (is_limited or has_gained):
                break
            budget = following
        if best.controls:
            fleet.set_budget(best.spent)

    def _next_budget(self, budget: float, passed: float, failed: float) -> float:
        """Return what to search within next, given what the referee passed and what it failed."""
        fleet, best = self.fleet, self.best
        least = fleet.least_budget
        if failed == float("inf"):
            return budget
        if passed > 0.0:
            return (passed * failed) ** 0.5 if passed < failed else passed
        if budget <= least * (1.0 + OVER):
            # The simple bounds are the referee's, and what exceeds them is rounding.
            return least * (1.0 - 10.0 * OVER)
        share = _AIM * fleet.scenario.risk_bound / best.asked if best.asked > 0.0 else 1.0
        return max(least, budget * min(_AIM, share))

    def _is_closed(self) -> bool:
        """Whether the gap is closed, to plans that spend as much or to all within Δ."""
        best, gap = self.best, self.gap
        open_gap = relative_gap(best.cost, best.bound(self.fleet))
        if open_gap <= gap:
            return True
        is_fine = open_gap <= max(gap, _FINE)
        # No plan within Δ by simple bounds is cheaper; what spending more of the referee's leave
        # could still gain is little, or out of its leave, or dear.
        return self._is_proven() and (best.has_failed or is_fine or self.effort > 1)

    def _is_proven(self) -> bool:
        """Whether no plan within Δ by simple bounds is cheaper by more than the gap."""
        return relative_gap(self.best.cost, self.best.reported(self.fleet, self.gap)) <= self.gap

    def _after_sketch(self, found: Round) -> None:
        """Raise the price where the sketch risks too much, before searching at length."""
        fleet = self.fleet
        if found.risk > OVERDRAWN * fleet.budget:
            self.tried.append((self.price, found.risk))
            self.price = next_price(self.tried, fleet.budget - found.cross)
        # Far from any plan draw again, at the new price.
        is_near = bool(self.best.controls) or found.risk <= _FAR * fleet.budget
        fleet.is_sketched = is_near or len(self.tried) >= _MAX_SKETCHES

    def _is_over(self, found: Round) -> bool:
        """Choose price and effort of the next round; tell whether there is nothing to choose."""
        fleet, best = self.fleet, self.best
        if found.is_limited and found.open_gap > _SEARCH_SHARE * (best.cost - best.bound(fleet)):
            # The searches leave more open than a better price could close.
            if self._is_proven():
                return True
            self.effort *= MORE_EFFORT
            return False
        self.tried.append((self.price, found.risk))
        following = next_price(self.tried, fleet.budget - found.cross)
        if self._is_at_jump(found):
            # No price leads to what lies between two plans of different sides.
            self.close(found)
            if best.controls:
                return True
        first = fleet.first_price()
        following = min(following, _DEAREST * first)
        is_same = abs(following - self.price) <= _SAME * self.price
        is_doubtful = not best.controls and following > _DOUBTFUL * first
        self.price = following
        if is_doubtful or (is_same and not found.is_limited):
            return True
        if is_same:
            self.effort *= MORE_EFFORT
        return False

    def _is_at_jump(self, found: Round) -> bool:
        """Whether one set's risk, above the budget, does not move with the price."""
        if len(found.sets) > 1 or found.is_limited or len(self.tried) < 2:
            return False
        (before, risk), (price, same) = self.tried[-2:]
        return price > before and same > self.fleet.budget and risk <= same * (1.0 + _STUBBORN)


def _tell(fleet: Fleet, found: Round, best: Best) -> None:
    """Log a round."""
    step, plan = best.steps[-1], "no plan yet"
    if best.controls:
        plan = (
            f"best cost {best.cost:.6g}, gap {100.0 * step.gap:.2g} %, certificate "
            f"{best.certified:.3g} of risk bound {fleet.scenario.risk_bound:g}"
        )
    _LOG.info(
        "%s %d: %d sets, the largest of %d; 1 %% of the risk bound at a price of %.3g; simple "
        "bounds sum to %.3g, up to %.3g allowed; %s; %.2f s",
        step.stage,
        step.iteration + 1,
        len(found.sets),
        max(len(members) for members in found.sets),
        found.price / fleet.unit * 0.01 * fleet.scenario.risk_bound,
        found.risk + found.cross,
        fleet.budget,
        plan,
        step.seconds,
    )


def _step(fleet: Fleet, found: Round, best: Best, seconds: float) -> Step:
    """Return the record of a round."""
    plans = found.plans
    return Step(
        stage="sketch" if found.is_sketch else "round",
        vehicles=tuple(v.name for v in fleet.scenario.vehicles),
        iteration=len(best.steps),
        cost=sum(plan.cost for plan in plans),
        num_active=0,
        num_chosen=sum(plan.selection.size for plan in plans),
        allocated=fleet.budget,
        used=found.risk + found.cross,
        gap=relative_gap(best.cost, best.bound(fleet)),
        nodes=sum(fleet.states[m].nodes for m in found.sets if m in fleet.states),
        seconds=seconds,
    )
