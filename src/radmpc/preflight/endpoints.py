"""What starts and goals risk at least; nothing is loaded for it where they risk nothing."""

from __future__ import annotations

from collections.abc import Sequence
from math import log, sqrt
from typing import TYPE_CHECKING

import numpy as np

from radmpc.arrays import Matrix, Tensor, Vector
from radmpc.model.relations.concerns import is_for
from radmpc.model.scenario import Scenario

if TYPE_CHECKING:
    from radmpc.planners.endpoints.floors import Floors
    from radmpc.planners.endpoints.ranges import LostRange
    from radmpc.program.condensed import CondensedModel

__all__ = ["least_risks"]

_LEAST = 1e-4
"""Share of Δ below which a hazard counts as nothing [-], as in `Floors`."""


def least_risks(
    scenario: Scenario, covariances: list[Tensor]
) -> tuple[Floors | None, tuple[LostRange, ...]]:
    """Return what starts and goals risk, whatever the plan.

    Parameters
    ----------
    scenario : Scenario
        The fleet.
    covariances : list of (T+1, d, d) array
        Position covariances of every vehicle [m²].

    Returns
    -------
    Floors or None
        Of obstacles, border and others; None where nothing is near any of them.
    tuple of LostRange
        Of the ranges that are kept, those that starts or goals risk.
    """
    is_near = any(_is_near(scenario, covariances, at_goal=one) for one in (False, True))
    if not is_near and not scenario.keep:
        return None, ()
    # These load scipy, which takes as long as all else of a check.
    from radmpc.planners.endpoints.floors import floors  # noqa: PLC0415 - only where something is near
    from radmpc.program.build import condensed_models  # noqa: PLC0415 - only where something is near

    models = condensed_models(scenario)
    ranges = _ranges(scenario, models) if scenario.keep else ()
    return floors(scenario, models) if is_near else None, ranges


def _ranges(scenario: Scenario, models: Sequence[CondensedModel]) -> tuple[LostRange, ...]:
    """Return the ranges that starts or goals risk, starts first."""
    from radmpc.planners.endpoints.ranges import lost_ranges  # noqa: PLC0415 - few keep a range

    return tuple(
        one
        for at_goal in (False, True)
        for one in lost_ranges(scenario, models, at_goal=at_goal)
        if one.risk > _LEAST * scenario.risk_bound
    )


def _is_near(scenario: Scenario, covariances: list[Tensor], *, at_goal: bool) -> bool:
    """Whether anything is near a start or a goal, near enough to run any risk."""
    vehicles = scenario.vehicles
    if at_goal:
        lower = np.array([v.goal.lower for v in vehicles])
        upper = np.array([v.goal.upper for v in vehicles])
    else:
        lower = upper = np.array([v.start_position for v in vehicles])
    ends = np.array([c[-1 if at_goal else 0] for c in covariances])
    # The tail at q deviations is at most exp(−q²/2)/2.
    far = sqrt(-2.0 * log(2.0 * _LEAST * scenario.risk_bound))
    spread = np.sqrt(np.linalg.eigvalsh(ends)[:, -1].clip(min=0.0))
    radii = np.array([v.radius for v in vehicles])
    step = scenario.horizon if at_goal else 0
    return (
        _near_border(scenario, lower, upper, far * spread)
        or _near_pieces(scenario, lower, upper, radii + far * spread + 1e-6, step, far)
        or _near_each_other(lower, upper, radii, far * spread)
    )


def _near_border(scenario: Scenario, lower: Matrix, upper: Matrix, reach: Vector) -> bool:
    """Whether some place is near the workspace's border."""
    workspace = scenario.workspace
    if workspace is None:
        return False
    away = np.minimum(lower - workspace.lower, workspace.upper - upper).min(axis=1)
    return bool(np.any(away <= reach))


def _near_pieces(
    scenario: Scenario, lower: Matrix, upper: Matrix, reach: Vector, step: int, far: float
) -> bool:
    """Whether some place is near an obstacle, or near the box around it."""
    for obstacle in scenario.obstacles:
        mine = np.ones(scenario.num_vehicles, dtype=bool)
        if obstacle.concerns is not None:
            mine[:] = [is_for(obstacle, vehicle.name) for vehicle in scenario.vehicles]
        # Deviations of two add up to less than their sum.
        more = 0.0 if obstacle.spread is None else far * obstacle.spread.deviation(step)
        for piece in obstacle.at(step):
            low, high = piece.vertices.min(axis=0) - more, piece.vertices.max(axis=0) + more
            gaps = np.maximum(np.maximum(low - upper, lower - high), 0.0)
            if np.any(mine & (np.square(gaps).sum(axis=1) <= np.square(reach))):
                return True
    return False


def _near_each_other(lower: Matrix, upper: Matrix, radii: Vector, spread: Vector) -> bool:
    """Whether two places are near each other."""
    for i in range(len(radii) - 1):
        gaps = np.maximum(np.maximum(lower[i] - upper[i + 1 :], lower[i + 1 :] - upper[i]), 0.0)
        # Deviations of two add up to less than their sum.
        reach = radii[i] + radii[i + 1 :] + spread[i] + spread[i + 1 :] + 1e-6
        if np.any(np.square(gaps).sum(axis=1) <= np.square(reach)):
            return True
    return False
