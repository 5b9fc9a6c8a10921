"""Vehicles between polytopes within limits of norms that suit their goals."""

from __future__ import annotations

from radmpc.model.limits import all_outside_norms
from radmpc.model.scenario import Scenario
from radmpc.planners.least_effort import least_effort
from radmpc.program.build import condensed_models
from radmpc.program.condensed import CondensedModel
from radmpc.program.limits.norms import turned_inside, turned_outside, turned_to_goal

__all__ = ["models_within_norms"]

_TURNS = 4
"""Plans around norms that are tried for one that polytopes within can follow [-]."""


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
    models, outside = condensed_models(scenario), all_outside_norms(scenario)
    if outside is scenario:
        return models
    return tuple(map(_reaching, models, condensed_models(outside)))


def _reaching(model: CondensedModel, outside: CondensedModel) -> CondensedModel:
    """Return a vehicle whose polytopes have corners toward its goal, or where it has to be faster.

    Where corners toward the goal are too little to reach it, a plan that reaches it between
    polytopes around the norms tells where else these are needed. With visits, or an arrival at a
    price, there is no such plan yet.
    """
    turned, vehicle = turned_to_goal(model), model.vehicle
    are_free = vehicle.control_norm is None and vehicle.speed_norm is None
    if are_free or least_effort(turned).controls is not None:
        return turned
    for _ in range(_TURNS):
        controls = least_effort(outside).controls
        if controls is None:
            break
        inside = turned_inside(model, controls)
        if least_effort(inside).controls is not None:
            return inside
        outside = turned_outside(outside, controls)
    return turned
