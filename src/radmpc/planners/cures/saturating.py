"""What keeps feedback of a plan from asking for too much control: tried on the plan itself."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from radmpc.errors import ScenarioError
from radmpc.model.plan import Plan
from radmpc.model.scenario import Scenario
from radmpc.planners.cures.variants import LIMIT_FACTORS
from radmpc.referee.propagation import propagate
from radmpc.referee.saturation import saturation_bound

__all__ = ["saturation_cure"]

_NAMED = 3
"""Vehicles that are named; of more, how many they are [-]."""


def saturation_cure(plan: Plan, most: float) -> str:
    """Return by how much higher limits make the controls of a plan saturate seldom enough.

    Means, covariances and the risk of the plan stay as they are: higher limits change nothing but
    what is cut off. Other cures would be other plans.

    Parameters
    ----------
    plan : Plan
        With trajectories that fit its scenario.
    most : float
        The largest probability that any control saturates [-].

    Returns
    -------
    str
        In the imperative; empty where none of the limits that were tried does.
    """
    scenario = plan.scenario
    controls = [trajectory.controls for trajectory in plan.trajectories]
    motion = propagate(scenario, controls)
    bounds = saturation_bound(scenario, motion, controls)
    # What the others ask for too much fits in what is allowed.
    order = np.argsort(-bounds, kind="stable")
    left = float(bounds.sum()) - np.cumsum(bounds[order])
    members = order[: int(np.argmax(left <= 0.5 * most)) + 1].tolist()
    for factor in LIMIT_FACTORS:
        try:
            raised = _with_limits(scenario, members, factor)
        except ScenarioError:
            break  # a norm allows no higher ones
        if float(saturation_bound(raised, motion, controls).sum()) <= most:
            whose = _named([scenario.vehicles[i].name for i in members])
            return f"raise control_limit of {whose} to {factor:g} times its value"
    return ""


def _with_limits(scenario: Scenario, members: list[int], factor: float) -> Scenario:
    """Return a scenario in which some vehicles have other limits."""
    vehicles = list(scenario.vehicles)
    for i in members:
        vehicles[i] = replace(vehicles[i], control_limit=factor * vehicles[i].control_limit)
    return replace(scenario, vehicles=tuple(vehicles))


def _named(names: list[str]) -> str:
    """Return few names, or a number of vehicles."""
    return ", ".join(names) if len(names) <= _NAMED else f"{len(names)} vehicles"
