"""Which price of risk to try next: the search for the multiplier of the risk budget.

Prices are those of one unit of risk; `fleet` defines the unit.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from radmpc.planners.certified.fleet import Fleet
from radmpc.planners.certified.repair import repriced
from radmpc.planners.certified.set_searches import solve_sets
from radmpc.planners.certified.state.search_state import SearchState
from radmpc.planners.certified.tuning import TUNING

__all__ = ["next_price", "price_alone"]

_TUNED = TUNING.prices


def price_alone(fleet: Fleet, state: SearchState) -> SearchState:
    """Return a price at which vehicles that ignore each other do not exceed the budget by far.

    Parameters
    ----------
    fleet : Fleet
        The fleet.
    state : SearchState
        Of a search that has not begun.

    Returns
    -------
    SearchState
        With the unit price to begin with; every vehicle was searched alone.
    """
    unit_price = fleet.first_unit_price(state.budget)
    # Where the chosen alternatives risk too much at any price, others are needed, not a higher one.
    most = _TUNED.dearest_alone * unit_price
    state = solve_sets(fleet, state, fleet.singles, unit_price, 1, is_rough=True)
    effort = 1
    while missing := [m for m in fleet.singles if state.set_states[m].best is None]:
        if fleet.limits.reached or state.without_plan() is not None or effort > _TUNED.most_effort:
            return replace(state, unit_price=unit_price)
        effort *= _TUNED.more_effort
        state = solve_sets(fleet, state, missing, unit_price, effort)
    tried: list[tuple[float, float]] = []
    plans = [state.best(m) for m in fleet.singles]
    for _ in range(_TUNED.max_prices_alone):
        risk = sum(plan.risk for plan in plans)
        if risk <= _TUNED.overdrawn * state.budget or fleet.limits.reached:
            break
        tried.append((unit_price, risk))
        unit_price = min(next_price(tried, state.budget), most)
        # With the alternatives chosen so far: no need to search for others yet.
        plans = [
            repriced(fleet.programs.problem(m), plan, fleet.unit, unit_price, fleet.limits)
            if plan.risk > _TUNED.little * fleet.unit
            else plan
            for m, plan in zip(fleet.singles, plans, strict=True)
        ]
    return replace(state, unit_price=unit_price)


def next_price(tried: Sequence[tuple[float, float]], budget: float) -> float:
    """Return the price at which the budget is expected to be just used.

    Risk falls roughly in proportion to its price; between two prices on both sides of the budget,
    along a straight line in logarithms. Risk that no price moves would drive it without end: from
    some multiple of the first price on, it stays.

    Parameters
    ----------
    tried : sequence of (float, float)
        Prices, all in the same scale, and the risk at them [-]; the last one last.
    budget : float
        What may be risked [-].

    Returns
    -------
    float
        A price in the scale of those tried; the last one where it is right.
    """
    # Of a price of nothing there is no multiple.
    tried = [one for one in tried if one[0] > 0.0] or tried
    unit_price, risk = tried[-1]
    most = _TUNED.dearest_step * tried[0][0]
    if 0.0 <= 1.0 - risk / budget <= _TUNED.unused:
        return unit_price
    budget *= 1.0 - 0.5 * _TUNED.unused
    above = [(p, r) for p, r in tried if r > budget]
    below = [(p, r) for p, r in tried if 0.0 < r <= budget]
    if above and below:
        (p1, r1), (p2, r2) = max(above), min(below)
        if p1 < p2 and r1 > r2:
            share = np.log(r1 / budget) / np.log(r1 / r2)
            # A jump of the risk between them draws all prices to one side: keep off the ends.
            return float(p1 * (p2 / p1) ** np.clip(share, 0.15, 0.85))
    step = _TUNED.steepness * float(np.log(max(risk / budget, 1e-12)))
    step *= _stubbornness(tried, step)
    return float(min(unit_price * np.clip(np.exp(step), 0.2, 5.0), max(most, unit_price)))


def _stubbornness(tried: Sequence[tuple[float, float]], step: float) -> float:
    """Return by how much to lengthen a step in the logarithm of the price, at least 1.

    Where the last step moved the risk less than in proportion, the next is up to twice as long:
    risk that no small change of price moves would else be followed in ever equal little steps.
    """
    if len(tried) < 2 or step == 0.0:
        return 1.0
    (before, risk_before), (unit_price, risk) = tried[-2:]
    last = float(np.log(unit_price / before))
    if last * step <= 0.0:
        return 1.0
    fall = max(risk / risk_before, 1e-12) if risk_before > 0.0 else 1.0
    slope = -float(np.log(fall)) / last if risk_before > 0.0 else 1.0
    target = 1.0 / max(slope * _TUNED.steepness, 1e-3)
    return float(np.clip(target, 1.0, max(1.0, 2.0 * abs(last / step))))
