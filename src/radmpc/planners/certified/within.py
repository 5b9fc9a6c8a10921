"""The cheapest plan within a budget, where no price of risk leads to it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from radmpc.arrays import Matrix
from radmpc.planners.certified.best import Best, take
from radmpc.planners.certified.fleet import Fleet, Members
from radmpc.planners.certified.polish import repriced
from radmpc.planners.certified.problem import SetProblem
from radmpc.planners.certified.rounds import Round
from radmpc.planners.certified.verdict import Judge
from radmpc.solvers.risk_budget import BudgetTree
from radmpc.solvers.risk_nodes import Frontier, Incumbent
from radmpc.solvers.risk_rating import Rater

__all__ = ["take_sides", "take_within"]

_INF = float("inf")
_TIE = 0.05
"""Share of the gap that the whole budget costs: enough to prefer less risk at equal effort."""

_SHARE = 0.5
"""Share of the gap that the search may use."""

_BISECTIONS = 14
_CHEAPEST, _DEAREST = 1e-3, 1e5
"""Multiples of the first price between which given sides are priced."""


def take_sides(
    fleet: Fleet,
    best: Best,
    judge: Judge,
    sets: tuple[Members, ...],
    controls: tuple[Matrix, ...],
) -> None:
    """Keep the cheapest plan that passes everything on the sides of a given one.

    Parameters
    ----------
    fleet : Fleet
        The fleet.
    best : Best
        Where the plan is kept, if it is certified.
    judge : callable
        The referee.
    sets : tuple of tuple of int
        Who was planned together in the given plan.
    controls : tuple of (T, m) array
        Its controls, in the scenario's order.
    """
    plans = tuple(_incumbent(fleet.problem(m), [controls[i] for i in m]) for m in sets)
    cross = sum(fleet.crossing(sets, [plan.z for plan in plans]).values())
    price = fleet.first_price()
    given = _round(sets, price, plans, cross)
    take(fleet, given, best, judge)
    low, high = _CHEAPEST * price, _DEAREST * price
    chosen = None
    for _ in range(_BISECTIONS):
        if fleet.limits.reached:
            break
        price = (low * high) ** 0.5
        priced = tuple(
            repriced(fleet.problems[m], plan, fleet.unit, price, fleet.limits)
            for m, plan in zip(sets, plans, strict=True)
        )
        if sum(plan.risk for plan in priced) + cross <= fleet.budget:
            high, chosen = price, _round(sets, price, priced, cross)
        else:
            low = price
    if chosen is not None:
        take(fleet, chosen, best, judge)


def take_within(fleet: Fleet, best: Best, gap: float, judge: Judge, max_nodes: int) -> None:
    """Improve the best plan within what its simple bounds may sum to, one set after the other.

    Where the whole fleet is one set, what is found is the best, and its bound that of any plan.

    Parameters
    ----------
    fleet : Fleet
        The fleet.
    best : Best
        The best plan so far, which there must be.
    gap : float
        Relative gap asked for.
    judge : callable
        The referee.
    max_nodes : int
        Nodes per vehicle of a set.
    """
    sets = best.sets
    plans = [_incumbent(fleet.problem(m), [best.controls[i] for i in m]) for m in sets]
    cross = sum(fleet.crossing(sets, [plan.z for plan in plans]).values())
    budget = max(fleet.budget, best.spent) - cross
    for number, members in enumerate(sets):
        if fleet.limits.reached:
            return
        left = budget - sum(p.risk for p in plans) + plans[number].risk
        problem = fleet.problems[members]
        if left <= 0.0 or problem.program.num_avoidances == 0:
            continue
        scale = max(plans[number].cost, 1e-6)
        price = _TIE * gap * scale
        tree = BudgetTree(
            problem.program,
            left,
            price,
            gap=_SHARE * gap,
            scale=scale,
            limits=fleet.limits,
            rater=Rater(problem.program, left),
        )
        tree.resume(_frontier(fleet, members, left), price, None)
        tree.consider(plans[number].z)
        tree.run(max_nodes * len(members))
        if len(sets) == 1 and tree.best is not None:
            best.within.append((left, tree.bound - price))
        if tree.best is not None and tree.best.cost < plans[number].cost:
            plans[number] = tree.best
    price = best.rounds[-1][1] if best.rounds else fleet.first_price()
    take(fleet, _round(sets, price, plans, cross), best, judge)


def _round(
    sets: tuple[Members, ...], price: float, plans: Sequence[Incumbent], cross: float
) -> Round:
    """Return plans of sets as a round that proves nothing."""
    risk = sum(plan.risk for plan in plans)
    return Round(sets, price, tuple(plans), risk, cross, -_INF, _INF, is_limited=True)


def _incumbent(problem: SetProblem, controls: Sequence[Matrix]) -> Incumbent:
    """Return a set's controls as a plan of its programme."""
    halves = [(np.maximum(u, 0.0).ravel(), np.maximum(-u, 0.0).ravel()) for u in controls]
    z = np.concatenate([half for pair in halves for half in pair])
    rating = problem.rater.rate(z)
    return Incumbent(z, rating.selection, float(problem.program.cost @ z), rating.risk)


def _frontier(fleet: Fleet, members: Members, budget: float) -> Frontier:
    """Return what the search at a price left open, with bounds on cost alone within a budget."""
    state = fleet.states.get(members)
    if state is None or not state.frontier:
        return ((-_INF, ()),)
    paid = state.price * budget / fleet.unit
    return tuple((bound - paid, chosen) for bound, chosen in state.frontier)
