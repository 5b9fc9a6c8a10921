"""A first plan of a crowded fleet by successive linear programs, before any set is searched."""

from __future__ import annotations

from dataclasses import replace

from radmpc.arrays import Matrix
from radmpc.gaussian import CONVEX_RISK, clearance_for
from radmpc.planners.certified.fleet import Fleet
from radmpc.planners.certified.incumbent import FleetIncumbent
from radmpc.planners.certified.inter_set_risk import by_sets
from radmpc.planners.certified.merging import owners_of
from radmpc.planners.certified.state import SearchState
from radmpc.planners.certified.turned.tuning import TUNING
from radmpc.planners.certified.turned.turning import Turning
from radmpc.planners.components import components
from radmpc.planners.verdict import Judge
from radmpc.program.build import controls_of

__all__ = ["first_plan"]


def first_plan(fleet: Fleet, state: SearchState, judge: Judge) -> SearchState:
    """Plan a crowded fleet one vehicle after the other, then all at a price of risk.

    Where few vehicles get in each other's way, searching their sets is as quick, and nothing is
    done.

    Parameters
    ----------
    fleet : Fleet
        The fleet.
    state : SearchState
        With plans of the vehicles alone, as far as they were found.
    judge : callable
        The referee.

    Returns
    -------
    SearchState
        With the plan in `SearchState.first`, if one is certified.
    """
    alone = _alone(fleet, state)
    if alone is None or not _is_crowded(fleet, state):
        return state
    price = fleet.first_unit_price(state.budget) / fleet.unit
    turning = Turning.of(fleet, judge, FleetIncumbent(), fleet.singles, price)
    turning.successive.begin(alone)
    share = TUNING.first_share * fleet.scenario.risk_bound / fleet.scenario.num_vehicles
    clearance = float(clearance_for(min(share, CONVEX_RISK)))
    if not turning.successive.keep_apart(clearance, TUNING.max_sweeps):
        return state
    return replace(state, first=turning.run(TUNING.rounds))


def _alone(fleet: Fleet, state: SearchState) -> list[Matrix] | None:
    """Return the controls of every vehicle alone; None if some has no plan yet."""
    found = []
    for members, model in zip(fleet.singles, fleet.programs.models, strict=True):
        set_state = state.set_states.get(members)
        if set_state is None or set_state.best is None:
            return None
        found += controls_of((model,), set_state.best.z)
    return found


def _is_crowded(fleet: Fleet, state: SearchState) -> bool:
    """Whether many vehicles get in each other's way, directly or through others, if planned alone."""
    sets = fleet.singles
    risks = by_sets(
        fleet.programs.pair_risks(sets, [state.best(m).z for m in sets]), owners_of(sets)
    )
    pairs = [pair for pair, risk in risks.items() if risk > TUNING.noticed * fleet.unit]
    return max(len(group) for group in components(len(sets), pairs)) >= TUNING.many
