"""The best certified plan of a fleet so far, and the lower bounds on its cost."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from radmpc.arrays import Matrix
from radmpc.planners.certified.fleet import Fleet
from radmpc.planners.draft import Step
from radmpc.solvers.solution import relative_gap

__all__ = ["SPENT", "FleetIncumbent"]

SPENT = 0.85
"""Share of Δ from which on the certificate counts as having used it up [-]."""


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
        if self.certified < SPENT * risk_bound:
            return 0.0 if self.union_bound < SPENT * fleet.most_budget else None
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
