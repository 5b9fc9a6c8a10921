"""Missions whose states are estimated, whose disturbances last, whose obstacles stray."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from adversary import AWAY
from noisy_scenes import (
    BOUND,
    SCENES,
    STEPS,
    beside_a_berg,
    blown,
    estimated,
    gusty,
    gusty_and_estimated,
)
from scipy.stats import beta

import radmpc
from radmpc.errors import ScenarioError
from radmpc.flying import knowing, remainder
from radmpc.flying.backends import BACKENDS
from radmpc.flying.knowing import expected_start
from radmpc.flying.leg import leg_of
from radmpc.flying.mission import Mission
from radmpc.flying.model import Model
from radmpc.flying.recording.recomputing import recomputed
from radmpc.flying.recording.recorded import RecordedMission
from radmpc.flying.remainder import left_of
from radmpc.flying.sensing.observing import Observer
from radmpc.gaussian import Tail
from radmpc.model.noise.filtering import Learning
from radmpc.model.noise.fleet import FleetLearning
from radmpc.model.plan import Plan
from radmpc.model.scenario import Scenario
from radmpc.referee import certify
from radmpc.referee.conditional.scales import Scale


def staking(scenario: Scenario, seconds: float | None = None) -> Plan:
    """Return a plan that runs all its risk in its first step, once something has been learned."""
    del seconds
    if scenario.horizon == STEPS:
        return waiting(scenario)
    vehicle, horizon = scenario.vehicles[0], scenario.horizon
    variance = vehicle.covariances(1)[1, 1, 1]
    spread = scenario.obstacles[0].spread
    if spread is not None:
        variance = variance + spread.positions[1, 1, 1]
    x, y = vehicle.start
    deviations = Tail(scenario.covariance_samples).clearance_for(scenario.risk_bound * (1.0 - 1e-6))
    clearance = vehicle.radius + np.sqrt(variance) * deviations
    path = np.full((horizon, 2), [x, AWAY])
    path[0] = [x, clearance]
    path[-1, 0] += 3.0 * (horizon - 1)
    controls = np.diff(np.vstack([[x, y], path]), axis=0)
    return leg_of(scenario, against_what_is_expected(scenario, controls), 0).plan


def against_what_is_expected(scenario: Scenario, controls: np.ndarray) -> list[np.ndarray]:
    """Return the first vehicle's controls and those of who stays, without what pushes them."""
    wanted = [controls, *(0.0 * controls for _ in scenario.vehicles[1:])]
    pushes = [vehicle.pushes(scenario.horizon) for vehicle in scenario.vehicles]
    return [u if push is None else u - push for u, push in zip(wanted, pushes, strict=True)]


def waiting(scenario: Scenario, wasted: float = 1e2) -> Plan:
    controls = np.zeros((scenario.horizon, 2))
    controls[-1, 0] = wasted
    return leg_of(scenario, [controls, *(0.0 * controls for _ in scenario.vehicles[1:])], 0).plan


def staked(scenario: Scenario, missions: int) -> tuple[int, float]:
    """Return how many missions of who stakes all of the wealth hit, and what they were charged."""
    hit, charged = 0, 0.0
    for seed in range(missions):
        mission = Mission(waiting(scenario), planner=staking, share=1.0, clock=lambda: 0.0)
        flight = radmpc.fly(mission, Model(scenario, seed))
        hit += flight.has_collided
        steps = [tick.next_step for tick in flight.ticks if tick.segments]
        charged += sum(step for step in steps if step is not None) / missions
        assert any(entry.what == "adopted" for entry in flight.account)
    return hit, charged


def least_rate(hits: int, missions: int) -> float:
    """Return the lower limit of a rate, at 99.9 %."""
    return float(beta.ppf(1e-3, hits, missions - hits + 1)) if hits else 0.0


@pytest.mark.nightly
@pytest.mark.parametrize("scene", SCENES)
def test_what_is_charged_bounds_how_often_an_adversary_hits(scene):
    missions = 500
    hits, charged = staked(scene(), missions)
    assert least_rate(hits, missions) <= charged <= BOUND
    # The adversary gets nearly all there is.
    assert hits > 0.4 * BOUND * missions
    assert charged > 0.9 * BOUND


@pytest.mark.slow
@pytest.mark.sampled(1)
@pytest.mark.parametrize("scene", SCENES)
def test_an_adversary_is_charged_all_of_the_bound_and_no_more(scene):
    # How often so few missions hit something says nothing: 6 of 20 is chance once in 3,000 times.
    _, charged = staked(scene(), 20)
    assert 0.9 * BOUND < charged <= BOUND


def all_taken_for_known(monkeypatch: pytest.MonkeyPatch) -> None:
    right = knowing.unknown_after
    coming = np.diag([0.0, 0.0, 1.0, 1.0])
    monkeypatch.setattr(knowing, "unknown_after", lambda *given: coming @ right(*given) @ coming)


def gusts_forgotten(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Learning, "carried", lambda self, step, moved: 0.0 * moved)


def tracks_taken_for_known(monkeypatch: pytest.MonkeyPatch) -> None:
    right = remainder.later

    def wrong(obstacle, passed):
        found = right(obstacle, passed)
        shape = replace(found.shape, covariance=0.0, disturbance_covariance=0.0)
        return replace(found, shape=shape, spread=None)

    monkeypatch.setattr(remainder, "later", wrong)


def winds_forgotten(monkeypatch: pytest.MonkeyPatch) -> None:
    right = FleetLearning.learned
    monkeypatch.setattr(
        FleetLearning, "learned", lambda *given: [0.0 * change for change in right(*given)]
    )


MUTANTS = [
    # One in ten missions hits something then: few missions do not tell.
    pytest.param(blown, winds_forgotten, 500, marks=pytest.mark.nightly),
    (estimated, all_taken_for_known, 60),
    (gusty, gusts_forgotten, 60),
    (beside_a_berg, tracks_taken_for_known, 60),
]


@pytest.mark.slow
@pytest.mark.sampled(1)
@pytest.mark.parametrize(("scene", "mutant", "missions"), MUTANTS)
def test_who_takes_for_known_what_is_not_is_found_out(scene, mutant, missions, monkeypatch):
    mutant(monkeypatch)
    hits, _ = staked(scene(), missions)
    assert least_rate(hits, missions) > BOUND


def by_hand(scenario: Scenario) -> Plan:
    """Return a plan under way in the scene, with controls that nobody chose."""
    controls = np.random.default_rng(4).normal(0.0, 0.3, (scenario.horizon, 2))
    controls[0, 1] -= AWAY - 0.45
    others = [0.0 * controls for _ in scenario.vehicles[1:]]
    return leg_of(replace(scenario, risk_bound=0.49), [controls, *others], 0).plan


@pytest.mark.parametrize("scene", SCENES)
def test_a_leg_from_what_is_known_is_worth_its_certificate(scene):
    plan = by_hand(scene())
    mission = Mission(plan, planner=None)
    model = Model(plan.scenario, 2)
    states, _ = model.reset()
    for step in range(STEPS - 1):
        tick = mission.step(states)
        known = mission._known
        scale = mission._sensing.evidence.scale
        left = left_of(plan.scenario, step, known, 0.4, scale)
        leg = leg_of(left, [path.controls[step:] for path in plan.trajectories], step, scale)
        now = leg.value(step, leg.begun(known), scale)
        # At step 0 of what is left nothing is charged that has been flown.
        assert leg.price == pytest.approx(certify(leg.plan).certified, rel=1e-6)
        assert now.total == pytest.approx(leg.price - leg_start(leg), rel=1e-6, abs=1e-12)
        # So is what is left of the whole, where feedback does not tell them apart.
        assert now.total == pytest.approx(mission.leg.value(step, known, scale).total, abs=0.25)
        states, _ = model.advance(tick.segments)


def leg_start(leg) -> float:
    """Return what a leg is charged for where it begins [-]."""
    return (
        leg.price
        - radmpc.referee.conditional.conditional.conditional(
            leg.witnesses,
            0,
            [expected_start(v) for v in leg.plan.scenario.vehicles],
            Scale(leg.plan.scenario.covariance_samples),
        ).total
    )


@pytest.mark.sampled(5)
@pytest.mark.parametrize("scene", SCENES)
def test_a_recorded_mission_is_recomputed_from_its_rows(scene):
    scenario = scene()
    rows = []
    mission = RecordedMission(waiting(scenario), 0, rows.append, planner=staking)
    radmpc.fly(mission, Model(scenario, 1))
    assert any(row.choice == "candidate" for row in rows)
    book = recomputed(waiting(scenario), rows)
    assert not book.problems
    told = []
    again = RecordedMission(waiting(scenario), 0, told.append, rows[:-2], planner=staking)
    for row in rows[-2:]:
        again.step(row.states)
    assert [row.value for row in told] == [row.value for row in rows[-2:]]
    assert again.balance.wealth == mission.balance.wealth


@pytest.mark.sampled(5)
@pytest.mark.parametrize("scene", SCENES)
def test_half_spaces_are_turned_to_where_vehicles_are_expected_to_drift(scene):
    plan = by_hand(scene())
    mission = Mission(plan, planner=None, warm=True)
    flight = radmpc.fly(mission, Model(plan.scenario, 3))
    assert not [t.reason for t in flight.ticks if "failed" in t.reason]
    assert any(entry.what == "adopted" for entry in flight.account)


def test_states_tell_of_gusts_what_a_filter_of_both_tells():
    """With exact states the last disturbance is seen; an estimate tells as much as its filter."""
    scenario = gusty()
    [vehicle] = scenario.vehicles
    observer = Observer.of(scenario)
    known = observer.observed(0, [expected_start(vehicle)], [vehicle.start + 0.1])
    np.testing.assert_allclose(known[0][2:], 0.0, atol=1e-15)
    seen = vehicle.start + np.array([0.13, 0.06])
    known = observer.observed(1, [np.concatenate([vehicle.start + 0.1, [0.0, 0.0]])], [seen])
    np.testing.assert_allclose(known[0], [*seen, 0.9 * 0.03, 0.9 * -0.04], atol=1e-12)
    scenario = gusty_and_estimated()
    model, observer = Model(scenario, 3), Observer.of(scenario)
    expected = [expected_start(scenario.vehicles[0])]
    states, _ = model.reset()
    for step in range(STEPS):
        known = observer.observed(step, expected, states)
        estimator = model._nature._filters[0]
        np.testing.assert_allclose(known[0], estimator.estimate, atol=1e-12)
        A, _, _ = knowing.known_loop(scenario.vehicles[0])
        expected = [A @ known[0]]
        states, _ = model.advance(radmpc.flying.tick.segments(scenario, known, [np.zeros(2)]))


@pytest.mark.parametrize("name", ["boat", "rotorpy", "irsim"])
def test_simulators_that_know_too_much_refuse_in_one_line(name):
    for scenario, text in ((estimated(), "no estimates"), (beside_a_berg(), "'berg'")):
        with pytest.raises(ScenarioError, match=text) as caught:
            BACKENDS[name].make(scenario, 0)
        assert "\n" not in str(caught.value)
