"""One round: the fleet as sets, all searched at one price of risk and merged where they collide."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from radmpc.planners.certified.fleet import Fleet, Members
from radmpc.planners.certified.initial_plan import sketch
from radmpc.planners.certified.inter_set_risk import by_sets
from radmpc.solvers.priced.nodes import Incumbent

__all__ = ["Round", "run_round"]

_CROSS_SHARE = 0.1
"""Share of the gap that risk between sets may cost before they are merged."""

_NO_PRICE = 1e-200

_CROSS_BUDGET = 0.2
"""Share of the budget that risk between sets may take before they are merged."""


@dataclass(frozen=True, slots=True, eq=False)
class Round:
    """The fleet at one price: every set planned, none colliding with another.

    Attributes
    ----------
    sets : tuple of tuple of int
        A partition of the fleet.
    price : float
        Price of a unit of risk.
    plans : tuple of Incumbent
        The plan of each set.
    risk, cross : float
        What the sets run within, and about what they run between them.
    least : float
        Lower bound on cost and priced risk of any plan of the fleet.
    open_gap : float
        What the sets' own searches leave between plans and bounds.
    is_limited : bool
        Whether a limit ended any of them.
    is_sketch : bool
        Whether it was made in a hurry, before the sets were searched.
    """

    sets: tuple[Members, ...]
    price: float
    plans: tuple[Incumbent, ...]
    risk: float
    cross: float
    least: float
    open_gap: float
    is_limited: bool
    is_sketch: bool = False


def run_round(fleet: Fleet, price: float, effort: int) -> Round | None:
    """Plan all sets at a price, merging those that collide.

    Parameters
    ----------
    fleet : Fleet
        The fleet.
    price : float
        Of one unit of risk.
    effort : int
        Multiplies the nodes that every set gets.

    Returns
    -------
    Round or None
        None where a set has no plan, or a limit was reached before all had one. The first time
        that a set proves hard, a plan of the whole fleet made in a hurry.
    """
    sets: tuple[Members, ...] = fleet.singles
    while True:
        has_plans = fleet.solve(sets, price, effort)
        if not fleet.is_sketched and fleet.is_hard(sets):
            fleet.is_sketched = True
            sketched = _sketched(fleet, sets, price)
            if sketched is not None:
                return sketched
            has_plans = fleet.solve(sets, price, effort)
        if not has_plans:
            return None
        plans = [fleet.best(m) for m in sets]
        meetings = fleet.meetings(sets, [plan.z for plan in plans])
        crossing = by_sets(meetings, fleet.owners(sets))
        cross = sum(crossing.values())
        allowed = _allowed_cross(fleet, plans, price)
        blamed = fleet.to_merge(sets)
        if cross <= allowed and not blamed:
            return _round(fleet, sets, price, cross)
        ranked = _worst_first(by_sets(blamed, fleet.owners(sets)))
        for pair, risk in _worst_first(crossing):
            if cross <= allowed:
                break
            cross -= risk
            ranked.append((pair, risk))
        merged = _merged(sets, [pair for pair, _ in ranked])
        fleet.remember(sets, merged, meetings | blamed)
        sets = merged


def _round(fleet: Fleet, sets: tuple[Members, ...], price: float, cross: float) -> Round:
    """Sum up the sets at a price."""
    plans = tuple(fleet.best(m) for m in sets)
    is_limited = any(fleet.states[m].is_limited for m in sets)
    least = sum(fleet.states[m].bound for m in sets)
    return _summed(fleet, Round(sets, price, plans, 0.0, cross, least, 0.0, is_limited))


def _sketched(fleet: Fleet, sets: tuple[Members, ...], price: float) -> Round | None:
    """Return a plan of the whole fleet made in a hurry, if there is one."""
    drawn = sketch(fleet, sets, price)
    if drawn is None:
        return None
    drawn_sets, plans = drawn
    cross = sum(fleet.crossing(drawn_sets, [plan.z for plan in plans]).values())
    least = sum(fleet.states[m].bound for m in sets)
    return _summed(fleet, Round(drawn_sets, price, plans, 0.0, cross, least, 0.0, True, True))


def _summed(fleet: Fleet, found: Round) -> Round:
    """Fill in what follows from the plans."""
    risk = sum(plan.risk for plan in found.plans)
    value = sum(plan.cost for plan in found.plans) + found.price * risk / fleet.unit
    return replace(found, risk=risk, open_gap=value - found.least)


def _allowed_cross(fleet: Fleet, plans: Sequence[Incumbent], price: float) -> float:
    """Return the risk between sets that costs a small share of the gap, and of the budget."""
    cost = sum(plan.cost + price * plan.risk / fleet.unit for plan in plans)
    return max(
        0.0,
        min(
            _CROSS_SHARE * fleet.gap * cost / max(price, _NO_PRICE) * fleet.unit,
            _CROSS_BUDGET * fleet.budget,
        ),
    )


def _worst_first(risks: dict[tuple[int, int], float]) -> list[tuple[tuple[int, int], float]]:
    """Return pairs with their risks, the greatest first."""
    return sorted(risks.items(), key=lambda item: (-item[1], item[0]))


def _merged(sets: Sequence[Members], pairs: Sequence[tuple[int, int]]) -> tuple[Members, ...]:
    """Merge pairs of sets, in this order, each at most once."""
    taken: set[int] = set()
    result = []
    for i, j in pairs:
        if i not in taken and j not in taken:
            taken |= {i, j}
            result.append(tuple(sorted(sets[i] + sets[j])))
    return (*result, *(m for i, m in enumerate(sets) if i not in taken))
