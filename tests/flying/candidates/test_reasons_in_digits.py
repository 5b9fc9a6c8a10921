"""Numbers that reasons and alarms set against each other differ in what is printed of them."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from adversary import beside_a_wall

from radmpc.flying.account import Account
from radmpc.flying.deciding import objection
from radmpc.flying.leg import leg_of
from radmpc.flying.mission import Mission
from radmpc.wording import distinct_texts


@pytest.mark.parametrize(
    ("one", "other", "texts"),
    [
        (0.0516, 0.05, ("0.0516", "0.05")),
        (0.05002, 0.05, ("0.05002", "0.05")),
        (0.050000000002, 0.05, ("0.050000000002", "0.05")),
        (0.05, 0.05, ("0.05", "0.05")),
    ],
)
def test_as_many_digits_are_told_as_tell_two_numbers_apart(
    one: float, other: float, texts: tuple[str, str]
) -> None:
    assert distinct_texts(one, other) == texts


def test_a_tail_that_barely_risks_too_much_is_told_with_enough_digits() -> None:
    scenario = beside_a_wall()
    plan = leg_of(scenario, [np.zeros((10, 2))], 0).plan
    states = [scenario.vehicles[0].start]
    value = Mission(plan, planner=None).step(states).value
    assert value is not None
    tight = replace(plan, scenario=replace(scenario, risk_bound=value))
    mission = Mission(tight, planner=None)
    mission._account = replace(mission._account, risk_bound=value * (1.0 - 1e-6))
    [alarm] = mission.step(states).alarms
    risks, allowed = alarm.removeprefix("what is left risks ").split(", more than Δ = ")
    assert float(risks) > float(allowed)


def test_a_candidate_barely_above_what_remains_is_told_with_enough_digits() -> None:
    moment = SimpleNamespace(account=Account(0.05, 0.0, 0.04921), is_unsafe=False)
    told = objection(moment, 0.04924, (1.0, 0.5), is_first=True)
    assert told == "the candidate risks 0.04924, and 0.04921 remains"
