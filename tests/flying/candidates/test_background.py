"""Planning for the next step while this one is flown: whatever comes of it is data."""

from __future__ import annotations

import multiprocessing
import threading
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from dataclasses import replace

import numpy as np
import pytest
from executors import AtOnce, Broken, Never, OneStepLate, steering

import radmpc
from comparing import differences
from radmpc.errors import ArgumentError, ArgumentTypeError, ScenarioError
from radmpc.experiments.families import paper
from radmpc.flying.account import Account
from radmpc.flying.flight import Flight, fly
from radmpc.flying.mission import Mission
from radmpc.flying.model import Model
from radmpc.flying.tick import Contact
from radmpc.model.plan import Plan
from radmpc.model.scenario import Scenario


@pytest.fixture(scope="module")
def plan() -> Plan:
    """Return the plan of a vehicle with nothing in its way."""
    return radmpc.plan(replace(paper(1, 1), obstacles=()), rng=0).require()


def flown(plan: Plan, executor: AtOnce | None, **options: object) -> Flight:
    options = {"planner": steering, "warm": False, "clock": lambda: 0.0, **options}
    mission = Mission(plan, executor=executor, **options)
    return fly(mission, Model(plan.scenario, 3))


def test_what_is_planned_ahead_is_adopted_at_the_next_tick(plan: Plan) -> None:
    worker = AtOnce()
    seen: list[Scenario] = []

    def planner(scenario: Scenario, seconds: float | None) -> Plan:
        assert seconds is None
        seen.append(scenario)
        return steering(scenario, seconds)

    mission = Mission(plan, planner=planner, executor=worker, warm=False, miss_price=1e3)
    flight = fly(mission, Model(plan.scenario, 3))
    assert worker.asked == len(seen) == 9
    assert [s.horizon for s in seen] == list(range(9, 0, -1))
    assert flight.ticks[0].reason == "there was nothing to choose from"
    assert sum(t.choice == "candidate" for t in flight.ticks) >= 4
    # From where vehicles were expected, and within what would be left by then.
    for tick, scenario, entry in zip(flight.ticks, seen, flight.account[1:], strict=False):
        share = 1.0 if scenario.horizon <= 2 else 0.6
        wealth = entry.bank + max(entry.tail - (tick.next_step or 0.0), 0.0)
        assert scenario.risk_bound <= share * wealth
        assert scenario.risk_bound >= 0.999 * min(share * wealth, plan.scenario.risk_bound)
        assert not any(v.initial_covariance.any() for v in scenario.vehicles)
    assert not np.array_equal(seen[0].vehicles[0].start, flight.states[1][0])


def breaks(scenario: Scenario, seconds: float | None) -> Plan:
    raise RuntimeError("the planner broke\nwith more to say")


def says_rubbish(scenario: Scenario, seconds: float | None) -> Plan:
    return "a plan"


@pytest.mark.parametrize(
    ("worker", "planner", "reason"),
    [
        (Never, steering, "the plan made in the background is late"),
        (Broken, steering, "planning failed: RuntimeError: cannot schedule new futures"),
        (AtOnce, breaks, "planning failed: RuntimeError: the planner broke"),
        (AtOnce, says_rubbish, "planning returned str, no plan"),
    ],
)
def test_whatever_a_worker_does_the_tail_flies_on(
    plan: Plan,
    worker: type[AtOnce],
    planner: Callable[..., Plan],
    reason: str,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    # Nobody waits for a worker that never answers.
    monkeypatch.setattr(Mission, "wait", lambda self, seconds=None: True)
    kept, tried = flown(plan, None, planner=None), flown(plan, worker(), planner=planner)
    assert all(t.reason.startswith(reason) for t in tried.ticks[1:9])
    assert differences(kept.states, tried.states) == []
    assert [e.bank for e in kept.account] == [e.bank for e in tried.account]


def test_a_worker_that_never_answers_is_waited_for_once_and_no_longer_than_asked(
    plan: Plan, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: list[float | None] = []
    right = Mission.wait

    def wait(self: Mission, seconds: float | None = None) -> bool:
        asked.append(seconds)
        return right(self, seconds)

    monkeypatch.setattr(Mission, "wait", wait)
    mission = Mission(plan, planner=steering, executor=Never(), warm=False)
    flight = fly(mission, Model(plan.scenario, 3), patience=0.01)
    # At the first step nothing has been asked of it yet.
    assert asked == [0.01, 0.01, *[0.0] * (plan.scenario.horizon - 1)]
    assert all(tick.reason.endswith("is late") for tick in flight.ticks[1:-1])


def test_a_patience_below_nothing_is_refused(plan: Plan) -> None:
    with pytest.raises(ArgumentError, match=r"^patience must be at least 0, got -1"):
        fly(Mission(plan, planner=None), Model(plan.scenario, 3), patience=-1.0)


def test_a_plan_that_is_late_is_judged_when_it_comes(plan: Plan) -> None:
    worker = OneStepLate()
    mission = Mission(plan, planner=steering, executor=worker, warm=False, miss_price=1e3)
    model = Model(plan.scenario, 3)
    states, _ = model.reset()
    reasons = []
    for step in range(6):
        if step % 2 == 0:
            worker.catch_up()
        tick = mission.step(states)
        reasons.append(tick.reason)
        states, _ = model.advance(tick.segments)
    assert [r.endswith("is late") for r in reasons] == [False, True, False, True, False, True]
    # It would have flown the step before otherwise.
    assert "the tail is better" in reasons[2]
    assert worker.asked == 3


def test_the_same_seed_is_the_same_flight_wherever_it_is_planned(plan: Plan) -> None:
    expected = flown(plan, AtOnce(), warm=True)
    assert any(t.choice == "candidate" for t in expected.ticks)
    before = threading.active_count()
    with ThreadPoolExecutor(1) as threads:
        assert differences(flown(plan, threads, warm=True), expected) == []
    assert threading.active_count() == before


@pytest.mark.slow
def test_a_process_makes_the_same_flight_and_leaves_nothing_behind(plan: Plan) -> None:
    expected = flown(plan, AtOnce())
    spawned = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(1, mp_context=spawned) as processes:
        assert differences(flown(plan, processes), expected) == []
    assert multiprocessing.active_children() == []


def test_closing_gives_up_what_has_not_begun(plan: Plan) -> None:
    worker = OneStepLate()
    mission = Mission(plan, planner=steering, executor=worker)
    mission.step([v.start for v in plan.scenario.vehicles])
    mission.close()
    assert worker.waiting[0][0].cancelled()
    tick = mission.step([v.start for v in plan.scenario.vehicles])
    assert "late" not in tick.reason


def test_an_account_expects_to_have_flown_the_next_step() -> None:
    account = Account(0.05, 0.03, 0.02)
    assert account.after(0.01).wealth == pytest.approx(0.04, rel=1e-5)
    assert account.after(1.0).wealth == pytest.approx(0.02, rel=1e-5)


# Threads that call a mission at once, and what it refuses.


@pytest.mark.parametrize("planner", [None, steering])
def test_threads_that_step_one_mission_take_turns(plan: Plan, planner: object) -> None:
    mission = Mission(plan, planner=planner, warm=planner is not None)
    states = [v.start for v in plan.scenario.vehicles]
    refused: list[ArgumentError] = []
    together = threading.Barrier(4)

    def fly_on() -> None:
        together.wait()
        while True:
            try:
                mission.step(states)
            except ArgumentError as error:
                refused.append(error)
                return

    threads = [threading.Thread(target=fly_on) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert [tick.step for tick in mission.ticks] == list(range(plan.scenario.horizon + 1))
    assert len(refused) == 4
    assert all("is over" in str(error) for error in refused)


def test_a_step_that_is_refused_leaves_the_mission_as_it_was(plan: Plan) -> None:
    mission = Mission(plan, planner=None)
    states = [v.start for v in plan.scenario.vehicles]
    hit = Contact(0, "obstacle", plan.scenario.vehicles[0].name, "rock")
    for wrong in ([[1.0, 2.0]], [["a", "b", "c", "d"]], [[1j, 0, 0, 0]], [[[1.0], [2.0, 3.0]]]):
        with pytest.raises(ScenarioError, match=r"^states"):
            mission.step(wrong, contacts=[hit])
    for none in ("x", None, [1]):
        with pytest.raises(ArgumentTypeError, match="contacts must be a list or tuple of Contact"):
            mission.step(states, contacts=none)
    assert mission.contacts == ()
    assert mission.step(states).step == 0


@pytest.mark.parametrize(
    ("options", "line"),
    [
        ({"seed": -1}, "seed must be"),
        ({"seed": "x"}, "seed must be"),
        ({"executor": 3}, "executor must be"),
        ({"warm": "x"}, "warm must be True, False or None, got 'x'"),
    ],
)
def test_options_of_another_kind_are_refused_in_one_line(
    plan: Plan, options: dict[str, object], line: str
) -> None:
    with pytest.raises((ArgumentError, ArgumentTypeError), match=f"^{line}"):
        Mission(plan, **options)
