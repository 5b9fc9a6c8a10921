from __future__ import annotations

import re
import sys
from pathlib import Path

import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).parent.parent / "referee"))

from dataclasses import replace

from conditional_missions import crowded

from radmpc.errors import ArgumentError
from radmpc.flying.flight import fly
from radmpc.flying.mission import Mission
from radmpc.flying.model import Model
from radmpc.model.plan import Plan
from radmpc.referee.simulation.preparation import prepare


def roomy(plan: Plan) -> Plan:
    """Return a plan that may risk what it does."""
    return replace(plan, scenario=replace(plan.scenario, risk_bound=0.49))


@pytest.mark.slow
@pytest.mark.sampled(1)
@pytest.mark.parametrize("avoidance", ["steps", "intervals"])
@pytest.mark.parametrize(
    ("dimension", "gain", "noise"), [(2, True, 0.3), (2, False, 0.25), (3, True, 0.3)]
)
def test_the_model_meets_what_simulation_meets_mission_by_mission(
    dimension: int, avoidance: str, gain: bool, noise: float
) -> None:
    plan = roomy(crowded(dimension, avoidance, gain=gain, noise=noise))
    simulated = prepare(plan)
    seeds = np.random.SeedSequence(5).spawn(40)
    theirs = [bool(simulated.count(1, seed)[0]) for seed in seeds]
    ours = []
    for seed in seeds:
        mission = Mission(plan, planner=None)
        ours.append(fly(mission, Model(plan.scenario, np.random.default_rng(seed))).has_collided)
    assert 3 <= sum(theirs) <= 37
    assert ours == theirs


def test_the_model_refuses_segments_of_other_vehicles_or_in_another_order() -> None:
    plan = crowded(2, "intervals", gain=True, noise=0.3)
    names = [vehicle.name for vehicle in plan.scenario.vehicles]
    model = Model(plan.scenario, 1)
    states, contacts = model.reset()
    segments = Mission(roomy(plan), planner=None).step(states, contacts=contacts).segments
    for wrong in ((), segments[:1], segments[::-1]):
        got = re.escape(f"must be of {names} in this order, got {[s.name for s in wrong]}")
        with pytest.raises(ArgumentError, match=got):
            model.advance(wrong)
    model.advance(segments)
