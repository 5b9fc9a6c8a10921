"""Candidates near the paths in the air: programs that are kept, goals that give way."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from adversary import beside_a_wall, staking, waiting

import radmpc
from radmpc.experiments.families import circle, paper
from radmpc.flying.leg import leg_of
from radmpc.flying.mission import Mission
from radmpc.flying.model import Model
from radmpc.flying.remainder import left_of
from radmpc.flying.warm.ahead import Ahead
from radmpc.flying.warm.goals import least_slacks, widened
from radmpc.flying.warm.kept_lp import KeptLp
from radmpc.flying.warm.search import Try, WarmSearch
from radmpc.model.dynamics import lqr_gain
from radmpc.model.plan import Plan
from radmpc.model.scenario import Scenario
from radmpc.planners.certified.turned import looks
from radmpc.planners.certified.turned.half_spaces import half_spaces
from radmpc.planners.certified.turned.linear.group_lp import GroupLp
from radmpc.planners.certified.turned.linear.margins import fixed_margins
from radmpc.planners.certified.turned.near import Near
from radmpc.planners.certified.turned.paths import Paths
from radmpc.program.build import condensed_models
from radmpc.program.hazards import Hazards


def never() -> bool:
    return False


@pytest.fixture(scope="module")
def plan() -> Plan:
    return radmpc.plan(circle(4), rng=0).require()


def pushed(plan: Plan, passed: int, seed: int) -> list[np.ndarray]:
    """Return states some steps on, each off its mean by noise."""
    rng = np.random.default_rng(seed)
    return [
        path.means[passed] + rng.multivariate_normal(np.zeros(4), v.disturbance_covariance)
        for v, path in zip(plan.scenario.vehicles, plan.trajectories, strict=True)
    ]


def built_anew(left: Scenario) -> Hazards:
    return Hazards.of(left, condensed_models(left))


@pytest.mark.slow
@pytest.mark.sampled(2)
@pytest.mark.parametrize("avoidance", ["steps", "intervals"])
@pytest.mark.parametrize("has_feedback", [False, True])
def test_a_program_that_is_kept_is_the_one_that_is_built_anew(
    avoidance: str, has_feedback: bool, plan: Plan
) -> None:
    scenario = replace(plan.scenario, avoidance=avoidance)
    if has_feedback:
        system = scenario.vehicles[0].system
        gain = lqr_gain(system, np.eye(4), 2.0 * np.eye(2))
        drift = np.array([0.02, 0.0, 0.0, 0.0])
        changed = (replace(v, gain=gain, drift=drift) for v in scenario.vehicles)
        scenario = replace(scenario, vehicles=tuple(changed))
    everyone = tuple(range(4))
    ahead = Ahead.of(scenario)
    kept = KeptLp(ahead.whole, everyone)
    for passed in (0, 1, 4):
        left = left_of(scenario, passed, pushed(plan, passed, passed), 0.05)
        hazards = ahead.left(passed, left.vehicles, [v.goal for v in left.vehicles])
        kept.move(hazards)
        paths = Paths(hazards)
        for i, path in enumerate(plan.trajectories):
            paths.fly(i, path.controls[passed:])
        found = []
        for lp, theirs in (
            (kept, hazards),
            (GroupLp(built_anew(left), everyone), built_anew(left)),
        ):
            spaces = half_spaces(theirs, paths, everyone, Near(3.0, 1.0, is_refined=True))
            answer = lp.solve(spaces, paths, fixed_margins(spaces.deviations, 3.0, 1e3))
            assert answer is not None
            found.append(sum(float(np.abs(u).sum()) for u in answer.controls) + answer.shortfall)
        assert found[0] == pytest.approx(found[1], rel=1e-7)


def test_a_warm_candidate_is_certified_within_what_it_was_granted(plan: Plan) -> None:
    search = WarmSearch(plan.scenario)
    left = left_of(plan.scenario, 1, pushed(plan, 1, 3), 0.02)
    controls = tuple(path.controls[1:] for path in plan.trajectories)
    for _ in range(3):
        found = search.search(Try(left, controls, is_safest=False, is_stopped=never))
        assert found is not None
        leg = price_of(left, found[0])
        search.learn(leg)
    assert 0.0 < leg <= 0.02
    safest = search.search(Try(left, controls, is_safest=True, is_stopped=never))
    assert safest is not None
    assert price_of(left, safest[0]) < 1e-3 * leg


def test_paths_that_hardly_moved_need_no_second_look(
    plan: Plan, monkeypatch: pytest.MonkeyPatch
) -> None:
    left = left_of(plan.scenario, 1, pushed(plan, 1, 3), 0.02)
    asked = Try(left, tuple(path.controls[1:] for path in plan.trajectories), False, never)
    found, seen = [], []
    right = looks.half_spaces
    monkeypatch.setattr(looks, "half_spaces", lambda *a: seen.append(len(found)) or right(*a))
    for surely in (looks._SURELY, 0.0):
        monkeypatch.setattr(looks, "_SURELY", surely)
        search = WarmSearch(plan.scenario)
        answer = [search.search(asked) for _ in range(2)][-1]
        assert answer is not None
        found.append(answer[0])
    assert seen.count(0) < seen.count(1)
    for ours, theirs in zip(*found, strict=True):
        np.testing.assert_array_equal(ours, theirs)


def test_a_grant_that_no_plan_keeps_leaves_no_price_that_later_plans_suffer_from(
    plan: Plan,
) -> None:
    controls = tuple(path.controls for path in plan.trajectories)
    states = [v.start for v in plan.scenario.vehicles]

    def effort(search: WarmSearch, grant: float) -> float:
        found = search.search(Try(left_of(plan.scenario, 0, states, grant), controls, False, never))
        assert found is not None
        return sum(float(np.abs(u).sum()) for u in found[0])

    search, other = WarmSearch(plan.scenario), WarmSearch(plan.scenario)
    usual = [effort(search, 0.05) for _ in range(4)][-1]
    for _ in range(4):
        effort(other, 0.05)
    for _ in range(3):
        effort(other, 1e-12)
    assert effort(other, 0.05) < 1.02 * usual


def price_of(left: Scenario, controls: tuple[np.ndarray, ...]) -> float:
    return leg_of(left, controls, 0).price


def test_a_search_that_is_stopped_finds_nothing(plan: Plan) -> None:
    controls = tuple(path.controls for path in plan.trajectories)
    asked = Try(plan.scenario, controls, is_safest=False, is_stopped=lambda: True)
    assert WarmSearch(plan.scenario).search(asked) is None


def late(scenario: Scenario, away: float) -> Scenario:
    """Return a vehicle at rest two steps before it should be at its goal, some meters off."""
    (vehicle,) = scenario.vehicles
    start = np.concatenate([vehicle.goal.center + np.array([away, 0.0]), np.zeros(2)])
    return replace(scenario, horizon=2, vehicles=(replace(vehicle, start=start),), obstacles=())


@pytest.fixture(scope="module")
def alone() -> Scenario:
    scenario = paper(1, 0)
    (vehicle,) = scenario.vehicles
    return replace(scenario, vehicles=(replace(vehicle, control_limit=0.5, speed_limit=1.0),))


def test_goals_within_reach_stay_as_they_are(alone: Scenario) -> None:
    near = late(alone, 0.1)
    assert widened(near) is near


def test_goals_give_way_by_the_least_that_limits_leave(alone: Scenario) -> None:
    off = late(alone, 2.0)
    (slack,) = least_slacks(condensed_models(off), off.dt)
    assert slack is not None
    assert slack[0] > 0.5
    wider = widened(off)
    assert least_slacks(condensed_models(wider), off.dt)[0] == pytest.approx(0.0, abs=1e-12)
    assert radmpc.plan(off, rng=0).plan is None
    assert radmpc.plan(wider, rng=0).plan is not None
    goal, before = wider.vehicles[0].goal, off.vehicles[0].goal
    assert goal.lower[1] == before.lower[1]
    # A little less would not do.
    less = replace(goal, upper=goal.upper - 1e-3, lower=before.lower, speed=goal.speed)
    tight = replace(off, vehicles=(replace(off.vehicles[0], goal=less),))
    assert least_slacks(condensed_models(tight), off.dt)[0].sum() > 5e-4


def test_a_vehicle_that_cannot_brake_is_left_as_it_is_and_others_are_not(alone: Scenario) -> None:
    off = late(alone, 2.0)
    (vehicle,) = off.vehicles
    racing = replace(vehicle, name="racing", start=[0.0, 0.0, 3.0, 0.0])
    both = replace(off, vehicles=(racing, vehicle))
    wider = widened(both)
    assert wider.vehicles[0] is racing
    assert wider.vehicles[1].goal.upper[0] > vehicle.goal.upper[0] + 0.5


@pytest.mark.slow
def test_a_mission_with_warm_candidates_alone_is_bound_for_its_goals(plan: Plan) -> None:
    misses = {}
    for warm in (False, True):
        mission, model = Mission(plan, planner=None, warm=warm), Model(plan.scenario, 5)
        states, contacts = model.reset()
        for step in range(plan.scenario.horizon):
            tick = mission.step(states, contacts=contacts)
            misses[warm] = mission._leg.outlook(step, states).miss
            states, contacts = model.advance(tick.segments)
        assert not mission.contacts
    assert misses[True] < 0.2 * misses[False]


def finds_nothing(scenario: Scenario, seconds: float | None) -> None:
    return None


def test_a_tail_above_the_bound_is_left_for_the_least_risk_there_is(plan: Plan) -> None:
    scenario = replace(plan.scenario, risk_bound=0.3)
    mission = Mission(replace(plan, scenario=scenario), planner=finds_nothing)
    mission.step([v.start for v in scenario.vehicles])
    mission.set_risk_bound(mission.balance.risk_bound - 0.9 * mission.balance.bank)
    # The first vehicle was pushed into the way of another.
    states = [np.array(x) for x in mission._expected]
    middle = np.mean([x[:2] for x in states], axis=0)
    while mission._leg.value(1, states).total <= mission.balance.risk_bound:
        states[0][:2] += 0.02 * (middle - states[0][:2])
        states[0][2:] += 0.01 * (middle - states[0][:2])
    tick = mission.step(states)
    assert tick.choice == "candidate"
    assert tick.value is not None
    assert tick.price is not None
    assert tick.price < 0.1 * tick.value


def test_nothing_is_planned_below_the_least_grant() -> None:
    asked = []

    def planner(scenario: Scenario, seconds: float | None) -> Plan:
        asked.append(scenario)
        return staking(scenario, seconds)

    scenario = beside_a_wall()
    mission = Mission(waiting(scenario), planner=planner)
    mission.set_risk_bound(1.5e-5)
    tick = mission.step([scenario.vehicles[0].start])
    assert "too little to plan with" in tick.reason
    assert not asked
    mission.set_risk_bound(1.8e-5)
    mission.step([scenario.vehicles[0].start])
    assert [s.risk_bound for s in asked] == [pytest.approx(0.6 * 1.8e-5, rel=1e-5)]


def test_a_search_that_breaks_costs_nothing(plan: Plan, monkeypatch: pytest.MonkeyPatch) -> None:
    mission = Mission(plan, planner=None, warm=True)

    def breaks(self: WarmSearch, asked: Try) -> None:
        raise FloatingPointError("overflow")

    monkeypatch.setattr(WarmSearch, "search", breaks)
    tick = mission.step([v.start for v in plan.scenario.vehicles])
    assert (tick.choice, tick.reason) == ("tail", "planning failed: FloatingPointError: overflow")
