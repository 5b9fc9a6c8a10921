"""Missions: what is flown at each step, why, and what late or broken planners cost."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from adversary import beside_a_wall, staking, waiting

import radmpc
from comparing import differences
from radmpc.errors import ArgumentError, ArgumentTypeError, NoPlanError, RiskError, ScenarioError
from radmpc.flying.account import Account
from radmpc.flying.candidates.judging import planning_with
from radmpc.flying.flight import Flight, fly
from radmpc.flying.leg import Leg, Outlook, leg_of
from radmpc.flying.mission import Mission
from radmpc.flying.model import Model
from radmpc.flying.tick import Contact
from radmpc.model.plan import Plan
from radmpc.model.scenario import Scenario
from radmpc.result import Result


def flown(result: Result | Plan, seed: int = 3, **options: object) -> Flight:
    deadline = options.pop("deadline", None)
    mission = Mission(result, **options)
    return fly(mission, Model(mission.scenario, seed), deadline=deadline)


@pytest.fixture(scope="module")
def replanned(result: Result) -> Flight:
    """What is flown where every step is planned anew."""
    return flown(result, clock=lambda: 0.0)


def test_without_a_planner_the_plan_is_flown_and_the_bank_stays(result: Result) -> None:
    flight = flown(result, planner=None)
    assert [t.choice for t in flight.ticks] == ["tail"] * 11
    assert len({e.bank for e in flight.account}) == 1
    plan = result.require()
    for tick, *controls in zip(
        flight.ticks, *(p.controls for p in plan.trajectories), strict=False
    ):
        assert all(np.array_equal(a, b) for a, b in zip(tick.controls, controls, strict=False))


@pytest.mark.slow
def test_a_flight_is_told_in_one_line(result: Result) -> None:
    told = repr(flown(result, planner=None))
    assert told.startswith("Flight(10 steps; 0 replans adopted; ")
    assert "; effort " in told
    assert len(told) < 100


@pytest.mark.slow
def test_a_mission_that_plans_anew_arrives_where_one_that_does_not_misses(
    result: Result, replanned: Flight
) -> None:
    scenario = result.record.scenario
    kept = flown(result, planner=None)

    def misses(flight: Flight) -> float:
        pairs = zip(scenario.vehicles, flight.states[-1], strict=True)
        return sum(float(np.linalg.norm(x[:2] - v.goal.center)) for v, x in pairs)

    assert misses(replanned) < 0.5 * misses(kept)
    assert sum(t.choice == "candidate" for t in replanned.ticks) >= 7
    assert not replanned.contacts


@pytest.mark.slow
def test_the_account_of_a_flight_adds_up(result: Result, replanned: Flight) -> None:
    flight = replanned
    bound = result.record.scenario.risk_bound
    assert flight.account[0].what == "opened"
    assert flight.account[0].bank == pytest.approx(bound - result.certificate.certified)
    for tick, before, after in zip(flight.ticks, flight.account, flight.account[1:], strict=False):
        assert after.step == tick.step
        if tick.choice == "tail":
            assert after.bank == before.bank
        else:
            assert after.price == tick.price
            assert after.bank + after.price <= tick.wealth
            assert after.bank == pytest.approx(tick.wealth - after.price, rel=1e-5)


def raises(scenario: Scenario, seconds: float | None) -> Plan:
    raise RuntimeError("the planner broke\nwith more to say")


def finds_nothing(scenario: Scenario, seconds: float | None) -> None:
    return None


def answers_rubbish(scenario: Scenario, seconds: float | None) -> Plan:
    return "a plan"


def answers_for_others(scenario: Scenario, seconds: float | None) -> Plan:
    return staking(beside_a_wall())


def too_short(scenario: Scenario, seconds: float | None) -> Plan:
    controls = [np.zeros((scenario.horizon, 2)) for _ in scenario.vehicles]
    plan = leg_of(scenario, controls, 0).plan
    cut = tuple(replace(t, controls=t.controls[:-1]) for t in plan.trajectories)
    return replace(plan, trajectories=cut)


def misses_its_goal(scenario: Scenario, seconds: float | None) -> Plan:
    controls = [np.zeros((scenario.horizon, 2)) for _ in scenario.vehicles]
    return leg_of(scenario, controls, 0).plan


def breaks_its_limits(scenario: Scenario, seconds: float | None) -> Plan:
    controls = [np.full((scenario.horizon, 2), 1e3) for _ in scenario.vehicles]
    return leg_of(scenario, controls, 0).plan


@pytest.mark.slow
@pytest.mark.parametrize(
    ("planner", "reason"),
    [
        (raises, "planning failed: RuntimeError: the planner broke"),
        (finds_nothing, "no plan was found from here"),
        (answers_rubbish, "planning returned str, no plan"),
        (answers_for_others, "the plan lacks vehicle"),
        (too_short, "the plan cannot be flown: vehicles[0].controls: must have shape"),
        (misses_its_goal, "the plan does not hold: vehicle"),
        (breaks_its_limits, "the plan does not hold: vehicle"),
    ],
)
def test_whatever_a_planner_does_costs_nothing(
    result: Result, planner: Callable[..., Plan], reason: str
) -> None:
    kept, tried = flown(result, planner=None), flown(result, planner=planner)
    assert all(t.reason.startswith(reason) for t in tried.ticks[:10])
    assert "\n" not in tried.ticks[0].reason
    assert differences(kept.states, tried.states) == []
    assert [e.bank for e in kept.account] == [e.bank for e in tried.account]


@pytest.mark.slow
def test_under_way_nobody_waits_for_a_bound_that_nobody_reads(result: Result) -> None:
    scenario = result.record.scenario
    asked = planning_with("certified", 0)
    assert asked is not None
    found = asked(scenario, None)
    assert found.cost == pytest.approx(result.record.cost, rel=1e-3)
    assert "certified(0)" in found.planner
    for name in ("certified(3)", "ira"):
        assert "certified(0)" not in str(planning_with(name, 0).planner)


def test_a_candidate_that_comes_too_late_costs_nothing(result: Result) -> None:
    seconds, given = [0.0], list[float | None]()

    def slow(scenario: Scenario, granted: float | None) -> Result:
        given.append(granted)
        seconds[0] += 0.6
        return radmpc.plan(scenario, rng=0)

    late = flown(result, planner=slow, deadline=0.5, clock=lambda: seconds[0])
    assert {t.reason for t in late.ticks[:4]} == {"the candidate came too late"}
    assert [t.seconds for t in late.ticks[:4]] == pytest.approx([0.6] * 4)
    assert {t.choice for t in late.ticks[:10]} == {"tail"}
    # Who plans past its limit gets less time from tick to tick.
    assert given[:4] == pytest.approx([0.4, 0.3, 0.2, 0.1])
    assert differences(late.states, flown(result, planner=None).states) == []


def test_a_decision_that_takes_too_long_to_compare_is_for_the_tail(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    seconds, plain = [0.0], Leg.outlook

    def pondering(leg: Leg, *given: object) -> Outlook:
        seconds[0] += 0.3
        return plain(leg, *given)

    monkeypatch.setattr(Leg, "outlook", pondering)
    first = waiting(beside_a_wall())
    states = [first.scenario.vehicles[0].start]
    for deadline, choice in ((1.0, "candidate"), (0.5, "tail"), (0.6004, "tail")):
        mission = Mission(first, planner=staking, share=1.0, clock=lambda: seconds[0])
        tick = mission.step(states, deadline=deadline)
        assert tick.choice == choice
        assert tick.seconds == pytest.approx(0.6)
    assert tick.reason == "the candidate came too late"
    assert mission.account[-1].what == "kept"


@pytest.mark.slow
def test_the_same_seed_is_the_same_flight(result: Result, replanned: Flight) -> None:
    assert differences(replanned, flown(result, clock=lambda: 0.0)) == []
    kept, other = (flown(result, seed=seed, planner=None).states for seed in (3, 4))
    assert differences(kept, other) != []


def hits_beside_a_wall(missions: int) -> int:
    scenario = beside_a_wall()
    count = 0
    for seed in range(missions):
        mission = Mission(waiting(scenario), planner=staking, share=1.0, clock=lambda: 0.0)
        count += bool(fly(mission, Model(scenario, seed)).contacts)
    return count


@pytest.mark.slow
def test_an_adversary_does_not_get_a_mission_above_its_bound() -> None:
    assert hits_beside_a_wall(75) <= 10


@pytest.mark.slow
def test_an_adversary_does_where_the_bound_is_granted_anew_each_time(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(Account, "wealth", property(lambda self: self.risk_bound))
    assert hits_beside_a_wall(30) >= 8


def test_a_tail_above_the_bound_is_an_alarm_and_any_safer_candidate_is_taken() -> None:
    scenario = beside_a_wall()
    start = replace(scenario.vehicles[0], start=[0.0, 0.4])
    scenario = replace(scenario, vehicles=(start,))
    plan = leg_of(scenario, [np.vstack([[0.0, 3.0], np.zeros((9, 2))])], 0).plan

    def onward(left: Scenario, seconds: float | None) -> Plan:
        controls = np.zeros((left.horizon, 2))
        controls[0] = [0.0, 9.0]
        return leg_of(left, [controls], 0).plan

    mission = Mission(plan, planner=onward, miss_price=0.0)
    assert "the tail is better" in mission.step([np.array([0.0, 0.4])]).reason
    tick = mission.step([np.array([0.0, 0.15])])
    assert tick.value > scenario.risk_bound
    assert any("what is left risks" in alarm for alarm in tick.alarms)
    assert tick.choice == "candidate"
    assert tick.price < 1e-6


def test_after_a_collision_the_tail_is_flown(result: Result) -> None:
    mission = Mission(result)
    states = [v.start for v in result.record.scenario.vehicles]
    hit = Contact(0, "obstacle", "v1", "square")
    tick = mission.step(states, contacts=[hit])
    assert (tick.choice, tick.reason) == ("tail", "something was hit")
    assert mission.contacts == (hit,)


def test_the_bound_can_be_moved_under_way(result: Result) -> None:
    mission = Mission(result, planner=None)
    mission.step([v.start for v in result.record.scenario.vehicles])
    mission.set_risk_bound(0.06)
    assert mission.account[-1].what == "bound"
    assert mission.account[-1].bank == pytest.approx(mission.account[0].bank + 0.01)
    with pytest.raises(RiskError, match="the rest is allocated to the leg in the air"):
        mission.set_risk_bound(0.0024)


def test_what_nobody_could_know_opens_the_account_anew(result: Result) -> None:
    mission = Mission(result, planner=None)
    mission.step([v.start for v in result.record.scenario.vehicles])
    left = replace(result.record.scenario, horizon=9)
    mission.start_again(radmpc.plan(left, rng=0))
    assert mission.account[-1].what == "new grant"
    assert mission.account[-1].step == 1
    assert mission.step([v.start for v in left.vehicles]).choice == "tail"
    with pytest.raises(ScenarioError, match="must be a plan of 8 steps"):
        mission.start_again(result)


def test_a_mission_ends(result: Result) -> None:
    mission = Mission(result, planner=None)
    fly(mission, Model(mission.scenario, 0))
    assert mission.is_over
    with pytest.raises(ArgumentError, match="the mission of 10 steps is over"):
        mission.step(None)


def test_what_is_no_mission_is_refused(result: Result) -> None:
    nothing = Result(replace(result.record, trajectories=()), None)
    for each in (nothing, nothing.record):
        with pytest.raises(NoPlanError):
            Mission(each)
    with pytest.raises(ScenarioError, match="missing from the plan"):
        Mission(replace(result.record, trajectories=result.record.trajectories[1:]))
    with pytest.raises(ArgumentTypeError, match="result must be a Plan"):
        Mission(result.record.scenario)
    with pytest.raises(ArgumentError, match=r"share must be above 0 and at most 1, got 1\.5"):
        Mission(result, share=1.5)
    with pytest.raises(ScenarioError, match="certifed"):
        Mission(result, planner="certifed")
    with pytest.raises(ArgumentTypeError, match="planner must be a function or None"):
        Mission(result, planner=3)
    with pytest.raises(RiskError, match=r"its certificate of .* is above the risk bound of 0\.001"):
        Mission(
            replace(result.require(), scenario=replace(result.record.scenario, risk_bound=1e-3))
        )
