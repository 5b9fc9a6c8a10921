"""Turning half-spaces to the sides on which vehicles go around obstacles by themselves."""

from __future__ import annotations

import numpy as np

from radmpc.arrays import Matrix
from radmpc.planners.certified.fleet import Fleet
from radmpc.planners.certified.phases.tuning import TUNING
from radmpc.planners.certified.proof.search import BoundSearch
from radmpc.planners.certified.proof.tuning import TUNING as PROOF_TUNING
from radmpc.planners.certified.state.incumbent import FleetIncumbent
from radmpc.planners.certified.state.search_state import SearchState
from radmpc.planners.certified.turned.large.sides import on_other_sides
from radmpc.planners.certified.turned.turned_plans import turn_to
from radmpc.planners.verdict import Judge
from radmpc.records import replace

__all__ = ["on_sides_alone", "turned_to_alone"]


def on_sides_alone(fleet: Fleet, first: FleetIncumbent, judge: Judge) -> FleetIncumbent:
    """Return a first plan turned to what short searches of single vehicles find, if cheaper.

    Routes tell which gaps a vehicle passes, not on which side of each box and when. Searches of
    all together take long to find better sides than a first plan has, those of each alone do not.

    Parameters
    ----------
    fleet : Fleet
        The fleet, with the limits that end the search.
    first : FleetIncumbent
        A certified plan.
    judge : callable
        The referee.
    """
    fleet = fleet.with_limits(fleet.limits.within(TUNING.alone_share * fleet.limits.seconds_left))
    state = replace(SearchState.of(fleet), incumbent=first)
    price = first.turned_price or fleet.first_unit_price(state.budget) / fleet.unit
    base, any_nodes = float(sum(fleet.base)), float("inf")
    search = BoundSearch(fleet, first, price, base, any_nodes, is_by_faces=True)
    search.regroup(fleet.singles)
    for effort in range(TUNING.efforts_first):
        before = search.nodes
        search.advance(PROOF_TUNING.nodes, effort, search.order)
        if search.nodes == before or fleet.limits.reached:
            break
        state = turned_to_alone(fleet, state, search.relaxed_controls(), price, judge)
        if state.incumbent is not search.incumbent:
            search.continue_from(state.incumbent, price)
    return state.incumbent


def turned_to_alone(
    fleet: Fleet, state: SearchState, alone: tuple[Matrix, ...], price: float, judge: Judge
) -> SearchState:
    """Turn half-spaces to what vehicles do alone, all of them and then those that are cheaper so.

    Parameters
    ----------
    fleet : Fleet
        The fleet.
    state : SearchState
        With a plan.
    alone : tuple of (T, m) array
        What each does alone among obstacles; empty where that is the plan at hand.
    price : float
        Shadow price of the risk, per unit of probability.
    judge : callable
        The referee.

    Returns
    -------
    SearchState
        With a cheaper plan where there is one.
    """
    if not alone:
        return state
    for number in range(1 + TUNING.turns_alone):
        incumbent = state.incumbent
        chosen = _cheaper(incumbent.controls, alone) if number else alone
        if fleet.limits.reached:
            return state
        if on_other_sides(fleet.programs.hazards, incumbent.controls, chosen, TUNING.same_side):
            is_outside = fleet.keeps_norms
            state = turn_to(fleet, state, judge, chosen, price, is_outside=is_outside)
        # Whom others stopped may find a way once these have moved, too, but not before.
        if number and state.incumbent is incumbent:
            return state
    return state


def _cheaper(controls: tuple[Matrix, ...], alone: tuple[Matrix, ...]) -> tuple[Matrix, ...]:
    """Return what those vehicles do alone that take less effort then, and all others' controls."""
    most = 1.0 - TUNING.cheaper
    pairs = zip(controls, alone, strict=True)
    return tuple(b if np.abs(b).sum() < most * np.abs(a).sum() else a for a, b in pairs)
