"""A goal that leads beyond a narrow workspace is no reason why there is no plan."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import norm

from radmpc.experiments.families import paper
from radmpc.model.scenario import Scenario, Workspace
from radmpc.planners.endpoints.floors import floors
from radmpc.planners.endpoints.looks import _CELLS
from radmpc.planning import plan
from radmpc.program.build import condensed_models


def along_a_canal(width: float, cells: int = _CELLS[2]) -> Scenario:
    """One vehicle in a workspace so wide [m], and a goal across it that leads on beyond.

    The corners of the cells that the goal is divided into are on the border.
    """
    scenario = replace(paper(1, 1), obstacles=())
    (vehicle,) = scenario.vehicles
    middle = 0.5 * (vehicle.goal.lower + vehicle.goal.upper)
    start = np.zeros(4)
    start[:2] = middle[0] - 5.0, middle[1]
    along, across = np.array([0.5, 0.0]), np.array([0.0, 0.5 * width])
    lower = middle - along - across
    upper = middle + along - across + np.array([0.0, cells * width])
    goal = replace(vehicle.goal, lower=lower, upper=upper)
    far = np.array([50.0, 0.0])
    workspace = Workspace(middle - far - across, middle + far + across)
    vehicles = (replace(vehicle, start=start, goal=goal),)
    return replace(scenario, vehicles=vehicles, workspace=workspace)


@pytest.mark.parametrize("deviations", [4.0, 8.0, 16.0])
def test_a_goal_across_the_workspace_risks_no_more_than_in_the_middle(deviations: float) -> None:
    (model,) = condensed_models(along_a_canal(10.0))
    sigma = float(np.sqrt(model.position_covariances[-1][1, 1]))
    scenario = along_a_canal(deviations * sigma)
    found = floors(scenario, condensed_models(scenario))
    places = np.linspace(-0.5, 0.5, 2001) * deviations
    each = norm.sf(places + 0.5 * deviations) + norm.sf(0.5 * deviations - places)
    assert found.vehicles[0, 1] <= each.min() * (1.0 + 1e-9)


def test_there_is_a_plan_along_a_canal_narrower_than_the_goal() -> None:
    (model,) = condensed_models(along_a_canal(10.0))
    sigma = float(np.sqrt(model.position_covariances[-1][1, 1]))
    scenario = along_a_canal(12.0 * sigma)
    made = {name: plan(scenario, name, rng=0) for name in ("ira", "certified")}
    assert all(result.is_certified for result in made.values())
    assert made["certified"].cost <= made["ira"].cost * (1.0 + 1e-6)
