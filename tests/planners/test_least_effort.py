"""What one vehicle costs at least in empty space, and the controls that cost it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from radmpc.experiments.families import clutter, paper
from radmpc.planners.certified.turned.linear.group_lp import GroupLp
from radmpc.planners.certified.turned.successive import SuccessiveLp
from radmpc.planners.least_effort import least_effort
from radmpc.program.build import condensed_models
from radmpc.program.hazards import Hazards
from radmpc.program.limits.hard import keeps_hard_rows
from radmpc.solvers.solution import Limits


def normed(scenario):
    vehicles = [replace(v, control_norm=1.6, speed_norm=2.5) for v in scenario.vehicles]
    return replace(scenario, vehicles=tuple(vehicles))


@pytest.mark.parametrize("scenario", [paper(8, 0), clutter(3, 5, 1), normed(paper(3, 2))])
def test_the_controls_keep_all_limits_and_cost_what_is_proven(scenario) -> None:
    hazards = Hazards.of(scenario, condensed_models(scenario))
    for i, model in enumerate(hazards.models):
        found = least_effort(model)
        assert found.controls is not None
        assert keeps_hard_rows(model, found.controls)
        weight = model.vehicle.cost_weight
        assert weight * np.abs(found.controls).sum() == pytest.approx(found.cost, rel=1e-6)
        # HiGHS says the same of another program of it.
        (other,) = GroupLp(hazards, (i,)).alone() or (np.inf,)
        assert weight * np.abs(other).sum() == pytest.approx(found.cost, rel=1e-6)


def test_who_cannot_reach_its_goal_has_no_controls() -> None:
    scenario = paper(2, 0)
    far = replace(scenario.vehicles[0].goal, lower=[500.0, 0.0], upper=[501.0, 1.0])
    astray = replace(scenario.vehicles[0], goal=far)
    scenario = replace(scenario, vehicles=(astray, scenario.vehicles[1]))
    models = condensed_models(scenario)
    assert least_effort(models[0]).controls is None
    assert least_effort(models[0]).cost == 0.0
    assert not SuccessiveLp(Hazards.of(scenario, models), Limits()).begin_alone()


def test_it_is_found_once_for_each_model_and_anew_for_a_changed_one() -> None:
    (model, _) = condensed_models(paper(2, 0))
    assert least_effort(model) is least_effort(model)
    heavy = replace(model, vehicle=replace(model.vehicle, cost_weight=3.0))
    assert least_effort(heavy).cost == pytest.approx(3.0 * least_effort(model).cost)
