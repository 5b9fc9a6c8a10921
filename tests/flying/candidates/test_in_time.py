"""Decisions within their deadlines: what planning gets, and what is left for judging."""

from __future__ import annotations

import pytest

from radmpc.flying.candidates.judging import Candidate
from radmpc.flying.candidates.times import LATE, DecisionTimes, Timer

FOUND = Candidate(None, 0.01, "the plan does not hold")
NONE = Candidate(None, None, "no plan was found from here")


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
