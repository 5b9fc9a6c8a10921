"""Limits of norms under way: what is commanded, what is planned, and what gives way."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from norm_scenes import CONTROL, SPEED, crossing, sensed

import radmpc
from radmpc.flying.flight import fly
from radmpc.flying.mission import Mission
from radmpc.flying.model import Model
from radmpc.flying.receding.long_mission import LongMission
from radmpc.flying.recording.recorded import RecordedMission
from radmpc.flying.recording.verifying import flight_problems
from radmpc.flying.remainder import left_of
from radmpc.flying.warm.ahead import Ahead
from radmpc.flying.warm.goals import least_slacks, widened
from radmpc.flying.warm.kept_lp import KeptLp
from radmpc.io.flight.record import FlightRecord, FlightSettings, TickRow
from radmpc.model.dynamics import rollout
from radmpc.model.limits import within_limits
from radmpc.model.plan import Plan
from radmpc.model.scenario import Scenario
from radmpc.model.vehicle import Goal
from radmpc.planners.certified.turned.half_spaces import half_spaces
from radmpc.planners.certified.turned.linear.group_lp import GroupLp
from radmpc.planners.certified.turned.linear.group_plan import GroupPlan
from radmpc.planners.certified.turned.linear.margins import fixed_margins
from radmpc.planners.certified.turned.near import Near
from radmpc.planners.certified.turned.paths import Paths
from radmpc.program.build import condensed_models
from radmpc.program.hazards import Hazards
from radmpc.referee.conditional.scales import Scale
from radmpc.referee.propagation import propagate
from radmpc.referee.sampling import Sampler
from radmpc.referee.saturation import cutoffs


@pytest.fixture(scope="module")
def plan() -> Plan:
    return radmpc.plan(crossing(), "certified", rng=0).require()


def norms(vectors: np.ndarray) -> np.ndarray:
    return np.linalg.norm(vectors, axis=-1)


def without_norms(scenario: Scenario) -> Scenario:
    freed = [replace(v, control_norm=None, speed_norm=None) for v in scenario.vehicles]
    return replace(scenario, vehicles=tuple(freed))


@pytest.mark.sampled(2)
@pytest.mark.slow
@pytest.mark.parametrize("avoidance", ["steps", "intervals"])
@pytest.mark.parametrize("is_warm", [False, True])
def test_a_fleet_that_is_planned_anew_keeps_the_norms_it_is_limited_to(
    avoidance: str, is_warm: bool, plan: Plan
) -> None:
    given = plan if avoidance == "steps" else radmpc.plan(crossing(avoidance), rng=0).require()
    mission = Mission(given, planner=None if is_warm else "certified", warm=is_warm)
    model = Model(given.scenario, 4)
    states, contacts = model.reset()
    asked, adopted = [], 0
    while not mission.is_over:
        tick = mission.step(states, contacts=contacts)
        adopted += tick.choice == "candidate"
        for path in mission.leg.plan.trajectories:
            assert norms(path.controls).max(initial=0.0) <= CONTROL + 1e-6
            assert norms(path.means[1:, 2:]).max(initial=0.0) <= SPEED + 1e-6
        asked += [float(norms(control)) for control in tick.controls]
        assert tick.alarms == ()
        if tick.segments:
            states, contacts = model.advance(tick.segments)
    assert max(asked) <= CONTROL
    assert adopted >= 3
    # It is norms that bind: what axes leave is more.
    assert max(asked) > 0.9 * CONTROL


def test_a_control_beyond_a_norm_is_shortened_and_an_alarm(plan: Plan) -> None:
    mission = Mission(plan, planner=None)
    off = np.array([-1.3, 0.0, 0.0, 0.0])
    states = [plan.scenario.vehicles[0].start + off, plan.scenario.vehicles[1].start]
    tick = mission.step(states)
    asked = mission.leg.controls(0, states)[0]
    assert np.abs(asked).max() < plan.scenario.vehicles[0].control_limit[0]
    assert norms(asked) > CONTROL + 0.1
    np.testing.assert_allclose(tick.controls[0], CONTROL * asked / norms(asked))
    assert any("vehicle 'a': its control saturates by" in alarm for alarm in tick.alarms)
    assert not any("vehicle 'b': its control" in alarm for alarm in tick.alarms)


def test_a_mission_cuts_controls_off_as_samples_do(plan: Plan) -> None:
    scenario = plan.scenario
    controls = [path.controls for path in plan.trajectories]
    motion = propagate(scenario, controls)
    sampler = Sampler.of(motion, np.arange(2), np.zeros(0, dtype=np.int64))
    cutoff = cutoffs(scenario, motion, np.ones(2, dtype=bool), controls, sampler)[0]
    deviations = np.random.default_rng(1).normal(0.0, 1.0, (sampler.width, 200))
    excess = cutoff.excess(deviations)
    assert excess is not None
    for i, vehicle in enumerate(scenario.vehicles):
        own = deviations[sampler.starts[i] : sampler.starts[i] + 4]
        for s in range(200):
            asked = controls[i][0] + vehicle.gain @ own[:, s]
            flown = asked - excess[2 * i : 2 * i + 2, s]
            # Samples have a tolerance of what counts as saturated.
            np.testing.assert_allclose(within_limits(vehicle, asked), flown, atol=1e-5)


def test_what_is_not_limited_by_a_norm_is_cut_off_along_its_axes(plan: Plan) -> None:
    vehicle = without_norms(plan.scenario).vehicles[0]
    np.testing.assert_array_equal(within_limits(vehicle, np.array([3.0, -1.5])), [1.7, -1.5])


def solved(lp: GroupLp, hazards: Hazards, controls: list[np.ndarray]) -> GroupPlan:
    """Return what a program finds between half-spaces turned to given controls."""
    paths = Paths(hazards)
    for i, pushed in enumerate(controls):
        paths.fly(i, pushed)
    # Along lines of closest approach, which do not depend on what noise is taken to be.
    spaces = half_spaces(hazards, paths, (0, 1), Near(3.0, 1.0, is_refined=False))
    answer = lp.solve(spaces, paths, fixed_margins(spaces.deviations, 3.0, 1e3))
    assert answer is not None
    return answer


@pytest.mark.parametrize("sensors", [False, True])
@pytest.mark.parametrize("avoidance", ["steps", "intervals"])
def test_a_program_that_is_kept_has_the_norms_of_the_one_that_is_built_anew(
    avoidance: str, sensors: bool, plan: Plan
) -> None:
    scenario = sensed(avoidance) if sensors else crossing(avoidance)
    ahead = Ahead.of(scenario)
    kept = KeptLp(ahead.whole, (0, 1))
    for passed in (0, 2):
        known = [path.means[passed] for path in plan.trajectories]
        if sensors:
            known = [np.concatenate([x, np.zeros(4)]) for x in known]
        left = left_of(scenario, passed, known, 0.05)
        moved = ahead.left(passed, left.vehicles, [v.goal for v in left.vehicles])
        anew = Hazards.of(left, condensed_models(left))
        kept.move(moved)
        efforts = []
        for lp, hazards in ((kept, moved), (GroupLp(anew, (0, 1)), anew)):
            answer = solved(lp, hazards, [path.controls[passed:] for path in plan.trajectories])
            efforts.append(sum(float(np.abs(u).sum()) for u in answer.controls) + answer.shortfall)
            for vehicle, controls in zip(left.vehicles, answer.controls, strict=True):
                means = rollout(vehicle.system, vehicle.start, controls)
                assert norms(controls).max() <= CONTROL + 1e-6
                assert norms(means[1:, 2:]).max() <= SPEED + 1e-6
        # A filter is taken to know about as much at every step as at the last one.
        assert efforts[0] == pytest.approx(efforts[1], rel=1e-3 if sensors else 1e-6)


def test_what_is_learned_of_covariances_changes_the_reserve_of_norms() -> None:
    scenario = replace(crossing(), covariance_samples=20)
    starts = [v.start for v in scenario.vehicles]
    scale = Scale(40, np.float64(2.0))
    left = left_of(scenario, 1, starts, 0.05, scale)
    goals = [v.goal for v in left.vehicles]
    cut = Ahead.of(scenario).left(1, left.vehicles, goals, scale).models
    for ours, anew in zip(cut, condensed_models(left), strict=True):
        assert ours.face_bounds is not None
        assert anew.face_bounds is not None
        assert np.ptp(anew.face_bounds) > 1e-3
        np.testing.assert_allclose(ours.face_bounds, anew.face_bounds, rtol=1e-12)


def test_goals_give_way_by_the_least_that_norms_leave() -> None:
    scenario = crossing(horizon=4)
    one = replace(scenario.vehicles[0], gain=None, goal=Goal.at([5.0, 5.0], 0.3, 0.3))
    off = replace(scenario, vehicles=(one,))
    assert least_slacks(condensed_models(without_norms(off)), 1.0)[0] == pytest.approx(0.0)
    (slack,) = least_slacks(condensed_models(off), 1.0)
    assert slack is not None
    assert slack.sum() > 0.05
    assert radmpc.plan(off, "dlp").plan is None
    wider = widened(off)
    found = radmpc.plan(wider, "dlp").require().trajectories[0]
    assert norms(found.controls).max() <= CONTROL + 1e-6


def test_a_flight_with_limits_of_norms_is_booked_again(plan: Plan) -> None:
    rows: list[TickRow] = []
    mission = RecordedMission(plan, 0, rows.append, planner=None)
    states = [
        plan.scenario.vehicles[0].start - [0.5, 0.5, 0.2, 0.2],
        plan.scenario.vehicles[1].start,
    ]
    mission.step(states)
    assert rows[0].excess > 0.1
    record = FlightRecord(plan, FlightSettings(replan=None), tuple(rows))
    assert flight_problems(record) == ()
    longer = replace(rows[0], controls=tuple(1.05 * u for u in rows[0].controls))
    problems = flight_problems(replace(record, rows=(longer,)))
    assert any("the leg says" in problem for problem in problems)


@pytest.mark.slow
def test_windows_of_a_long_mission_keep_norms() -> None:
    scenario = crossing("steps", 12)
    fleet = [
        replace(v, goal=Goal.at(v.start[:2] + 2.0 * (v.goal.center - v.start[:2]), 0.5, 0.5))
        for v in scenario.vehicles
    ]
    scenario = replace(scenario, vehicles=tuple(fleet))
    mission = LongMission(scenario, window=7, overlap=3)
    flight = fly(mission, Model(scenario, 2))
    assert not mission.is_stranded
    assert sum(entry.what == "window" for entry in flight.account) >= 1
    assert max(norms(control) for tick in flight.ticks for control in tick.controls) <= CONTROL
