"""A new account under way: what is known goes on, what the mission did not know of comes in."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from noisy_scenes import (
    SCENES,
    beside,
    estimated_as_another_sees,
    estimated_in_a_new_wind_and_unsure,
    gusty_and_estimated,
    steered,
)
from test_flown_noise import waiting

import radmpc
from radmpc.errors import ArgumentError, ArgumentTypeError, RiskError, ScenarioError
from radmpc.flying.mission import Mission
from radmpc.flying.model import Model
from radmpc.flying.receding.long_mission import LongMission
from radmpc.flying.sensing.evidence import Evidence
from radmpc.flying.sensing.measurements import Sensing
from radmpc.flying.tick import Contact, Tick
from radmpc.model.obstacle import Obstacle
from radmpc.model.plan import Plan
from radmpc.model.scenario import Scenario

STEPS, BEGINS, ANEW = 5, 2, 3
ROCK = Obstacle.box("rock", [700.0, 300.0], [710.0, 310.0])


class Waiting:
    """Plans to wait for what is left of some numbers of steps, and keeps what it was asked."""

    def __init__(self, *horizons: int) -> None:
        self.horizons = horizons
        self.asked: list[Scenario] = []

    def __call__(self, scenario: Scenario, seconds: float | None) -> Plan | None:
        self.asked.append(scenario)
        return waiting(scenario, wasted=0.0) if scenario.horizon in self.horizons else None


def flown(
    mission: Mission, scenario: Scenario, again: Callable[[Scenario], Plan] | None = None
) -> list[Tick]:
    """Fly a mission, and where asked begin anew at a step with a plan of what is left."""
    model, ticks = Model(scenario, 0), []
    states, contacts = model.reset()
    while not mission.is_over:
        if again is not None and len(ticks) == BEGINS:
            mission.start_again(again(mission.remainder(states)))
        ticks.append(mission.step(states, contacts=contacts))
        if ticks[-1].segments:
            states, contacts = model.advance(ticks[-1].segments)
    return ticks


def apart(one: list[Tick], other: list[Tick]) -> float:
    """Return by how much two flights differ after their third step, and what is left of them."""
    found = []
    for a, b in zip(one[BEGINS:-1], other[BEGINS:-1], strict=True):
        found += [float(np.abs(x - y).max()) for x, y in zip(a.controls, b.controls, strict=True)]
        if a.step > BEGINS:
            found.append(abs(a.value - b.value) / max(b.value, 1e-9))
    return max(found)


def both(scenario: Scenario) -> tuple[list[Tick], list[Tick]]:
    """Fly with plans that are adopted, and with the first of them as a new grant instead."""
    plan = waiting(scenario)
    at_once = Mission(plan, planner=Waiting(STEPS - BEGINS, STEPS - ANEW), share=1.0)
    anew = Mission(plan, planner=Waiting(STEPS - ANEW), share=1.0)
    one = flown(at_once, scenario)
    other = flown(anew, scenario, lambda left: waiting(left, wasted=0.0))
    assert [e.step for e in at_once.account if e.what == "adopted"] == [BEGINS, ANEW]
    assert [(e.step, e.what) for e in anew.account if e.what != "kept"][1:] == [
        (BEGINS, "new grant"),
        (ANEW, "adopted"),
    ]
    return one, other


@pytest.mark.sampled(5)
@pytest.mark.parametrize("scene", SCENES)
def test_a_plan_of_what_is_left_is_worth_the_same_as_a_new_grant(scene) -> None:
    one, other = both(steered(scene))
    assert apart(one, other) < 1e-6
    assert not [alarm for tick in other for alarm in tick.alarms]


def forgets_what_lasts(patch: pytest.MonkeyPatch) -> None:
    """Of what is left only states are known, and these exactly."""
    right = Mission.remainder

    def wrong(self, states):
        left = right(self, states)
        vehicles = [replace(v, belief=None, initial_covariance=0.0) for v in left.vehicles]
        return replace(left, vehicles=vehicles)

    patch.setattr(Mission, "remainder", wrong)


def forgets_the_factor(patch: pytest.MonkeyPatch) -> None:
    """The new leg's covariances count as stated."""
    right = Sensing.begin_again

    def wrong(self, leg, *given):
        return leg, right(self, leg, *given)[1]

    patch.setattr(Sensing, "begin_again", wrong)


@pytest.mark.parametrize(
    ("mutant", "scene"),
    [
        (forgets_what_lasts, gusty_and_estimated),
        (forgets_the_factor, estimated_in_a_new_wind_and_unsure),
    ],
)
def test_a_new_grant_that_forgets_is_found_out(mutant, scene, monkeypatch) -> None:
    mutant(monkeypatch)
    one, other = both(steered(scene))
    assert apart(one, other) > 1e-4


@pytest.mark.sampled(5)
@pytest.mark.parametrize("scene", SCENES)
def test_plans_after_a_new_grant_know_of_what_was_added(scene) -> None:
    scenario = steered(scene)
    planner = Waiting()
    mission = Mission(waiting(scenario), planner=planner)

    def with_rock(left: Scenario) -> Plan:
        return waiting(replace(left, obstacles=(*left.obstacles, ROCK)), wasted=0.0)

    flown(mission, scenario, with_rock)
    names = [[obstacle.name for obstacle in asked.obstacles] for asked in planner.asked]
    assert [("rock" in each) for each in names] == [False] * BEGINS + [True] * (STEPS - BEGINS)
    left = planner.asked[-1]
    assert [o.name for o in scenario.obstacles] == [o.name for o in left.obstacles[:-1]]


def test_who_forgets_what_was_added_is_found_out(monkeypatch) -> None:
    monkeypatch.setattr(Evidence, "elsewhere", lambda self, *_: self)
    with pytest.raises(AssertionError):
        test_plans_after_a_new_grant_know_of_what_was_added(estimated_as_another_sees)


def stormy(scenario: Scenario) -> Scenario:
    """Return a scenario with four times the disturbances."""
    vehicles = (
        replace(v, disturbance_covariance=4.0 * v.disturbance_covariance) for v in scenario.vehicles
    )
    return replace(scenario, vehicles=tuple(vehicles))


@pytest.mark.parametrize("scene", SCENES)
def test_noise_that_changed_is_that_of_later_plans_or_refused_in_one_line(scene) -> None:
    scenario = steered(scene)
    planner = Waiting()
    mission = Mission(waiting(scenario), planner=planner)
    states = [v.start for v in scenario.vehicles]
    storm = stormy(mission.remainder(states))
    if any(v.shared and v.measurement is not None for v in scenario.vehicles):
        with pytest.raises(ScenarioError, match="learn of each other"):
            mission.start_again(waiting(storm, wasted=0.0))
        return
    mission.start_again(waiting(storm, wasted=0.0))
    mission.step(states)
    [asked] = planner.asked
    for given, told in zip(storm.vehicles, asked.vehicles, strict=True):
        np.testing.assert_allclose(
            told.disturbance_covariance, given.disturbance_covariance, rtol=0.2
        )


def test_what_was_announced_is_no_sign_against_the_model() -> None:
    scenario = steered(beside)
    mission = Mission(waiting(scenario), planner=None)
    [start] = [v.start for v in scenario.vehicles]
    deviation = np.sqrt(scenario.vehicles[0].disturbance_covariance[0, 0])
    mission.start_again(waiting(stormy(mission.remainder([start])), wasted=0.0))
    assert not mission.step([start]).alarms
    # Six deviations of before, three by now.
    aside = np.array([deviation, 0.0])
    assert not mission.step([start + 6.0 * aside]).alarms
    alarms = mission.step([start + 17.0 * aside]).alarms
    assert any("a disturbance of" in alarm for alarm in alarms)


def test_a_step_is_measured_once() -> None:
    scenario = steered(SCENES[0])
    mission = Mission(waiting(scenario), planner=None)
    states = [v.start for v in scenario.vehicles]
    mission.remainder(states)
    with pytest.raises(ArgumentError, match=r"states\[0\] must be as this step was measured"):
        mission.step([state + 5.0 for state in states])
    mission.step(states)


def test_after_a_new_grant_what_was_hit_before_is_past() -> None:
    scenario = steered(SCENES[0])
    mission = Mission(waiting(scenario), planner=Waiting(STEPS - 1, STEPS - 2))
    states = [v.start for v in scenario.vehicles]
    hit = Contact(1, "obstacle", "v", "wall")
    mission.step(states)
    assert mission.step(states, contacts=[hit]).reason == "something was hit"
    assert mission.has_failed
    mission.start_again(waiting(mission.remainder(states)))
    assert mission.contacts == (hit,)
    assert not mission.has_failed
    assert mission.step(states).reason != "something was hit"


def test_what_was_learned_is_written_to_no_file(tmp_path) -> None:
    scenario = steered(gusty_and_estimated)
    mission = Mission(waiting(scenario), planner=None)
    left = mission.remainder([v.start for v in scenario.vehicles])
    with pytest.raises(ScenarioError, match="what was learned under way is in no file"):
        radmpc.save_scenario(left, tmp_path / "left.yaml")
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("scene", [gusty_and_estimated, estimated_as_another_sees])
def test_what_is_left_is_a_long_mission_too(scene) -> None:
    scenario = steered(scene)
    mission = Mission(waiting(scenario), planner=None)
    left = mission.remainder([v.start for v in scenario.vehicles])
    windows = LongMission(left, window=3, overlap=1, planner=Waiting(3))
    assert windows.scenario is left


def test_what_is_left_may_be_given_another_bound() -> None:
    scenario = steered(SCENES[0])
    mission = Mission(waiting(scenario), planner=None)
    states = [v.start for v in scenario.vehicles]
    left = mission.remainder(states, risk_bound=0.3)
    assert (left.horizon, left.risk_bound) == (STEPS, 0.3)
    assert mission.remainder(states).risk_bound == 0.49
    mission.step(states)
    assert mission.remainder(states).horizon == STEPS - 1


def test_what_cannot_begin_anew_is_refused_in_one_line() -> None:
    scenario = steered(estimated_as_another_sees)
    plan = waiting(scenario)
    mission = Mission(plan, planner=None)
    states = [v.start for v in scenario.vehicles]
    with pytest.raises(ScenarioError, match=r"plan the mission's remainder\(states\)") as caught:
        mission.start_again(plan)
    assert "\n" not in str(caught.value)
    with pytest.raises(ArgumentError, match="states must be finite"):
        mission.remainder([np.full_like(state, np.nan) for state in states])
    with pytest.raises(ArgumentTypeError, match="risk_bound must be a number, got 'x'"):
        mission.remainder(states, risk_bound="x")
    with pytest.raises(ArgumentTypeError, match="states must be a sequence of states, got 'ab'"):
        mission.remainder("ab")
    with pytest.raises(RiskError, match=r"above 0 and below 0\.5, got 0\.7"):
        mission.remainder(states, risk_bound=0.7)
    flown(mission, scenario)
    with pytest.raises(ArgumentError, match="no step of the 5 is left to plan"):
        mission.remainder(states)
