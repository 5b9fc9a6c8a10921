from __future__ import annotations

import re
import sys
from pathlib import Path

import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).parent.parent / "referee"))

from dataclasses import replace
from itertools import combinations

from conditional_missions import crowded

from radmpc.errors import ArgumentError
from radmpc.flying.flight import fly
from radmpc.flying.mission import Mission
from radmpc.flying.model import Model
from radmpc.flying.tick import Segment
from radmpc.model.dynamics import double_integrator
from radmpc.model.plan import Plan
from radmpc.model.scenario import Scenario
from radmpc.model.vehicle import Goal, Vehicle
from radmpc.referee.simulation.collisions import meets_origin
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


def fleet_at(places: np.ndarray) -> Scenario:
    """Return vehicles that rest at places where some of them touch."""
    system, one = double_integrator(1.0, 2), Goal.at([0.0, 0.0], 100.0)
    vehicles = tuple(
        Vehicle(f"v{i}", system, place, one, 0.3 + 0.01 * (i % 7), 2.0, 0.0, 0.0)
        for i, place in enumerate(places)
    )
    return Scenario("crowd", 1.0, 2, 0.1, vehicles, avoidance="intervals")


@pytest.mark.parametrize("count", [12, 80])
def test_a_fleet_meets_the_pairs_that_meet_one_by_one(count: int) -> None:
    rng = np.random.default_rng(count)
    scenario = fleet_at(rng.uniform(0.0, count**0.5, (count, 2)))
    model = Model(scenario, 0)
    model.reset()
    controls = rng.uniform(-2.0, 2.0, (count, 2))
    parts = [
        Segment(v.name, u, v.start[:2], None)
        for v, u in zip(scenario.vehicles, controls, strict=True)
    ]
    states, contacts = model.advance(parts)
    expected = []
    for i, j in combinations(range(count), 2):
        one, two = scenario.vehicles[i], scenario.vehicles[j]
        begin, end = one.start[:2] - two.start[:2], states[i][:2] - states[j][:2]
        sagitta = one.system.sagitta @ controls[i] - two.system.sagitta @ controls[j]
        reach = np.array([one.radius + two.radius])
        if meets_origin(begin[None], end[None], sagitta[None], reach)[0]:
            expected.append((one.name, two.name))
    assert [(c.vehicle, c.other) for c in contacts] == expected
    assert len(expected) > count // 4


def test_pairs_far_apart_are_not_looked_at(monkeypatch: pytest.MonkeyPatch) -> None:
    looked: list[int] = []

    def counting(begin: np.ndarray, *rest: np.ndarray) -> np.ndarray:
        looked.append(len(begin))
        return meets_origin(begin, *rest)

    monkeypatch.setattr("radmpc.flying.model.meets_origin", counting)
    places = [[10.0 * i, 3.0 * j] for i in range(10) for j in range(2)]
    model = Model(replace(fleet_at(np.array(places)), avoidance="steps"), 0)
    model.reset()
    assert looked == [0]
    model = Model(replace(fleet_at(np.array(places) * [1.0, 0.2]), avoidance="steps"), 0)
    assert len(model.reset()[1]) == 10
    assert looked == [0, 10]
