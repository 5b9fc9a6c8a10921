"""What is told to help was tried, and what does not help is not told."""

from __future__ import annotations

from dataclasses import replace

import pytest

from radmpc import Goal, Scenario, Vehicle, double_integrator
from radmpc.planners.cures.trying import passage_sentence, reach_sentence
from radmpc.planners.cures.variants import longer_horizons
from radmpc.solvers.solution import Limits


def pair() -> Scenario:
    def one(name: str, y: float) -> Vehicle:
        return Vehicle(
            name=name,
            system=double_integrator(1.0, 2),
            start=[0.0, y],
            goal=Goal.at([8.0, y], 0.2),
            radius=0.3,
            control_limit=2.0,
            initial_covariance=0.01,
            disturbance_covariance=0.01,
        )

    return Scenario("pair", 1.0, 10, 0.02, [one("a", 0.0), one("b", 5.0)])


@pytest.mark.parametrize(
    ("does", "told"),
    [
        (lambda s, _: s.horizon >= 14, "lengthen the horizon to 16 steps (16 s)."),
        (lambda s, _: s.risk_bound > 0.05, "raise risk_bound to 0.08."),
        (lambda s, _: s.num_pair_faces > 4, "raise pair_faces to 8."),
        (
            lambda s, _: s.vehicles[0].initial_covariance[0, 0] < 1e-3,
            "reduce the noise to 0.25 of its standard deviations.",
        ),
    ],
)
def test_the_mildest_change_that_does_is_told_alone(does, told):
    assert passage_sentence(pair(), does, Limits()) == f"What helps, as tried: {told}"


def test_nothing_is_told_where_nothing_does_or_no_time_is_left():
    assert passage_sentence(pair(), lambda *_: False, Limits()) == ""
    assert passage_sentence(pair(), lambda *_: True, Limits(deadline=0.0)) == ""
    assert reach_sentence(pair(), (0,), lambda *_: False, Limits()) == ""


def test_only_what_is_late_is_changed_to_reach_its_goal():
    seen = set()

    def does(changed, limits):
        del limits
        seen.add(tuple(vehicle.name for vehicle in changed.vehicles))
        return float(changed.vehicles[0].control_limit[0]) == 3.0

    text = reach_sentence(pair(), (1,), does, Limits())
    assert text == "What helps, as tried: raise control_limit to 1.5 times its value."
    assert seen == {("b",)}


def test_a_bound_that_nobody_wants_is_not_tried():
    bold = replace(pair(), risk_bound=0.2)
    assert passage_sentence(bold, lambda s, _: s.risk_bound > 0.2, Limits()) == ""


def test_horizons_to_try_are_longer_each():
    short = replace(pair(), horizon=1)
    assert longer_horizons(short) == (2,)
    assert longer_horizons(pair()) == (12, 16, 22)
