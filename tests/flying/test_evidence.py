"""What a mission learns of covariances that are known up to a factor."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import chi2, kstest

import radmpc
from radmpc.flying.leg import leg_of
from radmpc.flying.mission import Mission
from radmpc.flying.model import Model
from radmpc.flying.recording.recomputing import recomputed
from radmpc.flying.recording.recorded import RecordedMission
from radmpc.flying.remainder import left_of
from radmpc.flying.sensing import evidence as module
from radmpc.flying.sensing.alarms import Watcher
from radmpc.flying.warm.ahead import Ahead
from radmpc.gaussian import Tail
from radmpc.model.dynamics import double_integrator, lqr_gain
from radmpc.model.noise.measurement import Measurement
from radmpc.model.noise.shared import SharedDisturbance
from radmpc.model.obstacle import Obstacle
from radmpc.model.plan import Plan
from radmpc.model.scenario import Scenario
from radmpc.model.vehicle import Goal, Vehicle
from radmpc.program.build import condensed_models
from radmpc.program.hazards import Hazards
from radmpc.referee.conditional.scales import Scale

SAMPLES, STEPS = 5, 4
WIND = SharedDisturbance("wind", np.vstack([0.5 * np.eye(2), np.eye(2)]), 0.09)
SYSTEM = double_integrator(1.0, 2)
GAIN = lqr_gain(SYSTEM, np.eye(4), 4.0 * np.eye(2))


def fleet(*noises: dict[str, object], samples: int | None = SAMPLES, **scene: object) -> Plan:
    """Return a plan of vehicles far apart, one for each kind of noise."""
    vehicles = tuple(
        Vehicle(
            name=f"v{i}",
            system=SYSTEM,
            start=[0.0, 40.0 * i, 0.5, 0.0],
            goal=Goal.at([2.0, 40.0 * i], 9.0, None),
            radius=0.3,
            control_limit=50.0,
            initial_covariance=[0.01, 0.02, 0.001, 0.002],
            disturbance_covariance=[0.02, 0.01, 0.02, 0.0],
            **{"gain": GAIN, **noise},
        )
        for i, noise in enumerate(noises)
    )
    numbers = {"covariance_samples": samples, "risk_bound": 0.2, **scene}
    scenario = Scenario("far", 1.0, STEPS, vehicles=vehicles, **numbers)
    return leg_of(scenario, [np.zeros((STEPS, 2))] * len(vehicles), 0).plan


def alone() -> Plan:
    return fleet({})


def in_one_wind() -> Plan:
    return fleet(*[{"shared": (WIND,)}] * 4, {})


def with_memory_and_sensors() -> Plan:
    sensor = Measurement.of([0, 1], 4, 0.05)
    return fleet({"disturbance_correlation": 0.6}, {"measurement": sensor})


def learned(plan: Plan, seed: int, missed: int | None = None) -> tuple[Scale, float]:
    """Return what a mission knows of the factor at its end, and the factor that was drawn."""
    mission, model = Mission(plan, planner=None), Model(plan.scenario, seed)
    states, _ = model.reset()
    while not mission.is_over:
        tick = mission.step(None if len(mission.ticks) == missed else states)
        if tick.segments:
            states, _ = model.advance(tick.segments)
    return mission._sensing.evidence.scale, model._larger**2


def unlikely(plan: Plan, missions: int, missed: int | None = None) -> float:
    """Return how probable missions are whose factors are as what is known of them says."""
    ratios = []
    for seed in range(1_000, 1_000 + missions):
        scale, factor = learned(plan, seed, missed)
        ratios.append(chi2.cdf(scale.samples * scale.factor / factor, scale.samples))
    return float(kstest(ratios, "uniform").pvalue)


@pytest.mark.slow
@pytest.mark.sampled(2)
@pytest.mark.parametrize(
    ("scene", "missed"),
    [(alone, None), (in_one_wind, None), (with_memory_and_sensors, None), (alone, 2), (alone, 0)],
)
def test_factors_are_as_often_where_they_are_thought_to_be(
    scene: Callable[[], Plan], missed: int | None
) -> None:
    assert unlikely(scene(), 120, missed) > 1e-3


def squares_forgotten(monkeypatch: pytest.MonkeyPatch) -> None:
    right = module.squares_of
    monkeypatch.setattr(module, "squares_of", lambda *given: (np.zeros(1), right(*given)[1]))


def winds_forgotten(monkeypatch: pytest.MonkeyPatch) -> None:
    right = module._covariance

    def wrong(vehicles, *given):
        return right([replace(vehicle, shared=()) for vehicle in vehicles], *given)

    monkeypatch.setattr(module, "_covariance", wrong)


def misses_taken_for_steps(monkeypatch: pytest.MonkeyPatch) -> None:
    right = module._covariance
    monkeypatch.setattr(
        module,
        "_covariance",
        lambda vehicles, told, last, at: right(vehicles, told, None if not at else at - 1, at),
    )


@pytest.mark.slow
@pytest.mark.sampled(1)
@pytest.mark.parametrize(
    ("scene", "missed", "mutant"),
    [
        (alone, None, squares_forgotten),
        (in_one_wind, None, winds_forgotten),
        (alone, 2, misses_taken_for_steps),
    ],
)
def test_who_learns_wrongly_is_found_out(scene, missed, mutant, monkeypatch) -> None:
    mutant(monkeypatch)
    assert unlikely(scene(), 120, missed) < 1e-3


def test_directions_are_counted_that_have_noise_and_no_others() -> None:
    scale, _ = learned(alone(), 3)
    # Four of the start, three of every step: one velocity is never disturbed.
    assert scale.samples == SAMPLES + 4 + 3 * STEPS
    scale, _ = learned(in_one_wind(), 3)
    # Four of them speed up across by the wind alone, and all by the same.
    assert scale.samples == SAMPLES + 20 + (13 + 3) * STEPS
    scale, _ = learned(with_memory_and_sensors(), 3)
    assert scale.samples == SAMPLES + (4 + 3 * STEPS) + 2 * (STEPS + 1)


def test_the_steps_that_are_left_have_the_covariances_that_are_known_by_then() -> None:
    track = Obstacle.tracked("berg", [[30, 0], [31, 0], [30, 1]], [0, 0, 0.1, 0], 0.04)
    sensor = Measurement.of([0, 1], 4, 0.05)
    plan = fleet({"measurement": sensor}, {"shared": (WIND,)}, obstacles=(track,))
    known = [np.zeros(8), np.zeros(4)]
    scale = Scale(17, 2.5)
    plain, left = (left_of(plan.scenario, 1, known, 0.1, each) for each in (None, scale))
    assert (plain.covariance_samples, left.covariance_samples) == (SAMPLES, 17)
    for ours, theirs in zip(left.vehicles, plain.vehicles, strict=True):
        np.testing.assert_allclose(ours.covariances(3), 2.5 * theirs.covariances(3), rtol=1e-12)
        np.testing.assert_array_equal(ours.start, theirs.start)
    here, there = left.obstacles[0], plain.obstacles[0]
    np.testing.assert_allclose(here.spread.positions, 2.5 * there.spread.positions)
    np.testing.assert_allclose(here.shape.covariance, 2.5 * there.shape.covariance)
    # Planners see a scenario like any other: what it checks, it has.
    assert replace(left).covariance_samples == 17


@pytest.mark.parametrize("passed", [0, 1])
def test_a_leg_is_worth_the_same_whatever_was_known_when_it_was_made(passed: int) -> None:
    """As one is that was planned ahead, and judged by what has been measured since."""
    wall = Obstacle.box("wall", [-9.0, 0.9], [19.0, 3.0])
    plan = fleet({}, obstacles=(wall,))
    states = [path.means[passed] for path in plan.trajectories]
    then, now = Scale(17, 2.5), Scale(29, 1.7)
    made = [
        leg_of(
            left_of(plan.scenario, passed, states, 0.1, scale),
            [path.controls[passed:] for path in plan.trajectories],
            passed,
            scale,
        )
        for scale in (then, now)
    ]
    seen = [path.means[passed + 1] + [0.1, 0.2, 0.0, 0.1] for path in plan.trajectories]
    worth = [leg.value(passed + 1, seen, now).total for leg in made]
    assert worth[0] == pytest.approx(worth[1], rel=1e-6)
    assert abs(worth[0] - made[0].value(passed + 1, seen, then).total) > 0.01 * worth[0] > 1e-5


def test_what_is_planned_ahead_is_judged_by_what_is_known_when_it_comes() -> None:
    wall = Obstacle.box("wall", [-9.0, 1.1], [19.0, 3.0])
    plan = replace(fleet({}, obstacles=(wall,), risk_bound=0.45))
    with ThreadPoolExecutor(1) as worker:
        mission = Mission(plan, planner="ira", executor=worker)
        flight = radmpc.fly(mission, Model(plan.scenario, 4))
    assert not [tick.reason for tick in flight.ticks if "failed" in tick.reason]
    adopted = [tick for tick in flight.ticks if tick.choice == "candidate"]
    assert adopted
    assert mission.leg.scale.samples in {SAMPLES + 4 + 3 * k for k in range(STEPS + 1)}


@pytest.mark.parametrize("avoidance", ["steps", "intervals"])
def test_programs_that_are_kept_have_the_covariances_that_are_known_by_then(avoidance: str) -> None:
    wind = {"shared": (WIND,)}
    scenario = fleet(wind, wind, avoidance=avoidance).scenario
    scale, states = Scale(17, 2.5), [v.start + 0.1 for v in scenario.vehicles]
    left = left_of(scenario, 1, states, 0.1, scale)
    anew = Hazards.of(left, condensed_models(left))
    kept = Ahead.of(scenario).left(1, left.vehicles, [v.goal for v in left.vehicles], scale)
    assert kept.tail == anew.tail == Tail(17)
    ours, theirs = np.array([0]), np.array([1])
    for k in range(STEPS - 1):
        at = np.array([k])
        for joint in ("joint", "joint_bent"):
            found = [getattr(hazards, joint)(at, ours, theirs) for hazards in (kept, anew)]
            np.testing.assert_allclose(*found, atol=1e-12)
    for mine, other in zip(kept.models, anew.models, strict=True):
        np.testing.assert_allclose(mine.control_bounds, other.control_bounds, rtol=1e-12)
        np.testing.assert_allclose(mine.position_covariances, other.position_covariances)
        np.testing.assert_allclose(mine.bent_covariances, other.bent_covariances)


# Alarms.


def alarmed(plan: Plan, missions: int) -> int:
    count = 0
    for seed in range(missions):
        flight = radmpc.fly(Mission(plan, planner=None), Model(plan.scenario, seed))
        count += any("disturbance" in alarm for tick in flight.ticks for alarm in tick.alarms)
    return count


@pytest.mark.slow
def test_alarms_are_as_rare_as_ever_where_covariances_are_known_up_to_a_factor(monkeypatch) -> None:
    plan = fleet({}, samples=3)
    assert alarmed(plan, 60) <= 3
    right = Watcher.look
    monkeypatch.setattr(Watcher, "look", lambda self, *given: right(self, *given[:4], Scale(None)))
    assert alarmed(plan, 60) > 10


def test_an_alarm_names_what_was_known_before(monkeypatch) -> None:
    plan = fleet({}, samples=40)
    mission = Mission(plan, planner=None)
    start = plan.scenario.vehicles[0].start
    assert not mission.step([start]).alarms
    expected = mission._expected[0]
    tick = mission.step([expected + 12.0 * np.sqrt(np.array([0.02, 0.01, 0.02, 0.0]))])
    assert any("a disturbance of" in alarm for alarm in tick.alarms)
    assert any("an F of" in alarm and "and 40 degrees of freedom" in alarm for alarm in tick.alarms)


# Recorded missions.


def test_the_file_tells_the_factor_and_another_one_is_found_out() -> None:
    plan, rows = alone(), []
    mission = RecordedMission(plan, 0, rows.append, planner=None)
    radmpc.fly(mission, Model(plan.scenario, 1))
    last = rows[-1].scale
    assert last is not None
    now = mission._sensing.evidence.scale
    assert (last.samples, last.factor) == (now.samples, now.factor)
    assert not recomputed(plan, rows).problems
    changed = replace(rows[2], scale=replace(rows[2].scale, factor=1.01 * rows[2].scale.factor))
    problems = recomputed(plan, [*rows[:2], changed, *rows[3:]]).problems
    assert any("states a factor of" in problem for problem in problems)
