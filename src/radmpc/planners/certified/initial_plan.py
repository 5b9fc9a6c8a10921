"""An initial plan of the whole fleet by a construction heuristic: one vehicle after the other."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from radmpc.planners.certified.fleet import Fleet
from radmpc.planners.certified.inter_set_risk import by_sets
from radmpc.planners.certified.lattice.passage import Passage
from radmpc.planners.certified.lattice.search import PathSearch
from radmpc.planners.certified.merging import Members, owners_of
from radmpc.planners.certified.state.search_state import SearchState
from radmpc.planners.certified.tuning import TUNING
from radmpc.planners.components import components
from radmpc.solvers.priced.neighborhood import Neighborhood, Seek
from radmpc.solvers.priced.nodes import Incumbent
from radmpc.solvers.priced.rating import Rater

__all__ = ["initial_plan"]

_TUNED = TUNING.sets


def initial_plan(
    fleet: Fleet, state: SearchState, sets: tuple[Members, ...]
) -> tuple[SearchState, tuple[tuple[Members, ...], tuple[Incumbent, ...]] | None]:
    """Plan vehicles that are in each other's way greedily, one after the other.

    Parameters
    ----------
    fleet : Fleet
        The fleet.
    state : SearchState
        With a plan of every vehicle alone, and the price.
    sets : tuple of tuple of int
        A partition; what was searched to the end stays as it is, unless others get in its way.

    Returns
    -------
    state : SearchState
        With the parts of the plan, and why vehicles were planned together.
    found : tuple of sets and plans, or None
        Sets between which the risk is negligible. None where no path was found for some vehicle.
    """
    if not state.is_planned(fleet.singles):
        return state, None
    alone = {m[0]: state.best(m).z for m in fleet.singles}
    plans: dict[Members, Incumbent] = {m: state.best(m) for m in fleet.singles}
    for members in sets:
        known = state.set_states[members]
        if known.best is not None and not known.is_limited:
            plans[members] = known.best
    sets = tuple(part for m in sets for part in ((m,) if m in plans else tuple((i,) for i in m)))
    for _ in range(_TUNED.merging_rounds):
        pair_risks = fleet.programs.pair_risks(sets, [plans[m].z for m in sets])
        pair_risks |= {pair: 1.0 for pair in state.merging.to_merge(sets)}
        set_risks = by_sets(pair_risks, owners_of(sets))
        merged = _merged_through_others(sets, set_risks, _TUNED.negligible * fleet.unit)
        if merged == sets:
            break
        state = replace(state, merging=state.merging.remember(sets, merged, pair_risks))
        sets = merged
        for members in sets:
            if members not in plans:
                weights = _weights(fleet, members, alone)
                plan = _planned_in_turn(fleet, state, members, alone, weights)
                if plan is None:
                    return state, None
                plans[members] = plan
    parts = fleet.programs.split(sets, [plans[m].z for m in sets])
    return replace(state, incumbent_parts=parts), (sets, tuple(plans[m] for m in sets))


def _merged_through_others(
    sets: tuple[Members, ...], set_risks: Mapping[tuple[int, int], float], least: float
) -> tuple[Members, ...]:
    """Merge all sets in each other's way, directly or through others: greedy plans are cheap."""
    pairs = [pair for pair, risk in set_risks.items() if risk > least]
    if not pairs:
        return sets
    groups = components(len(sets), pairs)
    return tuple(tuple(sorted(i for part in group for i in sets[part])) for group in groups)


def _weights(fleet: Fleet, members: Members, alone: Mapping[int, np.ndarray]) -> dict[int, float]:
    """Return the risk that each vehicle runs with others of its set if all are planned alone."""
    everyone = [alone[m[0]] for m in fleet.singles]
    weights = dict.fromkeys(members, 0.0)
    for (i, j), risk in fleet.programs.inter_set_risks(fleet.singles, everyone).items():
        if i in weights and j in weights:
            weights[i] += risk
            weights[j] += risk
    return weights


def _planned_in_turn(
    fleet: Fleet,
    state: SearchState,
    members: Members,
    alone: Mapping[int, np.ndarray],
    weights: Mapping[int, float],
) -> Incumbent | None:
    """Plan the vehicles of a set one after the other, those with most risk first."""
    problem = fleet.programs.problem(members)
    unit_price = state.unit_price
    if problem.rater.is_infeasible:
        return None
    values = [
        state.best((i,)).cost + unit_price * state.best((i,)).risk / fleet.unit for i in members
    ]
    move = max(float(np.abs(np.diff(s.reach_upper, axis=0)).max()) for s in problem.models)
    seek = _seek(fleet, members, unit_price)
    around = Neighborhood(
        problem.program, fleet.unit, unit_price, unit_price, fleet.limits, move, values, seek
    )
    order = sorted(range(len(members)), key=lambda block: -weights[members[block]])
    start = fleet.programs.assembled(members, alone)
    found = [around.place(start, order)]
    if found[0] is None and not fleet.limits.reached:
        found.append(around.place_greedily(start, order))
    known = state.hint(fleet, members)
    if known is not None:
        found.append(around.improve(known, [[block] for block in order]))
    plans = []
    for z in found:
        if z is not None:
            rating = problem.rater.rate(z)
            cost = float(problem.program.cost @ z)
            plans.append(Incumbent(z, rating.selection, cost, rating.risk))
    return min(plans, key=lambda i: i.cost + unit_price * i.risk / fleet.unit, default=None)


def _seek(fleet: Fleet, members: Members, unit_price: float) -> Seek:
    """Return the search for a path among vehicles that are placed, on a lattice of its own."""
    problem = fleet.programs.problem(members)

    def seek(rater: Rater, block: int, is_earliest: bool) -> Incumbent | None:
        if rater.is_infeasible:
            return None
        model = problem.models[block]
        first = block * model.drift_position.size
        alone = fleet.programs.problem((members[block],)).passage
        level = 0 if alone is None else alone.path_search.level
        path_search = PathSearch(
            rater.program, model, fleet.unit, first, level, is_coarse_only=True
        )
        if not path_search.is_possible:
            return None
        passage = Passage(path_search, rater)
        if is_earliest:
            return passage.earliest_plan(fleet.limits)
        return passage.plan(unit_price, unit_price, fleet.limits, None)

    return seek
