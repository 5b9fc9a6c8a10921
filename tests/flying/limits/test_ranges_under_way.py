"""Ranges that are kept under way: flown by the rule, and lost."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from range_scenes import NAMES, WITHIN, abreast, escorted, within

import radmpc
from radmpc.flying.flight import fly
from radmpc.flying.mission import Mission
from radmpc.flying.model import Model
from radmpc.flying.receding.guide import _coarsened
from radmpc.flying.receding.long_mission import LongMission
from radmpc.flying.tick import Contact
from radmpc.flying.warm.search import Try, WarmSearch
from radmpc.model.vehicle import Goal
from radmpc.referee.simulation.preparation import prepare

RANGE = 4
"""Where samples that lose a range stand among those that a simulation counts."""


@pytest.mark.slow
@pytest.mark.parametrize("avoidance", ["steps", "intervals"])
def test_the_model_finds_ranges_lost_that_simulation_does_mission_by_mission(
    avoidance: str,
) -> None:
    plan = abreast(avoidance, 3.75)
    simulated = prepare(plan)
    seeds = np.random.SeedSequence(5).spawn(40)
    theirs = [bool(simulated.count(1, seed)[RANGE]) for seed in seeds]
    ours = []
    for seed in seeds:
        flight = fly(Mission(plan, planner=None), Model(plan.scenario, np.random.default_rng(seed)))
        assert {(c.cause, c.vehicle, c.other) for c in flight.contacts} <= {("range", *NAMES)}
        ours.append(bool(flight.contacts))
    assert 2 <= sum(theirs) <= 38
    assert ours == theirs


@pytest.mark.sampled(1)
@pytest.mark.slow
@pytest.mark.parametrize(
    ("avoidance", "is_warm"), [("steps", False), ("steps", True), ("intervals", True)]
)
def test_a_fleet_that_is_planned_anew_keeps_its_range(avoidance: str, is_warm: bool) -> None:
    plan = radmpc.plan(escorted(avoidance), rng=0).require()
    mission = Mission(plan, planner=None if is_warm else "certified", warm=is_warm)
    model = Model(plan.scenario, 4)
    states, contacts = model.reset()
    adopted = 0
    while not mission.is_over:
        tick = mission.step(states, contacts=contacts)
        before, after = mission.account[-2:]
        if tick.choice == "candidate":
            adopted += 1
            assert after.price is not None
            assert after.bank == pytest.approx(tick.wealth - after.price, rel=1e-5)
            leg = mission.leg.plan
            one, two = (path.means[:, :2] for path in leg.trajectories)
            assert np.linalg.norm(one - two, axis=1).max() < WITHIN
            causes = {row.cause for row in radmpc.certify(leg).ledger}
            assert "range" in causes
        else:
            assert after.bank == before.bank
        if tick.segments:
            states, contacts = model.advance(tick.segments)
    assert adopted >= 4
    assert not mission.contacts


def test_what_a_range_risks_is_part_of_what_a_tail_is_worth() -> None:
    plan = abreast("steps", 3.8)
    near, apart = (Mission(plan, planner=None) for _ in range(2))
    starts = [v.start for v in plan.scenario.vehicles]
    off = [starts[0], starts[1] + [0.0, 0.2, 0.0, 0.1]]
    values = [m.step(states).value for m, states in ((near, starts), (apart, off))]
    assert values[1] > 1.5 * values[0] > 0.01


def test_a_range_that_was_lost_leaves_the_tail_and_is_named_for_what_it_is() -> None:
    plan = abreast("steps", 4.6)
    mission = Mission(plan)
    starts = [v.start for v in plan.scenario.vehicles]
    tick = mission.step(starts, contacts=[Contact(0, "range", *NAMES)])
    assert (tick.choice, tick.reason) == ("tail", "a range was lost")
    assert mission.has_failed
    tick = mission.step(mission._expected, contacts=[Contact(1, "pair", *NAMES)])
    assert tick.reason == "something was hit"


def test_vehicles_far_apart_that_keep_a_range_share_a_program() -> None:
    plan = abreast("intervals", 3.4 + 20.0)
    free = replace(plan.scenario, keep=())
    controls = tuple(path.controls for path in plan.trajectories)
    groups = []
    for scenario in (plan.scenario, free):
        search = WarmSearch(scenario)
        starts = tuple(replace(v, initial_covariance=0.0) for v in scenario.vehicles)
        left = replace(scenario, vehicles=starts)
        search.search(Try(left, controls, is_safest=False, is_stopped=lambda: False))
        groups.append(search._groups)
    assert groups == [((0, 1),), ((0,), (1,))]


def test_a_coarse_guide_leaves_ranges_room_for_noise() -> None:
    scenario = escorted(horizon=12)
    coarse = _coarsened(scenario, 2, (6, 2.0))
    [kept] = coarse.keep
    grown = sum(
        w.radius - v.radius for v, w in zip(scenario.vehicles, coarse.vehicles, strict=True)
    )
    assert 0.0 < grown < 1.0
    assert kept.within == pytest.approx(WITHIN - grown)
    [least] = _coarsened(within(scenario, 0.1), 2, (6, 2.0)).keep
    assert least.within == 0.05


@pytest.mark.slow
def test_windows_of_a_long_mission_keep_a_range() -> None:
    scenario = replace(escorted(horizon=16, noise=4e-4), obstacles=())
    lead, wing = scenario.vehicles
    # It may be behind at its goal, and has to keep up on the way.
    wing = replace(wing, goal=Goal.at([22.0, 3.0], 0.5))
    scenario = replace(scenario, vehicles=(lead, wing))
    mission = LongMission(scenario, window=8, overlap=3)
    flight = fly(mission, Model(scenario, 2))
    assert not mission.is_stranded
    assert not flight.contacts
    apart = [np.linalg.norm(a[:2] - b[:2]) for a, b in flight.states]
    assert max(apart) <= WITHIN
