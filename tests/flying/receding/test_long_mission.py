"""Missions longer than a window: what they may risk, and what becomes of them."""

from __future__ import annotations

import re
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from executors import steering
from slalom import slalom

from radmpc.errors import ArgumentError, ArgumentTypeError, NoPlanError, RiskError
from radmpc.experiments.families import paper
from radmpc.flying.flight import fly
from radmpc.flying.leg import leg_of
from radmpc.flying.model import Model
from radmpc.flying.receding.itinerary import Guide, Itinerary
from radmpc.flying.receding.long_mission import LongMission
from radmpc.flying.receding.reserve import Reserve
from radmpc.flying.remainder import left_of
from radmpc.flying.tick import Contact
from radmpc.model.goal import Goal
from radmpc.model.obstacle import Obstacle
from radmpc.model.plan import Plan
from radmpc.model.scenario import Scenario


def far(horizon: int = 24) -> Scenario:
    """Return a vehicle with a long way to go and nothing in it."""
    (vehicle,) = paper(1, 1).vehicles
    goal = Goal.at(vehicle.start[:2] + np.array([0.8 * horizon, 4.0]), 0.5, 0.5)
    scenario = replace(paper(1, 1), horizon=horizon, obstacles=(), workspace=None)
    return replace(scenario, vehicles=(replace(vehicle, goal=goal),))


def straight(scenario: Scenario) -> Guide:
    """Return a guide at even speed from start to goal."""

    def goals(step: int) -> list[Goal]:
        if step >= scenario.horizon:
            return [v.goal for v in scenario.vehicles]
        share = step / scenario.horizon
        return [
            Goal.at((1.0 - share) * v.start[:2] + share * v.goal.center, 0.5, None)
            for v in scenario.vehicles
        ]

    return goals


# The arithmetic: windows have shares of one account.


def played(steps: int, window: int, bound: float, reserve: type[Reserve]) -> float:
    """Return the probability that one hits who stakes all of a window on its first step."""
    kept, alive, wealth = reserve(bound), 1.0, 0.0
    for step in range(0, steps, window):
        grant = kept.grant(wealth, window, steps - step, 0.49)
        kept = kept.given(wealth, grant)
        alive *= 1.0 - grant
        wealth = 0.0
    return 1.0 - alive


class Anew(Reserve):
    """Grants every window all of the bound."""

    def grant(self, wealth: float, window: int, left: int, most: float) -> float:
        return 0.05

    def given(self, wealth: float, bound: float) -> Reserve:
        return self


class Twice(Reserve):
    """Leaves what a window is given where it was."""

    def given(self, wealth: float, bound: float) -> Reserve:
        return Twice(wealth + self.amount)


@pytest.mark.parametrize("window", [1, 3, 7, 20])
def test_windows_together_risk_no_more_than_the_bound(window: int) -> None:
    assert played(20, window, 0.05, Reserve) <= 0.05 * (1.0 + 1e-12)


@pytest.mark.parametrize("wrong", [Anew, Twice])
def test_windows_that_are_given_risk_anew_together_risk_more(wrong: type[Reserve]) -> None:
    assert played(20, 2, 0.05, wrong) > 0.09


def test_what_a_window_did_not_need_goes_to_the_next() -> None:
    kept = Reserve(0.06).given(0.0, Reserve(0.06).grant(0.0, 5, 15, 0.49))
    assert kept.amount == pytest.approx(0.04)
    # Good news left 0.01 of it.
    assert kept.grant(0.01, 5, 10, 0.49) == pytest.approx(0.025)
    assert kept.given(0.01, 0.025).amount == pytest.approx(0.025)
    # Bad news is worth more than Δ: a window takes no more than it can.
    assert kept.grant(2.0, 5, 10, 0.49) == 0.49
    with pytest.raises(RiskError, match=r"at most the 0\.05 that is left, got 0\.051"):
        kept.given(0.01, 0.051)


# Flights.


def test_a_long_mission_flies_window_by_window_to_its_goal() -> None:
    scenario = far()
    mission = LongMission(
        scenario, window=8, overlap=3, guide=straight(scenario), planner=steering, warm=True
    )
    flight = fly(mission, Model(scenario, 2))
    assert len(flight.states) == 25
    assert [t.step for t in flight.ticks] == list(range(25))
    assert not mission.is_stranded
    opened = [e.step for e in flight.account if e.what in {"opened", "window"}]
    assert opened == [0, 5, 10, 15, 20][: len(opened)]
    assert len(opened) >= 4
    miss = np.linalg.norm(flight.states[-1][0][:2] - scenario.vehicles[0].goal.center)
    assert miss < 1.5
    # Nothing was in the way: what there was at first is there at the end.
    assert all(e.bank + e.tail <= scenario.risk_bound * (1.0 + 1e-9) for e in flight.account)
    assert flight.account[-1].wealth == pytest.approx(scenario.risk_bound, rel=1e-3)


def test_a_mission_without_a_next_window_flies_the_last_one_to_its_end() -> None:
    scenario = far()
    asked = []

    def once(scene: Scenario, seconds: float | None) -> Plan | None:
        asked.append(scene.horizon)
        return steering(scene, seconds) if len(asked) == 1 else None

    mission = LongMission(
        scenario, window=8, overlap=3, guide=straight(scenario), planner=once, warm=False
    )
    flight = fly(mission, Model(scenario, 2))
    assert mission.is_stranded
    assert mission.is_over
    assert len(flight.states) == 9
    # Not "the mission is at its end".
    end = "the mission is stranded after 8 of 24 steps: no next window: no plan was found from here"
    assert flight.ticks[-1].reason == end
    with pytest.raises(ArgumentError, match=f"^{end}$"):
        mission.step(flight.states[-1])
    assert repr(mission) == (
        "LongMission('paper-1-1': stranded after 8 steps; remaining risk 0.05 of Δ = 0.05; "
        "no collision)"
    )
    # Asked for the next window at steps 5 to 8, and for better ones of its own at every step.
    assert asked.count(8) == 6


def test_a_window_that_costs_more_than_its_share_is_not_begun() -> None:
    scenario = slalom(0.1, gates=3)
    wide = [Goal.at([7.0, 0.0], 50.0, None)]

    def reckless(scene: Scenario, seconds: float | None) -> Plan:
        # Straight through the blocks.
        controls = np.zeros((scene.horizon, 2))
        controls[:, 0] = 0.9
        return leg_of(scene, [controls], 0).plan

    why = "no plan of the first 4 steps was found within their risk: the plan costs 2, its share"
    with pytest.raises(NoPlanError, match=why):
        LongMission(scenario, window=4, overlap=1, guide=lambda step: wide, planner=reckless)


def test_windows_see_obstacles_as_they_are_by_then() -> None:
    outlines = [[[k, 9.0], [k + 1.0, 9.0], [k, 10.0]] for k in range(25)]
    scenario = replace(far(), obstacles=(Obstacle.moving("ferry", outlines),))
    states = tuple(v.start for v in scenario.vehicles)
    itinerary = Itinerary.given(scenario, straight(scenario))
    ahead = itinerary.until(14)
    scene = left_of(ahead, 6, states, 0.01)
    assert scene.horizon == 8
    assert scene.obstacles[0].at(0)[0].vertices.min() == pytest.approx(6.0)
    assert len(scene.obstacles[0].shape.outlines) == 9
    assert not scene.vehicles[0].initial_covariance.any()
    goal, mine = itinerary.until(24).vehicles[0].goal, scenario.vehicles[0].goal
    np.testing.assert_array_equal([goal.lower, goal.upper], [mine.lower, mine.upper])


@pytest.mark.slow
def test_a_guide_leads_around_what_is_in_the_way() -> None:
    scenario = far(20)
    (vehicle,) = scenario.vehicles
    middle = 0.5 * (vehicle.start[:2] + vehicle.goal.center)
    block = Obstacle.box("block", middle - 1.5, middle + 1.5)
    scenario = replace(scenario, obstacles=(block,))
    guide = Itinerary.planned(scenario, 8).guide
    places = np.array([guide(step)[0].center for step in range(20)])
    outside = np.maximum(np.abs(places - middle) - 1.5, 0.0)
    assert np.linalg.norm(outside, axis=1).min() > vehicle.radius
    assert guide(20)[0] is vehicle.goal


@pytest.mark.slow
def test_a_long_mission_passes_what_is_in_its_way() -> None:
    scenario = far(12)
    (vehicle,) = scenario.vehicles
    middle = 0.5 * (vehicle.start[:2] + vehicle.goal.center)
    block = Obstacle.box("block", middle - 1.0, middle + 1.0)
    scenario = replace(scenario, obstacles=(block,))
    mission = LongMission(scenario, window=6, overlap=3)
    flight = fly(mission, Model(scenario, 4))
    assert not mission.is_stranded
    assert not flight.contacts
    assert sum(e.what in {"opened", "window"} for e in flight.account) >= 3
    assert all(e.wealth >= 0.0 for e in flight.account)


def test_windows_must_be_windows() -> None:
    scenario = far()
    with pytest.raises(ArgumentError, match="overlap must be below the window of 8, got 8"):
        LongMission(scenario, window=8, overlap=8, planner=steering)
    with pytest.raises(ArgumentError, match="window"):
        LongMission(scenario, window=1, overlap=1, planner=steering)


def test_an_alarm_of_a_window_names_its_share_of_the_bound() -> None:
    scenario = far()
    start = scenario.vehicles[0].start
    box = Obstacle.box("box", start[:2] + np.array([0.0, 6.0]), start[:2] + 9.0)
    scenario = replace(scenario, obstacles=(box,))
    mission = LongMission(
        scenario, window=8, overlap=3, guide=straight(scenario), planner=steering, warm=False
    )
    mission.step([start])
    alarms = mission.step([start + np.array([1.0, 6.0, 0.0, 1.0])]).alarms
    [told] = [alarm for alarm in alarms if alarm.startswith("what is left risks")]
    assert re.search(r"more than the window's share of Δ, 0\.0\d+$", told)


def test_a_step_beyond_the_end_names_the_whole_mission_and_keeps_no_contact() -> None:
    scenario = far(10)
    mission = LongMission(
        scenario, window=8, overlap=3, guide=straight(scenario), planner=steering, warm=False
    )
    flight = fly(mission, Model(scenario, 2))
    with pytest.raises(ArgumentError, match="the mission of 10 steps is over"):
        mission.step(flight.states[-1], contacts=[Contact(10, "obstacle", "0", "late")])
    assert mission.contacts == ()


def test_a_step_of_a_stranded_mission_says_how_far_it_came() -> None:
    scenario, plans = far(), []

    def once(scene: Scenario, seconds: float | None) -> Plan | None:
        plans.append(scene)
        return steering(scene, seconds) if len(plans) == 1 else None

    mission = LongMission(
        scenario, window=8, overlap=3, guide=straight(scenario), planner=once, warm=False
    )
    flight = fly(mission, Model(scenario, 2))
    with pytest.raises(ArgumentError, match="stranded after 8 of 24 steps: no next window"):
        mission.step(flight.states[-1])


def test_windows_need_a_planner_and_a_guide_that_can_be_asked() -> None:
    scenario = far()
    with pytest.raises(ArgumentTypeError, match="planner must be a name or a function, got None"):
        LongMission(scenario, window=8, overlap=3, planner=None)  # type: ignore[arg-type] # wrong
    with pytest.raises(ArgumentTypeError, match="guide must be a function or None, got 3"):
        LongMission(scenario, window=8, overlap=3, guide=3)  # type: ignore[arg-type] # wrong


@pytest.mark.parametrize("wrong", [3, [], [[1.0, 2.0]]])
def test_what_a_guide_returns_must_be_a_goal_of_every_vehicle(wrong: Any) -> None:
    scenario = far()

    def guide(step: int) -> Any:
        return wrong

    with pytest.raises(
        ArgumentTypeError, match=r"guide\(8\) must return a list or tuple of 1 Goal"
    ):
        LongMission(scenario, window=8, overlap=3, guide=guide, planner=steering)


def test_a_guide_of_ones_own_leaves_the_goals_of_the_mission_as_they_are() -> None:
    scenario = far(10)
    lost = [Goal.at([-99.0, -99.0], 0.5, None)]
    given = Itinerary.given(scenario, lambda step: lost)
    assert given.until(8).vehicles[0].goal is not scenario.vehicles[0].goal
    assert np.array_equal(given.until(8).vehicles[0].goal.center, [-99.0, -99.0])
    assert np.array_equal(given.until(10).vehicles[0].goal.center, scenario.vehicles[0].goal.center)
