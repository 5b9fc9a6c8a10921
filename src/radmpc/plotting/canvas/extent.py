"""How much of the plane or of space a picture shows."""

from __future__ import annotations

import numpy as np

from radmpc.arrays import Matrix
from radmpc.model.plan import Plan
from radmpc.model.scenario import Scenario
from radmpc.plotting.curves import confidence_ellipses, mean_path

__all__ = ["plan_extent", "scenario_extent"]

_MARGIN = 0.03
"""Empty border around what is drawn, as a share of the longer side [-]."""


def scenario_extent(scenario: Scenario) -> Matrix:
    """Return the corners that hold all there is, (2, d) [m], with a small margin."""
    return _padded(_corners(scenario))


def plan_extent(plan: Plan) -> Matrix:
    """Return the corners that hold the scenario and all trajectories, (2, d) [m]."""
    scenario = plan.scenario
    clouds = [_corners(scenario)]
    for vehicle, trajectory in zip(scenario.vehicles, plan.trajectories, strict=False):
        path = mean_path(vehicle, trajectory)
        clouds += [path - vehicle.radius, path + vehicle.radius]
        if scenario.dimension == 2:
            clouds += confidence_ellipses(vehicle, trajectory)
    return _padded(np.vstack(clouds))


def _corners(scenario: Scenario) -> Matrix:
    """Return points whose bounding box is the scenario's."""
    clouds = []
    for vehicle in scenario.vehicles:
        clouds += [
            np.stack([vehicle.start_position - vehicle.radius]),
            np.stack([vehicle.start_position + vehicle.radius]),
            np.stack([vehicle.goal.lower, vehicle.goal.upper]),
            *(np.stack([visit.lower, visit.upper]) for visit in vehicle.via),
        ]
    for obstacle in scenario.obstacles:
        for step, pieces in enumerate(obstacle.steps):
            more = 0.0
            if obstacle.spread is not None:
                more = 3.0 * np.sqrt(np.diag(obstacle.spread.positions[step]).clip(min=0.0))
            clouds += [piece.vertices + sign * more for piece in pieces for sign in (-1.0, 1.0)]
    if scenario.workspace is not None:
        clouds.append(np.stack([scenario.workspace.lower, scenario.workspace.upper]))
    return np.vstack(clouds)


def _padded(points: Matrix) -> Matrix:
    """Return the bounding box of points, a little wider, never flat."""
    lower, upper = points.min(axis=0), points.max(axis=0)
    span = float((upper - lower).max())
    # A scenario may lie on one line: without a least width the axes would be a hair.
    lack = np.maximum(0.25 * span - (upper - lower), 0.0)
    pad = 0.5 * lack + _MARGIN * span
    return np.stack([lower - pad, upper + pad])
