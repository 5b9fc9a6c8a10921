"""What was far when a leg was bought: without rows, and with them once it comes near."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from conditional_missions import crowded
from referee_scenes import make_plan, straight_controls

from radmpc.model.obstacle import Obstacle
from radmpc.model.plan import Plan
from radmpc.referee import certify, gather
from radmpc.referee.conditional import conditional as module
from radmpc.referee.conditional.conditional import Conditional, conditional, witnesses_of


def apart(avoidance: str) -> Plan:
    """Return two vehicles that fly side by side, 40 m apart, and a block 40 m further."""
    plan = crowded(2, avoidance, gain=False)
    first, second = plan.scenario.vehicles
    shifted = replace(second, start=first.start + np.array([0.0, 40.0, 0.0, 0.0]), goal=first.goal)
    scenario = replace(
        plan.scenario,
        vehicles=(first, shifted),
        obstacles=(Obstacle.box("block", [-5.0, 80.0], [15.0, 81.0]),),
        workspace=None,
    )
    return make_plan(scenario, [straight_controls(first, 4)] * 2)


@pytest.fixture(autouse=True)
def skipping(monkeypatch: pytest.MonkeyPatch) -> None:
    """Have small fleets looked at as large ones are."""
    monkeypatch.setattr(gather, "_EXPLICIT", 0)


def valued(plan: Plan, pushed: float) -> Conditional:
    witnesses = witnesses_of(plan)
    states = [path[1] for path in witnesses.motion.states]
    states[1] = states[1] - np.array([0.0, pushed, 0.0, 0.0])
    return conditional(witnesses, 1, states)


@pytest.mark.parametrize("avoidance", ["steps", "intervals"])
def test_what_is_far_has_no_rows_and_its_charge_in_the_price(avoidance: str) -> None:
    plan = apart(avoidance)
    witnesses = witnesses_of(plan)
    assert len(witnesses.parties.causes) == 0
    price = conditional(witnesses, 0, None)
    assert price.total == pytest.approx(certify(plan).certified, rel=1e-12)
    assert (price.total > 0.0, price.least) == (True, 0.0)
    assert valued(plan, 0.0).total < 1e-11


@pytest.mark.parametrize("avoidance", ["steps", "intervals"])
def test_what_was_far_is_valued_by_its_rows_once_it_comes_near(
    avoidance: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    plan = apart(avoidance)
    found = [valued(plan, pushed) for pushed in (30.0, 38.9)]
    monkeypatch.setattr(gather, "_EXPLICIT", 10_000)
    expected = [valued(plan, pushed) for pushed in (30.0, 38.9)]
    assert expected[1].total > 1e-3
    for ours, theirs in zip(found, expected, strict=True):
        assert ours.total == pytest.approx(theirs.total, rel=1e-9, abs=1e-11)
        assert ours.least == pytest.approx(theirs.least, rel=1e-9, abs=1e-11)
        assert ours.next_step == pytest.approx(theirs.next_step, rel=1e-9, abs=1e-11)


def test_an_obstacle_that_was_far_is_valued_once_it_comes_near() -> None:
    plan = apart("steps")
    assert valued(plan, -39.3).total > 1e-3


def test_who_never_looks_again_is_found_out(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "is_surprised", lambda *given: False)
    assert valued(apart("steps"), 38.9).total < 1e-11
