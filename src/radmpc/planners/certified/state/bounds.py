"""What the rounds of a search prove: lower bounds on the cost, and the shadow price of Δ."""

from __future__ import annotations

import numpy as np

from radmpc.planners.certified.fleet import Fleet
from radmpc.planners.certified.state.search_state import SearchState
from radmpc.planners.certified.tuning import TUNING
from radmpc.solvers.solution import relative_gap

__all__ = [
    "bound_of_programs",
    "bound_on_cost",
    "finite",
    "is_proven",
    "is_told",
    "reported_bound",
    "shadow_price",
]

_TUNED = TUNING.budgets

_FREE = 1e-6
"""Share of its cost by which a plan may exceed what it costs in empty space for nothing to be saved
by more risk [-]: the tolerance of linear programs."""


def bound_on_cost(fleet: Fleet, state: SearchState) -> float:
    """Return a lower bound on the cost of any plan within the incumbent's budget or the fleet's.

    Parameters
    ----------
    fleet : Fleet
        The fleet.
    state : SearchState
        What is known of it.
    """
    return _bound_within(fleet, state, max(state.budget, state.incumbent.union_bound))


def reported_bound(fleet: Fleet, state: SearchState, gap: float) -> float:
    """Return a lower bound on the cost of any plan whose union bounds sum to Δ at most.

    Programs keep to polytopes within limits of norms: what they prove does not count there.

    Parameters
    ----------
    fleet, state, gap
        As in `bound_of_programs`.

    Returns
    -------
    float
        As there.
    """
    if not fleet.keeps_norms:
        return bound_of_programs(fleet, state, gap)
    bounds = [bound for _, bound in state.outside_bounds]
    return min(max(bounds, default=-np.inf), state.incumbent.cost)


def bound_of_programs(fleet: Fleet, state: SearchState, gap: float) -> float:
    """Return a lower bound on the cost of any plan of the programs within Δ by union bounds.

    If the gap is closed, that of all plans whose union bounds sum to no more than the incumbent's:
    it is lower and holds for more plans.

    Parameters
    ----------
    fleet : Fleet
        The fleet.
    state : SearchState
        What is known of it.
    gap : float
        The relative gap asked for [-].

    Returns
    -------
    float
        No more than the cost of the incumbent; -inf where nothing is proven.
    """
    cost = state.incumbent.cost
    bound = bound_on_cost(fleet, state)
    left = fleet.scenario.risk_bound - fleet.initial
    if relative_gap(cost, bound) > gap and left > 0.0:
        bound = _bound_within(fleet, state, left)
    return min(bound, cost)


def finite(bound: float) -> float | None:
    """Return a lower bound on a cost, 0 at least; None where nothing is proven.

    Parameters
    ----------
    bound : float
        Of a cost; -inf where nothing is proven.
    """
    return max(bound, 0.0) if np.isfinite(bound) else None


def is_proven(fleet: Fleet, state: SearchState) -> bool:
    """Whether no plan of the programs within Δ by union bounds is cheaper by more than the gap.

    Parameters
    ----------
    fleet : Fleet
        The fleet.
    state : SearchState
        What is known of it.
    """
    bound = bound_of_programs(fleet, state, fleet.gap)
    return relative_gap(state.incumbent.cost, bound) <= fleet.gap


def is_told(fleet: Fleet, state: SearchState, on_any: float = -np.inf) -> bool:
    """Whether what is told of plans by faces, or of any, is within the gap asked for.

    Parameters
    ----------
    fleet : Fleet
        The fleet.
    state : SearchState
        With a plan.
    on_any : float
        What any certified plan costs at least.
    """
    bound = max(reported_bound(fleet, state, fleet.gap), on_any)
    return relative_gap(state.incumbent.cost, bound) <= fleet.gap


def shadow_price(fleet: Fleet, state: SearchState) -> float | None:
    """Return what a little more Δ would save, per unit of probability; None if unknown.

    The union bounds may sum to more in proportion to Δ, and what that saves is the price of the
    round with the best bound. Where the plan leaves much of Δ unused, Δ is not what limits it.

    Parameters
    ----------
    fleet : Fleet
        The fleet.
    state : SearchState
        What is known of it.

    Returns
    -------
    float or None
        The shadow price of Δ.
    """
    incumbent, risk_bound = state.incumbent, fleet.scenario.risk_bound
    is_least = relative_gap(incumbent.cost, float(sum(fleet.base))) <= _FREE
    if not incumbent.controls or (incumbent.certified <= 0.0 and not is_least):
        return None
    if is_least:
        return 0.0
    if incumbent.certified < _TUNED.spent * risk_bound:
        # Turned at a price at which Δ is worth much, a plan says nothing of a lower one.
        worth = (incumbent.turned_price or 0.0) * risk_bound
        is_dear = incumbent.union_bound <= 0.0 and worth > fleet.gap * incumbent.cost
        is_free = incumbent.union_bound < _TUNED.spent * fleet.most_budget and not is_dear
        return 0.0 if is_free else None
    if incumbent.turned_price is not None:
        return incumbent.turned_price
    if not state.round_bounds:
        return None
    units = max(state.budget, incumbent.union_bound) / fleet.unit
    _, unit_price = max(state.round_bounds, key=lambda bound: bound[0] - bound[1] * units)
    return unit_price / fleet.unit * incumbent.union_bound / incumbent.certified


def _bound_within(fleet: Fleet, state: SearchState, budget: float) -> float:
    """Return the least cost within a budget."""
    bounds = [least - unit_price * budget / fleet.unit for least, unit_price in state.round_bounds]
    known = (*state.budget_bounds, *state.outside_bounds)
    bounds += [bound for most, bound in known if budget <= most * (1.0 + 1e-12)]
    return max(bounds, default=-np.inf)
