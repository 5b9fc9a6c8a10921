"""Missions of many windows that go on with what is known: gusts, estimates, factors, tracks."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from itertools import count

import numpy as np
import pytest
from noisy_scenes import (
    SCENES,
    blown_and_unsure,
    estimated,
    estimated_as_another_sees,
    gusty,
    steered,
)
from test_flown_noise import waiting

from radmpc import lqr_gain
from radmpc.experiments.families import paper
from radmpc.flying.flight import Flight, fly
from radmpc.flying.mission import Mission
from radmpc.flying.model import Model
from radmpc.flying.receding import long_mission
from radmpc.flying.receding.itinerary import Itinerary
from radmpc.flying.receding.long_mission import LongMission
from radmpc.flying.receding.window import Window
from radmpc.flying.sensing.observing import Observer
from radmpc.model.goal import Goal
from radmpc.model.noise.measurement import Measurement
from radmpc.model.noise.shared import SharedDisturbance
from radmpc.model.obstacle import Obstacle
from radmpc.model.plan import Plan
from radmpc.model.scenario import Scenario
from radmpc.referee.conditional.scales import Scale

BEGINS = 2


def asked(*calls: int) -> Callable[[Scenario, float | None], Plan | None]:
    """Return a planner that waits at some of the times it is asked, and has no plan at others."""
    times = count()

    def planning(scenario: Scenario, seconds: float | None) -> Plan | None:
        return waiting(scenario, wasted=0.0) if next(times) in calls else None

    return planning


def in_windows(scenario: Scenario, seed: int) -> tuple[LongMission, Flight]:
    """Fly four steps, and from the third on what is left."""
    mission = LongMission(
        scenario,
        window=4,
        overlap=2,
        guide=lambda step: [v.goal for v in scenario.vehicles],
        planner=asked(0, 3),  # for the window, at two steps within it, for the next one
    )
    return mission, fly(mission, Model(scenario, seed))


def at_once(scenario: Scenario, seed: int) -> Flight:
    """Fly the same as one mission, planned anew at the third step."""
    mission = Mission(waiting(scenario), planner=asked(2), share=1.0)
    flight = fly(mission, Model(scenario, seed))
    assert [e.step for e in flight.account if e.what == "adopted"] == [BEGINS]
    return flight


def apart(one: Flight, other: Flight) -> float:
    """Return by how much two flights differ in what is left of them, and where they lead."""
    values = [
        abs(a.value - b.value) / max(b.value, 1e-9)
        for a, b in zip(one.ticks[BEGINS + 1 : -1], other.ticks[BEGINS + 1 : -1], strict=True)
    ]
    places = [
        float(np.abs(a - b).max())
        for x, y in zip(one.states[BEGINS:], other.states[BEGINS:], strict=True)
        for a, b in zip(x, y, strict=True)
    ]
    return max(*values, *places)


@pytest.mark.sampled(4)
@pytest.mark.parametrize("scene", SCENES)
def test_a_window_is_worth_what_the_same_leg_is_within_one_mission(scene) -> None:
    scenario = steered(scene)
    for seed in range(2):
        mission, flight = in_windows(scenario, seed)
        assert [e.step for e in flight.account if e.what == "window"] == [BEGINS]
        assert not mission.is_stranded
        assert apart(flight, at_once(scenario, seed)) < 1e-6
        assert not [alarm for tick in flight.ticks for alarm in tick.alarms]


@pytest.mark.parametrize("scene", [gusty, blown_and_unsure])
def test_windows_remember_what_speaks_against_the_model(scene) -> None:
    scenario = steered(scene)
    mission, _ = in_windows(scenario, 3)
    within_one = Mission(waiting(scenario), planner=asked(2), share=1.0)
    fly(within_one, Model(scenario, 3))
    told = [total for total, _, _ in mission._mission._sensing.watcher.squares]
    assert told == pytest.approx([t for t, _, _ in within_one._sensing.watcher.squares], rel=1e-9)


def states_taken_for_known(monkeypatch: pytest.MonkeyPatch) -> None:
    right = long_mission.scene_of

    def wrong(*given):
        scene, *rest = right(*given)
        vehicles = [replace(v, belief=None, initial_covariance=0.0) for v in scene.vehicles]
        return replace(scene, vehicles=vehicles), *rest

    monkeypatch.setattr(long_mission, "scene_of", wrong)


def factors_forgotten(monkeypatch: pytest.MonkeyPatch) -> None:
    right = Window.handover

    def wrong(self, states):
        found = right(self, states)
        stated = Scale(self.scenario.covariance_samples)
        return replace(found, evidence=replace(found.evidence, scale=stated))

    monkeypatch.setattr(Window, "handover", wrong)


def filters_begun_anew(monkeypatch: pytest.MonkeyPatch) -> None:
    right = Window.__init__

    def wrong(self, plan, ahead, began, before, **options):
        right(self, plan, ahead, began, before, **options)
        self._sensing.observer = Observer.of(plan.scenario)

    monkeypatch.setattr(Window, "__init__", wrong)


@pytest.mark.parametrize(
    ("scene", "mutant"),
    [
        (gusty, states_taken_for_known),
        (estimated, states_taken_for_known),
        (blown_and_unsure, factors_forgotten),
        (estimated_as_another_sees, filters_begun_anew),
    ],
)
def test_a_window_that_forgets_is_found_out(scene, mutant, monkeypatch) -> None:
    scenario = steered(scene)
    within_one = at_once(scenario, 0)
    mutant(monkeypatch)
    _, flight = in_windows(scenario, 0)
    assert apart(flight, within_one) > 1e-4


def crossing() -> Scenario:
    """Return a boat in a gust that goes by a freighter, and knows neither place exactly."""
    [vehicle] = paper(1, 1).vehicles
    start = np.array([0.0, 0.0, 0.0, 0.0])
    gust = SharedDisturbance("gust", np.eye(4), np.diag([0.0, 0.0, 1e-5, 1e-5]), 0.8)
    sensor = Measurement(np.eye(4)[:2], 1e-3 * np.eye(2))
    boat = replace(vehicle, start=start, goal=Goal.at([9.0, 0.0], 0.5, 0.5), shared=(gust,))
    boat = replace(boat, measurement=sensor, gain=lqr_gain(boat.system, np.eye(4), np.eye(2)))
    outline = [[-0.8, -0.8], [0.8, -0.8], [0.8, 0.8], [-0.8, 0.8]]
    spread = [0.01, 0.01, 1e-4, 1e-4]
    freighter = Obstacle.tracked("freighter", outline, [4.5, -3.0, 0.0, 0.25], spread)
    scenario = replace(paper(1, 1), horizon=12, workspace=None, vehicles=(boat,), obstacles=())
    return replace(scenario, obstacles=(freighter,))


@pytest.mark.slow
def test_windows_lead_a_boat_in_a_gust_past_who_strays() -> None:
    scenario = crossing()
    mission = LongMission(scenario, window=6, overlap=3)
    flight = fly(mission, Model(scenario, 4))
    assert not mission.is_stranded
    assert not flight.contacts
    # Bad news is an alarm, too; nothing speaks against the model.
    alarms = [alarm for tick in flight.ticks for alarm in tick.alarms]
    assert not [alarm for alarm in alarms if not alarm.startswith("what is left risks")]
    assert sum(e.what in {"opened", "window"} for e in flight.account) >= 3
    assert all(tick.value is not None for tick in flight.ticks)
    miss = np.linalg.norm(flight.states[-1][0][:2] - scenario.vehicles[0].goal.center)
    assert miss < 1.5


@pytest.mark.slow
def test_a_guide_keeps_off_where_somebody_may_stray_to() -> None:
    scenario = crossing()
    guide = Itinerary.planned(scenario, 6).guide
    [freighter] = scenario.obstacles
    assert freighter.spread is not None
    for step in range(13):
        place = guide(step)[0].center
        [outline] = freighter.at(step)
        away = np.maximum(
            outline.vertices.min(axis=0) - place, place - outline.vertices.max(axis=0)
        )
        assert away.max() > freighter.spread.deviation(step)
