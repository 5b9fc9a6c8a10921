"""What keeps a plan's feedback within limits: as told, and nothing where nothing does."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import radmpc
from radmpc.experiments.families import circle
from radmpc.planners.cures.saturating import saturation_cure
from radmpc.referee import certify


@pytest.fixture(scope="module")
def standing() -> radmpc.Plan:
    """Three vehicles under stiff feedback that hardly stay where they are; one is quiet."""
    scenario = circle(3)
    horizon = scenario.horizon
    stiff = [
        replace(
            one,
            gain=radmpc.lqr_gain(one.system, np.eye(4), weight * np.eye(2)),
            control_limit=np.full(2, 0.15),
            initial_covariance=0.002 * np.eye(4),
        )
        for one, weight in zip(scenario.vehicles, (0.05, 0.05, 1e6), strict=True)
    ]
    scenario = replace(scenario, vehicles=tuple(stiff))
    tracks = tuple(
        radmpc.Trajectory(
            one.name,
            np.zeros((horizon, 2)),
            np.tile(one.start, (horizon + 1, 1)),
            one.covariances(horizon),
        )
        for one in scenario.vehicles
    )
    return radmpc.Plan(
        scenario=scenario,
        planner="drawn",
        seed=0,
        status=radmpc.Status.FEASIBLE,
        cost=0.0,
        lower_bound=None,
        risk=radmpc.Risk(scenario.risk_bound),
        sets=(("v1",), ("v2",), ("v3",)),
        trajectories=tracks,
    )


def saturation(plan: radmpc.Plan, factor: float) -> float:
    """Return how likely feedback saturates under other limits of the first two."""
    one, two, three = plan.scenario.vehicles
    raised = (replace(v, control_limit=factor * v.control_limit) for v in (one, two))
    scenario = replace(plan.scenario, vehicles=(*raised, three))
    return certify(replace(plan, scenario=scenario)).saturation


def test_the_limits_that_are_told_are_high_enough(standing):
    most = 0.01 * saturation(standing, 1.0)
    assert most > 0.0
    told = saturation_cure(standing, most)
    assert told.startswith("raise control_limit of v1, v2 to ")
    factor = float(told.split(" to ")[1].split()[0])
    assert saturation(standing, factor) <= most
    assert saturation(standing, 1.0) > most


def test_nothing_is_told_where_no_limit_that_is_tried_does(standing):
    assert saturation_cure(standing, -1.0) == ""
