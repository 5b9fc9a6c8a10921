"""Plans of a fleet by turned half-spaces: from its best plan, toward another, from no plan."""

from __future__ import annotations

from radmpc.arrays import Matrix
from radmpc.planners.certified.fleet import Fleet
from radmpc.planners.certified.merging import Members
from radmpc.planners.certified.state.search_state import SearchState
from radmpc.planners.certified.state.task import task_of
from radmpc.planners.certified.turned.large.idle import not_idle
from radmpc.planners.certified.turned.large.sides import on_other_sides
from radmpc.planners.certified.turned.tuning import TUNING
from radmpc.planners.certified.turned.turning import Turning
from radmpc.planners.verdict import Judge
from radmpc.records import replace

__all__ = ["plan_by_turning", "turn_half_spaces", "turn_to"]


def turn_half_spaces(
    fleet: Fleet, state: SearchState, judge: Judge, rival: float = float("inf")
) -> SearchState:
    """Improve the incumbent by half-spaces of any direction, until little is gained.

    Every hazard keeps the side on which the plan passes it, by a half-space turned to where it
    separates best. Between them the least effort at a price of risk is a linear program.

    Parameters
    ----------
    fleet : Fleet
        The fleet.
    state : SearchState
        With a certified plan.
    judge : callable
        The referee.
    rival : float
        Cost of another plan that it is to become cheaper than.

    Returns
    -------
    SearchState
        With a cheaper plan where there is one. What was proven stays as it is.
    """
    incumbent = state.incumbent
    price = incumbent.turned_price or state.last_unit_price(fleet) / fleet.unit
    price /= incumbent.risk_ratio
    turning = Turning(task_of(fleet, judge, incumbent.controls), incumbent, incumbent.sets, price)
    turning.successive.begin(incumbent.controls)
    task, paths = turning.task, turning.successive.paths
    if task.hazards.count > TUNING.most_together:
        turning.hold_all_but(not_idle(task.hazards, paths, fleet.base, price, task.gap))
    return replace(state, incumbent=turning.run(TUNING.rounds, rival))


def turn_to(
    fleet: Fleet,
    state: SearchState,
    judge: Judge,
    controls: tuple[Matrix, ...],
    price: float,
    *,
    is_outside: bool = False,
) -> SearchState:
    """Turn half-spaces to another plan than the incumbent, certified or nearly.

    In a large fleet those sets alone that pass anything on another side: all others stay.

    Parameters
    ----------
    fleet : Fleet
        The fleet.
    state : SearchState
        With a certified plan.
    judge : callable
        The referee.
    controls : tuple of (T, m) array
        Of the other plan, in the scenario's order.
    price : float
        Cost of what half-spaces risk to begin with, per unit of probability.
    is_outside : bool
        Whether the other plan is beyond the limits that programs keep.

    Returns
    -------
    SearchState
        With a cheaper plan where there is one.
    """
    incumbent, task = state.incumbent, task_of(fleet, judge, controls)
    turning = Turning(task, incumbent, incumbent.sets, price, is_above=True, is_outside=is_outside)
    if task.hazards.count > TUNING.most_together:
        others = on_other_sides(task.hazards, incumbent.controls, controls)
        if not others:
            return state
        turning.hold_all_but(others)
        turning.is_partial = True
        moving = {i for group in turning.groups for i in group}
        both = zip(incumbent.controls, controls, strict=True)
        controls = tuple(b if i in moving else a for i, (a, b) in enumerate(both))
    turning.successive.begin(controls)
    return replace(state, incumbent=turning.run(TUNING.rounds, incumbent.cost))


def plan_by_turning(
    fleet: Fleet,
    state: SearchState,
    judge: Judge,
    sets: tuple[Members, ...],
    controls: tuple[Matrix, ...],
) -> SearchState:
    """Look for a certified plan near one that risks too much, by half-spaces turned to it.

    Parameters
    ----------
    fleet, state, judge
        As in `turn_half_spaces`, with or without a plan.
    sets : tuple of tuple of int
        Vehicles that are planned together.
    controls : tuple of (T, m) array
        Of a plan without collisions, noise aside, in the scenario's order.

    Returns
    -------
    SearchState
        With the plan, if it is certified and cheaper.
    """
    # Risk counts for much more than effort until the plan is certified.
    price = TUNING.dear * fleet.first_unit_price(state.budget) / fleet.unit
    turning = Turning(task_of(fleet, judge, controls), state.incumbent, sets, price)
    turning.successive.begin(controls)
    return replace(state, incumbent=turning.run(2 * TUNING.rounds, state.incumbent.cost))
