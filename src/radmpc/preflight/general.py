"""Least time and effort of dynamics that have no closed form: by linear programs."""

from __future__ import annotations

from typing import Literal

import numpy as np

from radmpc.arrays import Matrix
from radmpc.errors import ScenarioError
from radmpc.model.limits import outside_norms
from radmpc.model.scenario import Scenario
from radmpc.model.vehicle import Vehicle
from radmpc.planners.explain import unable_alone
from radmpc.planners.reaching.empty_space import in_empty_space
from radmpc.planners.reaching.limits import (
    is_late_whatever_horizon,
    reach_texts,
    too_fast_texts,
)
from radmpc.planners.reaching.visiting import makes_visits, reaches_goal
from radmpc.program.build import build_program, condensed_models, controls_of
from radmpc.program.condensed import CondensedModel
from radmpc.program.program import DisjunctiveProgram
from radmpc.solvers.lp.outcome import LpOutcome
from radmpc.solvers.lp.warm_lp import WarmLp

__all__ = ["arrives", "cheapest", "makes_all_visits", "reach", "why_unable"]


def arrives(scenario: Scenario, vehicle: Vehicle, horizon: int) -> bool:
    """Whether a vehicle can be in its goal at a horizon, through empty space.

    Parameters
    ----------
    scenario : Scenario
        Whose step counts.
    vehicle : Vehicle
        With its feedback, which keeps control back.
    horizon : int
        Number of steps.
    """
    try:
        alone, model = _alone(scenario, vehicle, horizon)
    except ScenarioError:  # a state that grows too far
        return False
    return unable_alone(alone, model) is None


def why_unable(scenario: Scenario, vehicle: Vehicle) -> tuple[Literal["time", "visit"], str] | None:
    """Return why limits leave a vehicle no plan, whatever the horizon, or with its visits.

    Parameters
    ----------
    scenario : Scenario
        Whose step and horizon count.
    vehicle : Vehicle
        With its visits, the window of its arrival, and its feedback.

    Returns
    -------
    pair of str or None
        What it is about, and what planners say after the vehicle's name, without a full stop; None
        where there is no such reason, or where that would take long to tell.
    """
    # What polytopes within norms rule out, the norms themselves may allow.
    alone, model = _alone(scenario, outside_norms(vehicle), scenario.horizon)
    if np.any(model.control_bounds < 0.0):
        return None
    fast = too_fast_texts(model)
    if fast is not None:
        return "time", fast[0].rstrip(".")
    if is_late_whatever_horizon(model):
        return "time", reach_texts(alone, model)[0].rstrip(".")
    if makes_visits(model) is False and reaches_goal(model, vehicle.goal.within):
        return "visit", reach_texts(alone, model)[0].rstrip(".")
    return None


def makes_all_visits(scenario: Scenario, vehicle: Vehicle, horizon: int) -> bool:
    """Whether a vehicle makes its visits and reaches its goal in empty space, as far as is known.

    Parameters
    ----------
    scenario : Scenario
        Whose step counts.
    vehicle : Vehicle
        With its visits and its feedback.
    horizon : int
        Number of steps.

    Returns
    -------
    bool
        False is proven; of many visits that may take too many linear programs.
    """
    try:
        _, model = _alone(scenario, vehicle, horizon)
    except ScenarioError:  # a state that grows too far
        return False
    return makes_visits(model) is not False


def cheapest(scenario: Scenario, vehicle: Vehicle) -> Matrix | None:
    """Return controls of the least effort through empty space.

    Parameters
    ----------
    scenario : Scenario
        Whose step and horizon count.
    vehicle : Vehicle
        With its feedback.

    Returns
    -------
    (T, m) array or None
        None where the goal is out of reach.
    """
    alone, model = _alone(scenario, vehicle, scenario.horizon)
    if np.any(model.control_bounds < 0.0):
        return None
    program: DisjunctiveProgram = build_program(alone, [model], risk_bound=scenario.risk_bound)
    lp = WarmLp(program, np.zeros(program.rows.count))
    outcome, _ = lp.solve()
    if outcome is not LpOutcome.OPTIMAL:
        return None
    return controls_of([model], lp.point())[0]


def reach(scenario: Scenario, vehicle: Vehicle) -> tuple[Matrix, Matrix]:
    """Return boxes that hold the mean at each step, in time at the goal.

    Parameters
    ----------
    scenario : Scenario
        Whose step and horizon count.
    vehicle : Vehicle
        With its feedback.

    Returns
    -------
    lower, upper : (T+1, d) array
        Corners [m]; crossed where the goal is out of reach.
    """
    _, model = _alone(scenario, vehicle, scenario.horizon)
    return model.reach_lower, model.reach_upper


def _alone(scenario: Scenario, vehicle: Vehicle, horizon: int) -> tuple[Scenario, CondensedModel]:
    """Return a vehicle in empty space, over a horizon."""
    alone = in_empty_space(scenario, vehicle, horizon)
    (model,) = condensed_models(alone)
    return alone, model
