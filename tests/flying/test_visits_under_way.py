"""Visits and windows of arrival of a mission that is planned anew."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import radmpc
from radmpc.flying.leg import leg_of
from radmpc.flying.mission import Mission
from radmpc.flying.model import Model
from radmpc.flying.recording.recomputing import recomputed
from radmpc.flying.recording.recorded import RecordedMission
from radmpc.flying.recording.summary import summary_of
from radmpc.flying.remainder import left_of
from radmpc.flying.visiting import still_due
from radmpc.model.plan import Plan
from radmpc.model.scenario import Scenario

STEPS = 9
FIRST, SECOND = radmpc.Visit.at([4.0, 2.0], 1.0), radmpc.Visit.at([12.0, -2.0], 1.0, [4, 7])


def buoys(noise: float = 1e-3, **values: object) -> Scenario:
    """Return a boat with two buoys on its way that may arrive at any of the last steps."""
    system = radmpc.double_integrator(1.0, dimension=2)
    boat = radmpc.Vehicle(
        name="boat",
        system=system,
        start=[0.0, 0.0],
        goal=radmpc.Goal.at([16.0, 0.0], 1.0, within=[7, 9]),
        radius=0.4,
        control_limit=1.5,
        initial_covariance=noise,
        disturbance_covariance=noise,
        gain=radmpc.lqr_gain(system, np.eye(4), 10.0 * np.eye(2)),
        via=[FIRST, SECOND],
    )
    rock = radmpc.Obstacle.box("rock", [7.0, 4.0], [8.0, 6.0])
    return Scenario("buoys", 1.0, STEPS, 0.01, [boat], [rock], avoidance="steps", **values)


def visited(states: list[np.ndarray], visit: radmpc.Visit, slack: float) -> list[int]:
    """Return the steps at which a flown path is within a visit's box, or as far outside."""
    inside = [np.all((x[:2] > visit.lower - slack) & (x[:2] < visit.upper + slack)) for x in states]
    return [int(step) for step in np.flatnonzero(inside)]


@pytest.mark.parametrize("samples", [None, 500])
def test_a_fleet_that_is_planned_anew_makes_its_visits(samples) -> None:
    scenario = buoys(covariance_samples=samples)
    plan = radmpc.plan(scenario, rng=0).require()
    rows = []
    mission = RecordedMission(plan, 0, rows.append)
    flight = radmpc.fly(mission, Model(scenario, 3))
    assert sum(entry.what == "adopted" for entry in flight.account) >= 3
    assert not [tick.reason for tick in flight.ticks if "failed" in tick.reason]
    boat = [states[0] for states in flight.states]
    steps = [visited(boat, visit, 0.2) for visit in (FIRST, SECOND)]
    assert steps[0]
    assert set(steps[1]) & {4, 5, 6, 7}
    assert np.all(np.abs(boat[-1][:2] - [16.0, 0.0]) < 1.2)
    assert not recomputed(plan, rows).problems


def begun(scenario: Scenario) -> radmpc.flying.leg.Leg:
    """Return the leg of a plan."""
    controls = [path.controls for path in radmpc.plan(scenario, rng=0).require().trajectories]
    return leg_of(scenario, controls, 0)


def test_what_the_leg_in_the_air_has_visited_is_no_longer_due() -> None:
    scenario = buoys()
    leg = begun(scenario)
    path = leg.witnesses.motion.states[0]
    first = visited(list(path), FIRST, 1e-6)[0]
    second = next(step for step in visited(list(path), SECOND, 1e-6) if step >= 4)
    for step in range(1, STEPS):
        # Wherever it is: noise does not call it back.
        left = left_of(scenario, step, [path[step] + 3.0], 0.01)
        [boat] = still_due(left, leg, step).vehicles
        assert len(boat.via) == (step < first) + (step < second)
        if boat.via:
            assert boat.via[-1].between == (max(4 - step, 1), 7 - step)
            np.testing.assert_array_equal(boat.via[-1].lower, SECOND.lower)
        has_arrived = all(np.abs(path[step:, :2] - [16.0, 0.0]).max(axis=1) <= 1.0 + 1e-6)
        due = (1, STEPS - step) if has_arrived and step >= 7 else (max(7 - step, 1), 9 - step)
        assert boat.goal.within == due


def test_who_pays_for_time_does_not_adopt_what_comes_later() -> None:
    """Less effort alone is no reason: the leg in the air arrives two steps before."""
    early, late = buoys(1e-6, time_weight=50.0), buoys(1e-6)

    def slower(left: Scenario, seconds: float | None) -> Plan:
        return radmpc.plan(replace(left, time_weight=0.0), rng=0).require()

    adopted = {}
    for scenario in (early, late):
        plan = radmpc.plan(early, rng=0).require()
        mission = Mission(replace(plan, scenario=scenario), planner=slower)
        tick = mission.step([v.start for v in scenario.vehicles])
        adopted[scenario.time_weight] = tick.choice
    assert adopted == {50.0: "tail", 0.0: "candidate"}


def test_half_spaces_are_not_turned_between_visits_they_know_nothing_of() -> None:
    scenario = buoys()
    mission = Mission(radmpc.plan(scenario, rng=0).require(), planner=None, warm=True)
    tick = mission.step([v.start for v in scenario.vehicles])
    assert tick.reason == "there was nothing to choose from"


def test_effort_as_planned_and_as_flown_leave_out_what_time_costs() -> None:
    scenario = buoys(1e-6, time_weight=50.0)
    plan = radmpc.plan(scenario, rng=0).require()
    record = radmpc.begin_flight(plan, radmpc.FlightSettings(replan=None))
    summary = summary_of(record)
    assert plan.cost is not None
    assert plan.cost > 300.0
    assert summary.effort_planned < 20.0
    assert summary.effort == pytest.approx(summary.effort_planned, rel=0.01)


def test_who_goes_where_is_not_decided_again_under_way() -> None:
    system = radmpc.double_integrator(1.0, dimension=2)
    goals = [radmpc.Goal.at([6.0, y], 0.3, within=[3, 5]) for y in (0.0, 4.0)]
    fleet = [
        radmpc.Vehicle(
            name=name,
            system=system,
            start=[0.0, y],
            goal=goal,
            radius=0.3,
            control_limit=3.0,
            initial_covariance=1e-3,
            disturbance_covariance=1e-3,
        )
        for name, y, goal in zip("ab", (4.0, 0.0), goals, strict=True)
    ]
    result = radmpc.plan(radmpc.Scenario("berths", 1.0, 5, 0.1, fleet, goals=goals), rng=0)
    taken = [v.goal.center.tolist() for v in result.require().scenario.vehicles]
    assert taken == [[6.0, 4.0], [6.0, 0.0]]
    asked: list[Scenario] = []

    def planning(scenario: Scenario, seconds: float | None) -> radmpc.Result:
        asked.append(scenario)
        return radmpc.plan(scenario, rng=0, time_limit=seconds)

    mission = Mission(result, planner=planning)
    flight = radmpc.fly(mission, Model(result.record.scenario, 1))
    assert [tick.reason for tick in flight.ticks if "failed" in tick.reason] == []
    assert len(asked) == 5
    for scenario in asked:
        assert scenario.goals == ()
        assert [v.goal.center.tolist() for v in scenario.vehicles] == taken


def test_visits_that_are_made_stay_made_where_covariances_are_learned() -> None:
    scenario = buoys(covariance_samples=30)
    [boat] = scenario.vehicles
    boat = replace(boat, goal=replace(boat.goal, within=None))
    plan = radmpc.plan(replace(scenario, vehicles=(boat,)), rng=0).require()
    asked: list[Scenario] = []

    def planning(scenario: Scenario, seconds: float | None) -> radmpc.Result:
        asked.append(scenario)
        return radmpc.plan(scenario, rng=0, time_limit=seconds)

    mission = Mission(plan, planner=planning, miss_price=1e3)
    flight = radmpc.fly(mission, Model(plan.scenario, 2))
    assert [tick.reason for tick in flight.ticks if "failed" in tick.reason] == []
    due = [len(each.vehicles[0].via) for each in asked]
    assert due == sorted(due, reverse=True)
    assert (due[0], due[-1]) == (2, 0)
    assert sum(tick.choice == "candidate" for tick in flight.ticks[-3:-1]) > 0
