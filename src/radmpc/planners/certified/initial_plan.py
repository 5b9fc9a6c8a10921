"""A plan of the whole fleet in a hurry: tangled vehicles one after the other."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from radmpc.planners.certified.fleet import Fleet, Members
from radmpc.planners.certified.inter_set_risk import by_sets
from radmpc.planners.certified.lattice.passage import Passage
from radmpc.planners.certified.lattice.search import Walk
from radmpc.planners.components import components
from radmpc.solvers.priced.neighborhood import Neighborhood, Seek
from radmpc.solvers.priced.nodes import Incumbent
from radmpc.solvers.priced.rating import Rater

__all__ = ["sketch"]

_ROUNDS = 8
_NEGLIGIBLE = 1e-3
"""Share of the unit that risk between two vehicles may take before they are replanned."""


def sketch(
    fleet: Fleet, sets: tuple[Members, ...], price: float
) -> tuple[tuple[Members, ...], tuple[Incumbent, ...]] | None:
    """Plan vehicles in each other's way one after the other.

    Parameters
    ----------
    fleet : Fleet
        With a plan of every vehicle alone.
    sets : tuple of tuple of int
        A partition; what was searched to the end stays as it is, unless others get in its way.
    price : float
        Of one unit of risk.

    Returns
    -------
    tuple of sets and plans, or None
        No set collides with another. None where some vehicle found no way, or time ran out.
    """
    if any(fleet.states[m].best is None for m in fleet.singles):
        return None
    alone = {m[0]: fleet.best(m).z for m in fleet.singles}
    plans: dict[Members, Incumbent] = {m: fleet.best(m) for m in fleet.singles}
    for members in sets:
        state = fleet.states[members]
        if state.best is not None and not state.is_limited:
            plans[members] = state.best
    sets = tuple(part for m in sets for part in ((m,) if m in plans else tuple((i,) for i in m)))
    for _ in range(_ROUNDS):
        meetings = fleet.meetings(sets, [plans[m].z for m in sets])
        meetings |= {pair: 1.0 for pair in fleet.to_merge(sets)}
        crossing = by_sets(meetings, fleet.owners(sets))
        joined = _joined(sets, crossing, _NEGLIGIBLE * fleet.unit)
        if joined == sets:
            break
        fleet.remember(sets, joined, meetings)
        sets = joined
        for members in sets:
            if members not in plans:
                weights = _weights(fleet, members, alone)
                plan = _place(fleet, members, price, alone, weights)
                if plan is None:
                    return None
                plans[members] = plan
    fleet.known = fleet.parted(sets, [plans[m].z for m in sets])
    return sets, tuple(plans[m] for m in sets)


def _joined(
    sets: tuple[Members, ...], crossing: Mapping[tuple[int, int], float], least: float
) -> tuple[Members, ...]:
    """Join all sets that are in each other's way, directly or through others."""
    pairs = [pair for pair, risk in crossing.items() if risk > least]
    if not pairs:
        return sets
    groups = components(len(sets), pairs)
    return tuple(tuple(sorted(i for part in group for i in sets[part])) for group in groups)


def _weights(fleet: Fleet, members: Members, alone: Mapping[int, np.ndarray]) -> dict[int, float]:
    """Return how much each vehicle is in the others' way when all are planned alone."""
    everyone = [alone[m[0]] for m in fleet.singles]
    weights = dict.fromkeys(members, 0.0)
    for (i, j), risk in fleet.crossing(fleet.singles, everyone).items():
        if i in weights and j in weights:
            weights[i] += risk
            weights[j] += risk
    return weights


def _place(
    fleet: Fleet,
    members: Members,
    price: float,
    alone: Mapping[int, np.ndarray],
    weights: Mapping[int, float],
) -> Incumbent | None:
    """Plan the vehicles of a set one after the other, those most in the way first."""
    problem = fleet.problem(members)
    if problem.rater.is_infeasible:
        return None
    values = [fleet.best((i,)).cost + price * fleet.best((i,)).risk / fleet.unit for i in members]
    move = max(float(np.abs(np.diff(s.reach_upper, axis=0)).max()) for s in problem.models)
    seek = _seek(fleet, members, price)
    around = Neighborhood(
        problem.program, fleet.unit, price, price, fleet.limits, move, values, seek
    )
    order = sorted(range(len(members)), key=lambda block: -weights[members[block]])
    start = fleet.joined(members, alone)
    found = [around.place(start, order)]
    if found[0] is None and not fleet.limits.reached:
        found.append(around.place_in_haste(start, order))
    known = fleet.hint(members)
    if known is not None:
        found.append(around.improve(known, [[block] for block in order]))
    plans = []
    for z in found:
        if z is not None:
            rating = problem.rater.rate(z)
            cost = float(problem.program.cost @ z)
            plans.append(Incumbent(z, rating.selection, cost, rating.risk))
    return min(plans, key=lambda i: i.cost + price * i.risk / fleet.unit, default=None)


def _seek(fleet: Fleet, members: Members, price: float) -> Seek:
    """Return the search for a way among vehicles that are placed, on a lattice of its own."""
    problem = fleet.problem(members)

    def seek(rater: Rater, block: int, is_hurried: bool) -> Incumbent | None:
        if rater.is_infeasible:
            return None
        model = problem.models[block]
        first = block * model.drift_position.size
        alone = fleet.problem((members[block],)).passage
        level = 0 if alone is None else alone.walk.level
        walk = Walk(rater.program, model, fleet.unit, first, level, is_quick=True)
        if not walk.is_possible:
            return None
        passage = Passage(walk, rater)
        if is_hurried:
            return passage.hurried(fleet.limits)
        return passage.found(price, price, fleet.limits, None)

    return seek
