"""Turning the polytopes of limits of norms to a plan, which leaves it all that norms do."""

from __future__ import annotations

from radmpc.model.limits import outside_norms
from radmpc.model.scenario import Scenario
from radmpc.planners.certified.fleet import Fleet
from radmpc.planners.certified.phases.tuning import TUNING
from radmpc.planners.certified.state.search_state import SearchState
from radmpc.planners.least_effort import least_effort
from radmpc.planners.verdict import Judge
from radmpc.program.build import condensed_models
from radmpc.program.condensed import CondensedModel
from radmpc.program.limits.norms import turned_inside, turned_outside, turned_to_goal
from radmpc.records import replace

__all__ = ["models_within_norms", "turned_to_norms"]


def models_within_norms(scenario: Scenario) -> tuple[CondensedModel, ...]:
    """Return every vehicle condensed, between polytopes within its norms that suit its goal.

    Parameters
    ----------
    scenario : Scenario
        The fleet.

    Returns
    -------
    tuple of CondensedModel
        `condensed_models`, of vehicles without limits of norms.
    """
    models = condensed_models(scenario)
    vehicles = tuple(map(outside_norms, scenario.vehicles))
    if all(one is other for one, other in zip(vehicles, scenario.vehicles, strict=True)):
        return models
    outside = condensed_models(replace(scenario, vehicles=vehicles))
    return tuple(map(_reaching, models, outside))


def _reaching(model: CondensedModel, outside: CondensedModel) -> CondensedModel:
    """Return a vehicle whose polytopes have corners toward its goal, or where it has to be faster.

    Where corners toward the goal are too little to reach it, a plan that reaches it between
    polytopes around the norms tells where else these are needed.
    """
    turned, vehicle = turned_to_goal(model), model.vehicle
    are_free = vehicle.control_norm is None and vehicle.speed_norm is None
    is_open = bool(vehicle.via) or vehicle.goal.within is not None
    if are_free or is_open or least_effort(turned).controls is not None:
        return turned
    for _ in range(TUNING.norm_turns):
        controls = least_effort(outside).controls
        if controls is None:
            break
        inside = turned_inside(model, controls)
        if least_effort(inside).controls is not None:
            return inside
        outside = turned_outside(outside, controls)
    return turned


def turned_to_norms(fleet: Fleet, state: SearchState, judge: Judge) -> SearchState:
    """Turn half-spaces between polytopes that have a corner wherever the plan is at a norm.

    Parameters
    ----------
    fleet : Fleet
        The fleet.
    state : SearchState
        With a plan, or without.
    judge : callable
        The referee.

    Returns
    -------
    SearchState
        With a cheaper plan where there is one; the same where norms are free.
    """
    if not (fleet.keeps_norms and state.has_plan):
        return state
    from radmpc.planners.certified.turned.turned_plans import turn_half_spaces  # noqa: PLC0415 - few have any

    for _ in range(TUNING.norm_turns):
        before = state.incumbent
        if fleet.limits.reached:
            break
        state = turn_half_spaces(_turned(fleet, state), state, judge)
        if before.cost - state.incumbent.cost <= TUNING.little * fleet.gap * before.cost:
            break
    return state


def _turned(fleet: Fleet, state: SearchState) -> Fleet:
    """Return the fleet with polytopes turned to its best plan."""
    hazards = fleet.programs.hazards
    models = tuple(map(turned_inside, hazards.models, state.incumbent.controls))
    return Fleet.of(
        fleet.scenario,
        fleet.gap,
        fleet.limits,
        improved=fleet.improved,
        executor=fleet.executor,
        hazards=replace(hazards, models=models),
    )
