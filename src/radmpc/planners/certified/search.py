"""The search for the unit price of risk at which a fleet just uses its budget."""

from __future__ import annotations

import logging
import time
from dataclasses import dataclass, field

from radmpc.planners.certified.acceptance import accept_round
from radmpc.planners.certified.fleet import Fleet
from radmpc.planners.certified.incumbent import FleetIncumbent
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
"""Rounds at most [-]: a stop for risk that no price moves."""

_SEARCH_SHARE = 0.5
"""Share of the open gap that, left by the sets' own searches, calls for more nodes instead of
another price [-]."""

_MAX_INITIAL_PLANS = 8
"""Prices at which an initial plan is sought, at most [-]."""

_DOUBTFUL = 1e2
"""Multiple of the first price at which, without any plan, the search for the safest plan decides
whether there can be one [-]."""

_DEAREST = 1e7
"""Multiple of the first price that no price exceeds [-]: beyond it nothing changes."""

_FAR = 1.6
"""Multiple of the budget beyond which the initial plan is made again at a higher price [-]."""

_SAME = 1e-4
"""Relative difference below which two prices are one [-]."""

_STUBBORN = 1e-3
"""Relative difference below which two plans risk the same, whatever the price [-]."""

_NODES_WITHIN = 400
"""Nodes of a search within the budget, per vehicle of a set [-], multiplied by the effort."""

_MAX_WITHIN = 12
"""Budgets that are searched within, at most [-]."""

_AIM = 0.97
"""Share of Δ that the certificate is to come to at the next budget, and the factor by which a
rejected budget falls at least [-]."""

_SAME_BUDGET = 0.02
"""Relative difference below which two budgets are one [-]."""

_WORTHWHILE = 0.1
"""Share of the gap by which a search within the budget must gain to be done again [-]."""

_FINE = 2e-3
"""Gap to plans within the same budget that is small enough once the gap to those within Δ is
closed [-]."""


@dataclass(slots=True, eq=False)
class PriceSearch:
    """The search's state: it goes on from there when run again.

    Attributes
    ----------
    fleet : Fleet
        The fleet.
    incumbent : FleetIncumbent
        The best certified plan, and what is proven.
    gap : float
        The relative gap asked for [-].
    judge : callable
        The referee.
    tried : list of (float, float)
        Unit prices, and the risk at them [-].
    unit_price : float
        The next, cost of one unit of risk.
    effort : int
        Multiplies the nodes that every set gets [-].
    within : WithinBudget
        The search for where no price leads.
    """

    fleet: Fleet
    incumbent: FleetIncumbent
    gap: float
    judge: Judge
    tried: list[tuple[float, float]] = field(default_factory=list)
    unit_price: float = 0.0
    effort: int = 1
    within: WithinBudget = field(init=False)

    def __post_init__(self) -> None:
        """Make the search for where no price leads."""
        self.within = WithinBudget(self.fleet, self.incumbent, self.gap, self.judge)

    def run(self) -> None:
        """Plan the fleet at prices, until the gap is closed, or none can close it, or a limit.

        Without any plan it stops where none is likely to come of a higher price, and goes on from
        there when run again.
        """
        fleet, incumbent = self.fleet, self.incumbent
        if self.unit_price == 0.0:
            self.unit_price = price_alone(fleet, self.tried)
        for _ in range(_MAX_ROUNDS):
            began = time.perf_counter()
            candidate = run_round(fleet, self.unit_price, self.effort)
            if candidate is None:
                if fleet.limits.reached or fleet.without_plan() is not None:
                    return
                self.effort *= MORE_EFFORT
                continue
            incumbent.round_bounds.append((candidate.least, self.unit_price))
            has_merged = accept_round(fleet, candidate, incumbent, self.judge)
            incumbent.steps.append(_step(fleet, candidate, incumbent, time.perf_counter() - began))
            _tell(fleet, candidate, incumbent)
            if fleet.limits.reached or self._is_closed():
                return
            if has_merged:
                # What other sets risked says little of these.
                self.tried.clear()
                continue
            if candidate.is_initial:
                self._after_initial_plan(candidate)
            elif self._is_over(candidate):
                return

    def close(self, candidate: Round | None = None) -> None:
        """Search within the budget where prices leave a gap.

        Parameters
        ----------
        candidate : Round or None
            A plan of one set at a price that risks too much, where there is no other.
        """
        fleet, incumbent, within = self.fleet, self.incumbent, self.within
        risk_bound = fleet.scenario.risk_bound
        max_nodes = _NODES_WITHIN * self.effort
        budget = fleet.budget if candidate is not None else max(fleet.budget, incumbent.union_bound)
        passed, failed = 0.0, float("inf")
        for _ in range(_MAX_WITHIN):
            if fleet.limits.reached or self._is_proven():
                break
            sets, plans = incumbent.sets, within.plans()
            if not incumbent.controls and candidate is not None:
                sets, plans = candidate.sets, list(candidate.plans)
            cost, incumbent.first_certificate = incumbent.cost, 0.0
            is_limited = within.search(sets, plans, budget, max_nodes)
            if is_limited and len(sets) == 1:
                max_nodes *= MORE_EFFORT
            if incumbent.first_certificate > risk_bound:
                failed = min(failed, budget)
            elif incumbent.first_certificate > 0.0:
                passed = max(passed, budget)
            has_gained = incumbent.cost < cost - _WORTHWHILE * self.gap * abs(incumbent.cost)
            following = self._next_budget(budget, passed, failed)
            if failed == float("inf") and has_gained:
                following = max(fleet.budget, incumbent.union_bound)
            if abs(following - budget) <= _SAME_BUDGET * budget and not (is_limited or has_gained):
                break
            budget = following
        if incumbent.controls:
            fleet.set_budget(incumbent.union_bound)

    def _next_budget(self, budget: float, passed: float, failed: float) -> float:
        """Return the budget to search within next, given what the referee passed and rejected."""
        fleet, incumbent = self.fleet, self.incumbent
        least = fleet.least_budget
        if failed == float("inf"):
            return budget
        if passed > 0.0:
            return (passed * failed) ** 0.5 if passed < failed else passed
        if budget <= least * (1.0 + OVER):
            # The union bounds are the referee's, and what exceeds them is rounding.
            return least * (1.0 - 10.0 * OVER)
        share = (
            _AIM * fleet.scenario.risk_bound / incumbent.first_certificate
            if incumbent.first_certificate > 0.0
            else 1.0
        )
        return max(least, budget * min(_AIM, share))

    def _is_closed(self) -> bool:
        """Whether the gap is closed, to plans within the same budget or to all within Δ."""
        incumbent, gap = self.incumbent, self.gap
        open_gap = relative_gap(incumbent.cost, incumbent.bound(self.fleet))
        if open_gap <= gap:
            return True
        is_fine = open_gap <= max(gap, _FINE)
        # No plan within Δ by union bounds is cheaper; what a larger budget could still gain is
        # little, or rejected by the referee, or takes long.
        return self._is_proven() and (incumbent.has_failed or is_fine or self.effort > 1)

    def _is_proven(self) -> bool:
        """Whether no plan within Δ by union bounds is cheaper by more than the gap."""
        return (
            relative_gap(self.incumbent.cost, self.incumbent.reported_bound(self.fleet, self.gap))
            <= self.gap
        )

    def _after_initial_plan(self, candidate: Round) -> None:
        """Raise the price where the initial plan risks too much, before searching at length."""
        fleet = self.fleet
        if candidate.risk > OVERDRAWN * fleet.budget:
            self.tried.append((self.unit_price, candidate.risk))
            self.unit_price = next_price(self.tried, fleet.budget - candidate.inter_set_risk)
        # Far from the budget, make it again at the new price.
        is_near = bool(self.incumbent.controls) or candidate.risk <= _FAR * fleet.budget
        fleet.has_tried_initial_plan = is_near or len(self.tried) >= _MAX_INITIAL_PLANS

    def _is_over(self, candidate: Round) -> bool:
        """Choose price and effort of the next round; tell whether there is nothing to choose."""
        fleet, incumbent = self.fleet, self.incumbent
        if candidate.is_limited and candidate.open_gap > _SEARCH_SHARE * (
            incumbent.cost - incumbent.bound(fleet)
        ):
            # The searches leave more open than a better price could close.
            if self._is_proven():
                return True
            self.effort *= MORE_EFFORT
            return False
        self.tried.append((self.unit_price, candidate.risk))
        following = next_price(self.tried, fleet.budget - candidate.inter_set_risk)
        if self._is_at_jump(candidate):
            # No price leads to what lies between two plans of different alternatives.
            self.close(candidate)
            if incumbent.controls:
                return True
        first = fleet.first_unit_price()
        following = min(following, _DEAREST * first)
        is_same = abs(following - self.unit_price) <= _SAME * self.unit_price
        is_doubtful = not incumbent.controls and following > _DOUBTFUL * first
        self.unit_price = following
        if is_doubtful or (is_same and not candidate.is_limited):
            return True
        if is_same:
            self.effort *= MORE_EFFORT
        return False

    def _is_at_jump(self, candidate: Round) -> bool:
        """Whether one set's risk, above the budget, does not move with the price."""
        if len(candidate.sets) > 1 or candidate.is_limited or len(self.tried) < 2:
            return False
        (before, risk), (unit_price, same) = self.tried[-2:]
        return unit_price > before and same > self.fleet.budget and risk <= same * (1.0 + _STUBBORN)


def _tell(fleet: Fleet, candidate: Round, incumbent: FleetIncumbent) -> None:
    """Log a round."""
    step, plan = incumbent.steps[-1], "no plan yet"
    if incumbent.controls:
        plan = (
            f"best cost {incumbent.cost:.6g}, gap {100.0 * step.gap:.2g} %, certificate "
            f"{incumbent.certified:.3g} of risk bound {fleet.scenario.risk_bound:g}"
        )
    _LOG.info(
        "%s %d: %d sets, the largest of %d; 1 %% of the risk bound at a price of %.3g; union "
        "bounds sum to %.3g, up to %.3g allowed; %s; %.2f s",
        step.stage,
        step.iteration + 1,
        len(candidate.sets),
        max(len(members) for members in candidate.sets),
        candidate.unit_price / fleet.unit * 0.01 * fleet.scenario.risk_bound,
        candidate.risk + candidate.inter_set_risk,
        fleet.budget,
        plan,
        step.seconds,
    )


def _step(fleet: Fleet, candidate: Round, incumbent: FleetIncumbent, seconds: float) -> Step:
    """Return the record of a round."""
    plans = candidate.plans
    return Step(
        stage="initial" if candidate.is_initial else "round",
        vehicles=tuple(v.name for v in fleet.scenario.vehicles),
        iteration=len(incumbent.steps),
        cost=sum(plan.cost for plan in plans),
        num_active=0,
        num_chosen=sum(plan.selection.size for plan in plans),
        allocated=fleet.budget,
        used=candidate.risk + candidate.inter_set_risk,
        gap=relative_gap(incumbent.cost, incumbent.bound(fleet)),
        nodes=sum(fleet.states[m].nodes for m in candidate.sets if m in fleet.states),
        seconds=seconds,
    )
