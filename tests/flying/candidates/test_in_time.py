"""Decisions within their deadlines: what planning gets, and what is left for judging."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import pytest

import radmpc
from radmpc.experiments.families import paper
from radmpc.flying.candidates.judging import NOT_IN_TIME, Candidate, Order, judged
from radmpc.flying.candidates.times import LATE, DecisionTimes, Timer
from radmpc.flying.mission import Mission
from radmpc.flying.recording.campaign import begin_flight
from radmpc.flying.recording.summary import summary_of
from radmpc.io.flight.record import FlightSettings
from radmpc.model.plan import Plan, Status
from radmpc.model.scenario import Scenario

FOUND = Candidate(None, 0.01, "the plan does not hold")
NONE = Candidate(None, None, "no plan was found from here")


def plan_without(scenario: Scenario, status: Status) -> Plan:
    """Planning's answer where it ended without a plan."""
    return replace(
        radmpc.plan(scenario, rng=0, stop=lambda: True).record, status=status, trajectories=()
    )


class Clock:
    """Seconds that pass when a test says so."""

    def __init__(self) -> None:
        self.now = 0.0

    def __call__(self) -> float:
        return self.now

    def judging(self, seconds: float, outcome: Candidate = FOUND):
        def judge() -> Candidate:
            self.now += seconds
            return outcome

        return judge

    def timer(self, seconds: float) -> Timer:
        return Timer(self, self.now + seconds)


def test_without_a_deadline_planning_takes_as_long_as_it_takes() -> None:
    clock = Clock()
    assert (
        DecisionTimes(judging=9.0, overrun=9.0).planning_seconds(clock.timer(float("inf")), 10)
        is None
    )


def test_before_anything_was_judged_planning_gets_four_fifths() -> None:
    assert DecisionTimes().planning_seconds(Clock().timer(1.0), 10) == pytest.approx(0.8)


def test_planning_leaves_time_to_judge_its_plan_twice() -> None:
    # Planners judge plans themselves, the last one past their limit.
    clock, times = Clock(), DecisionTimes()
    assert times.in_time(clock.judging(0.2), clock.timer(float("inf")), 10) is FOUND
    assert times.planning_seconds(clock.timer(1.0), 10) == pytest.approx(1.0 - 2 * 0.25)
    # Half as many steps are judged in half the time.
    assert times.planning_seconds(clock.timer(1.0), 5) == pytest.approx(1.0 - 2 * 0.125)


def test_planning_leaves_time_for_ending_as_late_as_before() -> None:
    times = DecisionTimes()
    times.note_overrun(0.4)
    assert times.planning_seconds(Clock().timer(1.0), 10) == pytest.approx(0.6)
    times.note_overrun(-0.1)
    assert 0.6 < times.planning_seconds(Clock().timer(1.0), 10) < 0.8


def test_where_there_is_no_time_to_plan_less_is_expected_the_next_time() -> None:
    clock, times = Clock(), DecisionTimes(judging=0.1)
    given = [times.planning_seconds(clock.timer(1.0), 10) for _ in range(4)]
    assert given[0] == 0.0
    assert given[-1] > 0.0


def test_a_candidate_is_not_judged_if_that_is_expected_to_take_too_long() -> None:
    clock, times = Clock(), DecisionTimes()
    times.in_time(clock.judging(0.2), clock.timer(1.0), 10)
    began = clock.now
    assert times.in_time(clock.judging(0.2), clock.timer(0.2), 10).reason == LATE
    assert clock.now == began
    assert times.in_time(clock.judging(0.2), clock.timer(0.3), 10) is FOUND


def test_a_candidate_that_is_judged_too_late_keeps_its_price_alone() -> None:
    clock = Clock()
    found = DecisionTimes().in_time(clock.judging(0.2), clock.timer(0.1), 10)
    assert (found.leg, found.price, found.reason) == (None, 0.01, LATE)


def test_no_plan_says_nothing_of_how_long_judging_takes() -> None:
    clock, times = Clock(), DecisionTimes()
    times.in_time(clock.judging(0.2), clock.timer(1.0), 10)
    before = times.judging
    assert times.in_time(clock.judging(0.0, NONE), clock.timer(1.0), 10) is NONE
    assert times.judging == before == pytest.approx(0.02)


def without_plan(status: Status, *, is_timed: bool) -> str:
    """Why there is no candidate where planning ended like that."""
    scenario = paper(1, 1)
    order = Order(scenario, scenario, 0, is_timed=is_timed)
    return judged(plan_without(scenario, status), order, 0, [scenario.vehicles[0].start]).reason


def test_a_search_that_its_deadline_ended_does_not_say_that_there_is_no_plan() -> None:
    assert without_plan(Status.LIMIT, is_timed=True) == NOT_IN_TIME
    assert without_plan(Status.LIMIT, is_timed=False).endswith("within the planner's own limit")
    for is_timed in (True, False):
        assert without_plan(Status.INFEASIBLE, is_timed=is_timed) == "no plan was found from here"


def test_decisions_that_a_deadline_left_without_a_plan_are_counted() -> None:
    plan = radmpc.plan(replace(paper(1, 1), obstacles=()), rng=0).require()
    timed = begin_flight(plan, FlightSettings(replan="certified", deadline=1e-6))
    assert summary_of(timed).cut_off == summary_of(timed).ticks - 1
    assert summary_of(begin_flight(plan, FlightSettings(replan=None, deadline=9.0))).cut_off == 0
    assert summary_of(begin_flight(plan, FlightSettings(replan=None))).cut_off is None


def test_planning_on_the_spot_and_in_the_background_knows_of_its_deadline() -> None:
    plan = radmpc.plan(replace(paper(1, 1), obstacles=()), rng=0).require()
    start = [plan.scenario.vehicles[0].start]

    def stopped(scenario: Scenario, seconds: float | None) -> Plan:
        return plan_without(scenario, Status.LIMIT)

    spot = Mission(plan, planner=stopped, warm=False)
    assert spot.step(start, deadline=5.0).reason == NOT_IN_TIME
    with ThreadPoolExecutor(1) as worker:
        ahead = Mission(plan, planner=stopped, executor=worker, warm=False)
        ahead.step(start, deadline=5.0)
        ahead.wait()
        assert ahead.step(start, deadline=5.0).reason == NOT_IN_TIME
