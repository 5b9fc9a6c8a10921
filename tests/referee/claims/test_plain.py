"""One look at a whole fleet finds the same vehicles as a look at each of them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from fleets import random_plan

from radmpc.model.plan import Plan
from radmpc.referee import certify
from radmpc.referee.claims.plain import differing, exceeding_limits
from radmpc.referee.propagation import propagate


def changed(plan: Plan, which: int, field: str, by: float) -> Plan:
    """Return the plan with one number of one vehicle's arrays changed."""
    trajectory = plan.trajectories[which]
    array = np.array(getattr(trajectory, field))
    array.flat[-1] += by
    fleet = list(plan.trajectories)
    fleet[which] = replace(trajectory, **{field: array})
    return replace(plan, trajectories=tuple(fleet))


@pytest.mark.sampled(20)
@pytest.mark.parametrize("seed", range(20))
@pytest.mark.parametrize("field", ["means", "covariances"])
def test_who_states_other_numbers_is_found_and_nobody_else(seed, field):
    plan = random_plan(seed)
    motion = propagate(plan.scenario, [t.controls for t in plan.trajectories])
    assert differing(plan, motion) == []
    which = seed % len(plan.trajectories)
    assert differing(changed(plan, which, field, 1e-7), motion) == []
    assert differing(changed(plan, which, field, 1.0), motion) == [which]
    told = [p for p in certify(changed(plan, which, field, 1.0)).problems if "is stated as" in p]
    assert len(told) == 1


@pytest.mark.sampled(10)
@pytest.mark.parametrize("seed", range(20))
def test_who_exceeds_a_limit_is_found(seed):
    plan = random_plan(seed)
    which = seed % len(plan.trajectories)
    much = changed(plan, which, "controls", 1e5)
    motion = propagate(much.scenario, [t.controls for t in much.trajectories])
    assert which in exceeding_limits(much, motion)
    name = repr(plan.scenario.vehicles[which].name)
    assert any(name in p and "control on axis" in p for p in certify(much).problems)
