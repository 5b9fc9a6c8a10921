"""Prices that go nowhere stay numbers, and placing vehicles stops when told to."""

from __future__ import annotations

import numpy as np
import pytest

from radmpc.experiments.families import circle
from radmpc.planners.certified.turned.narrow.prioritized import prioritized_ticks
from radmpc.planners.certified.turned.paths import Paths
from radmpc.planners.certified.turned.price_control import PriceControl
from radmpc.planners.certified.turned.price_tuning import PRICE_TUNING
from radmpc.planners.outcome import record
from radmpc.planners.presets import parse_planner
from radmpc.planning import plan
from radmpc.program.build import condensed_models
from radmpc.program.hazards import Hazards
from radmpc.referee import certify
from radmpc.referee.propagation import FleetNoise

SCENARIO = circle(4)
HAZARDS = Hazards.of(SCENARIO, condensed_models(SCENARIO))


def test_a_price_that_never_helps_stays_finite() -> None:
    control = PriceControl(2.0, 1e-8, 1e-3)
    paths = Paths(HAZARDS).state()
    for number in range(1000):
        control.follow(0.5, 10.0 - 1e-3 * number, paths)
    assert control.price == 2.0 * PRICE_TUNING.dearest


def test_rounds_end_once_neither_moves_nor_risk_left_promise_anything() -> None:
    control = PriceControl(1.0, 0.05, 1e-3)
    paths = Paths(HAZARDS).state()
    control.begin(0.03, 10.0, paths)
    control.follow(0.03, 9.0, paths, 0.04)
    assert not control.is_over
    # All that was gained is what the risk is worth that was spent.
    control.price = 1.0
    control.follow(0.0499, 9.0 - 0.0199, paths, 0.0499)
    assert control.is_over


def test_a_large_fleet_pays_twice_as_much_at_once_where_a_round_ends_just_above_the_bound() -> None:
    usual, urgent = (
        PriceControl(1.0, 0.05, 1e-3, is_urgent=is_urgent) for is_urgent in (False, True)
    )
    paths = Paths(HAZARDS).state()
    for control in (usual, urgent):
        control.begin(1.5, 320.0, paths)
        control.follow(0.0526, 337.0, paths)
    assert usual.price < 1.1
    assert urgent.price == PRICE_TUNING.urgency * usual.price


def test_a_price_is_not_hurried_where_certificates_are_already_close_to_the_bound() -> None:
    near, far = (PriceControl(1.0, 0.05, 1e-3) for _ in range(2))
    paths = Paths(HAZARDS).state()
    for control, certified in ((near, 0.055), (far, 0.06)):
        control.begin(0.5, 9.0, paths)
        for cost in (9.5, 10.0, 10.5):
            control.follow(certified, cost, paths)
    followed = (0.055 / (PRICE_TUNING.aim * 0.05)) ** PRICE_TUNING.damping
    assert near.price == pytest.approx(followed**3)
    followed = (0.06 / (PRICE_TUNING.aim * 0.05)) ** PRICE_TUNING.damping
    assert far.price == pytest.approx(followed**3 * PRICE_TUNING.impatience ** (1 + 2))


def test_a_large_fleet_gives_up_a_start_whose_risk_does_not_fall_as_its_price_rises() -> None:
    control = PriceControl(1.0, 0.05, 1e-3, is_urgent=True)
    paths = Paths(HAZARDS).state()
    control.begin(0.9, 60.0, paths)
    for certified, cost in ((0.11, 63.0), (0.084, 60.0), (0.0765, 61.0), (0.0746, 66.0)):
        control.follow(certified, cost, paths)
        assert not control.is_over
    control.follow(0.0764, 74.0, paths)
    assert control.is_over


def test_rounds_go_on_while_much_risk_is_left() -> None:
    control = PriceControl(10.0, 0.05, 1e-3)
    paths = Paths(HAZARDS).state()
    control.begin(0.03, 10.0, paths)
    for _ in range(2):
        control.follow(0.03, 10.0, paths, 0.03)
        assert not control.is_over


@pytest.mark.parametrize(("rival", "is_over"), [(9.0, True), (9.9, False), (np.inf, False)])
def test_rounds_end_early_only_far_behind_a_plan_from_elsewhere(
    rival: float, is_over: bool
) -> None:
    control = PriceControl(1.0, 0.05, 1e-3, rival)
    paths = Paths(HAZARDS).state()
    control.begin(0.03, 12.0, paths)
    for cost in (11.0, 10.1, 10.0):
        assert not control.is_over
        control.follow(0.03, cost, paths, 0.03)
    assert control.is_over == is_over


def test_rounds_that_swing_for_ever_end() -> None:
    control = PriceControl(1.0, 0.05, 1e-3)
    paths = Paths(HAZARDS).state()
    control.begin(0.03, 10.0, paths)
    rounds = 0
    while not control.is_over:
        certified, cost = ((0.065, 9.9), (0.03, 10.1))[rounds % 2]
        control.follow(certified, cost, paths, certified)
        rounds += 1
    assert rounds == PRICE_TUNING.most_idle


def test_a_certificate_just_above_the_bound_calls_for_a_higher_price_not_for_going_back() -> None:
    control = PriceControl(1.0, 0.05, 1e-3)
    paths = Paths(HAZARDS).state()
    control.begin(0.03, 10.0, paths)
    for _ in range(2):
        before = control.price
        assert control.follow(0.0505, 9.9, paths, 0.0505) is None
        assert before < control.price < 1.2 * before


def test_the_referee_is_asked_once_for_what_is_the_same(monkeypatch: pytest.MonkeyPatch) -> None:
    asked = []
    ledger_under = record.ledger_under

    def judge(noise: FleetNoise, controls: tuple[np.ndarray, ...]):
        assert noise.scenario is SCENARIO
        asked.append(controls)
        return ledger_under(noise, controls)

    monkeypatch.setattr(record, "ledger_under", judge)
    referee = record.Certifying(SCENARIO, parse_planner("certified"))

    def of(push: float) -> tuple[np.ndarray, ...]:
        return tuple(np.full((SCENARIO.horizon, 2), push) for _ in SCENARIO.vehicles)

    first = referee.verdict(of(0.01))
    assert referee.verdict(of(0.01)) is first
    assert referee(of(0.01)).certified == first.certified
    assert len(asked) == 1
    for number in range(20):
        referee.verdict(of(0.02 + 0.001 * number))
    assert len(asked) == 21
    # What was asked long ago is asked again.
    referee.verdict(of(0.01))
    assert len(asked) == 22


def test_what_planners_are_told_is_what_a_certificate_of_the_plan_says() -> None:
    found = plan(SCENARIO, "certified", rng=0)
    controls = tuple(t.controls for t in found.plan.trajectories)
    referee, certificate = (
        record.Certifying(SCENARIO, parse_planner("certified")),
        certify(found.plan),
    )
    told = referee.verdict(controls)
    assert (told.certified, tuple(told.ledger)) == (certificate.certified, certificate.ledger)
    assert referee(controls).holds
    assert referee(controls).saturation == certificate.saturation


def test_placing_vehicles_asks_at_every_tick_whether_to_stop() -> None:
    asked = []

    def is_stopped() -> bool:
        asked.append(True)
        return len(asked) > 5

    placed, ticks = prioritized_ticks(HAZARDS, is_stopped)
    assert not placed
    assert len(asked) <= 8 < ticks * SCENARIO.horizon


def test_vehicles_that_are_placed_keep_clear_of_each_other_at_every_tick() -> None:
    placed, _ = prioritized_ticks(HAZARDS, lambda: False)
    assert len(placed) == 4
    for i in range(4):
        for j in range(i):
            apart = np.linalg.norm(placed[i][1:] - placed[j][1:], axis=1)
            assert apart.min() >= HAZARDS.radii[i] + HAZARDS.radii[j]
