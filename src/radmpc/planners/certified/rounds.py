"""One round: the fleet as sets, all searched at one price of risk and merged where they collide."""

from __future__ import annotations

from collections.abc import Sequence

from radmpc.planners.certified.fleet import Fleet
from radmpc.planners.certified.inter_set_risk import by_sets
from radmpc.planners.certified.merging import Members, owners_of
from radmpc.planners.certified.set_searches import solve_sets
from radmpc.planners.certified.state.search_state import SearchState
from radmpc.planners.certified.tuning import TUNING
from radmpc.records import dataclass, replace
from radmpc.solvers.priced.nodes import Incumbent

__all__ = ["Round", "merge_worst", "run_round"]

_TUNED = TUNING.sets

_NO_PRICE = 1e-200
"""Stands for a unit price of 0 where one divides by it."""


@dataclass(frozen=True, slots=True, eq=False)
class Round:
    """The fleet at one price: every set planned, none colliding with another.

    Attributes
    ----------
    sets : tuple of tuple of int
        A partition of the fleet.
    unit_price : float
        Cost of one unit of risk.
    plans : tuple of Incumbent
        The plan of each set.
    risk, inter_set_risk : float
        What the union bounds within the sets sum to, and an estimate of those between them [-].
    least : float
        Lower bound on cost plus priced risk of any plan of the fleet.
    open_gap : float
        What the sets' own searches leave between the values of plans and bounds.
    is_limited : bool
        Whether a limit ended any of them.
    is_initial : bool
        Whether it is the initial plan, made before the sets were searched to the end.
    """

    sets: tuple[Members, ...]
    unit_price: float
    plans: tuple[Incumbent, ...]
    risk: float
    inter_set_risk: float
    least: float
    open_gap: float
    is_limited: bool
    is_initial: bool = False


def run_round(fleet: Fleet, state: SearchState) -> tuple[SearchState, Round | None]:
    """Plan all sets at a price, merging those that collide.

    Parameters
    ----------
    fleet : Fleet
        The fleet.
    state : SearchState
        With the price, and the effort.

    Returns
    -------
    state : SearchState
        With the states of all sets that were met.
    found : Round or None
        None where a set has no plan, or a limit was reached before all had one. The first time
        that a set proves hard, the initial plan of the whole fleet: of a large one, what short
        searches found.
    """
    sets: tuple[Members, ...] = fleet.singles
    while True:
        state = solve_sets(fleet, state, sets, state.unit_price, state.effort)
        is_hard = not state.has_tried_initial_plan and state.is_hard(fleet, sets)
        is_trial = is_hard and fleet.is_large and state.is_planned(sets)
        if is_hard and not is_trial:
            state, initial = _initial_round(
                fleet, replace(state, has_tried_initial_plan=True), sets
            )
            if initial is not None:
                return state, initial
            state = solve_sets(fleet, state, sets, state.unit_price, state.effort)
        if not state.is_planned(sets):
            return state, None
        plans = [state.best(m) for m in sets]
        pair_risks = fleet.programs.pair_risks(sets, [plan.z for plan in plans])
        set_risks = by_sets(pair_risks, owners_of(sets))
        inter_set_risk = sum(set_risks.values())
        allowed = _allowed_inter_set_risk(fleet, state, plans)
        rejected = state.merging.to_merge(sets)
        if inter_set_risk <= allowed and not rejected:
            found = _round(fleet, state, sets, inter_set_risk)
            if is_trial and found.open_gap > fleet.gap * (found.least + found.open_gap):
                # Searching at length begins with these sets, at a price that suits them.
                return replace(state, has_tried_initial_plan=True), replace(found, is_initial=True)
            return state, found
        merged = merge_worst(sets, set_risks, allowed, by_sets(rejected, owners_of(sets)))
        merging = state.merging.remember(sets, merged, pair_risks | rejected)
        state = replace(state, merging=merging)
        sets = merged


def _round(
    fleet: Fleet, state: SearchState, sets: tuple[Members, ...], inter_set_risk: float
) -> Round:
    """Sum up the sets at a price."""
    plans = tuple(state.best(m) for m in sets)
    is_limited = any(state.set_states[m].is_limited for m in sets)
    least = sum(state.set_states[m].bound for m in sets)
    return _summed(
        fleet, Round(sets, state.unit_price, plans, 0.0, inter_set_risk, least, 0.0, is_limited)
    )


def _initial_round(
    fleet: Fleet, state: SearchState, sets: tuple[Members, ...]
) -> tuple[SearchState, Round | None]:
    """Return the initial plan of the whole fleet, if there is one."""
    from radmpc.planners.certified.initial_plan import initial_plan  # noqa: PLC0415 - hard sets

    state, initial_plans = initial_plan(fleet, state, sets)
    if initial_plans is None:
        return state, None
    initial_sets, plans = initial_plans
    inter_set_risk = sum(
        fleet.programs.inter_set_risks(initial_sets, [plan.z for plan in plans]).values()
    )
    least = sum(state.set_states[m].bound for m in sets)
    initial = Round(
        initial_sets, state.unit_price, plans, 0.0, inter_set_risk, least, 0.0, True, True
    )
    return state, _summed(fleet, initial)


def _summed(fleet: Fleet, candidate: Round) -> Round:
    """Fill in the risk and the open gap, which follow from the plans."""
    risk = sum(plan.risk for plan in candidate.plans)
    value = sum(plan.cost for plan in candidate.plans) + candidate.unit_price * risk / fleet.unit
    return replace(candidate, risk=risk, open_gap=value - candidate.least)


def _allowed_inter_set_risk(fleet: Fleet, state: SearchState, plans: Sequence[Incumbent]) -> float:
    """Return the risk between sets that takes a small share of the gap, and of the budget."""
    unit_price = state.unit_price
    cost = sum(plan.cost + unit_price * plan.risk / fleet.unit for plan in plans)
    return max(
        0.0,
        min(
            _TUNED.inter_set_gap_share * fleet.gap * cost / max(unit_price, _NO_PRICE) * fleet.unit,
            _TUNED.inter_set_budget_share * state.budget,
        ),
    )


def merge_worst(
    sets: tuple[Members, ...],
    set_risks: dict[tuple[int, int], float],
    allowed: float = 0.0,
    rejected: dict[tuple[int, int], float] | None = None,
) -> tuple[Members, ...]:
    """Merge the sets that are to be, and the worst others until little is left between sets.

    Parameters
    ----------
    sets : tuple of tuple of int
        A partition of the fleet.
    set_risks : dict of (int, int) to float
        Risk between sets, by their numbers, lower first [-].
    allowed : float
        What may be left [-].
    rejected : dict of (int, int) to float or None
        The same of sets that are merged whatever is left.

    Returns
    -------
    tuple of tuple of int
        A coarser partition: each set is merged with one other at most.
    """
    ranked = _worst_first(rejected or {})
    left = sum(set_risks.values())
    for pair, risk in _worst_first(set_risks):
        if left <= allowed:
            break
        left -= risk
        ranked.append((pair, risk))
    return _merged_two_by_two(sets, [pair for pair, _ in ranked])


def _worst_first(risks: dict[tuple[int, int], float]) -> list[tuple[tuple[int, int], float]]:
    """Return pairs with their risks, the greatest first."""
    return sorted(risks.items(), key=lambda item: (-item[1], item[0]))


def _merged_two_by_two(
    sets: Sequence[Members], pairs: Sequence[tuple[int, int]]
) -> tuple[Members, ...]:
    """Merge pairs of sets, in this order, each set once at most: few merges may be enough."""
    taken: set[int] = set()
    result = []
    for i, j in pairs:
        if i not in taken and j not in taken:
            taken |= {i, j}
            result.append(tuple(sorted(sets[i] + sets[j])))
    return (*result, *(m for i, m in enumerate(sets) if i not in taken))
