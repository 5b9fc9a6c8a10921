"""Feedback that makes deviations grow is called so."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scenes_checked import of_scene, warned

from radmpc import Scenario
from radmpc.preflight.concerns import concerns_of
from radmpc.preflight.feedback import is_unstable, loop_radius
from radmpc.preflight.outlook import outlook_of


def steered(gain: object) -> Scenario:
    """A scene of one vehicle with another gain, and nothing that a check has to find a cure for."""
    scenario = of_scene("goal-too-near")
    return replace(scenario, obstacles=(), vehicles=(replace(scenario.vehicles[0], gain=gain),))


def gain_of(position: float, velocity: float) -> np.ndarray:
    return np.hstack([position * np.eye(2), velocity * np.eye(2)])


@pytest.mark.sampled(1)
@pytest.mark.parametrize(("position", "velocity"), [(0.02, 0.1), (0.01, 0.0), (-0.2, -0.2)])
def test_unstable_feedback_is_told_once_and_with_what_makes_it_stable(position, velocity) -> None:
    scenario = steered(gain_of(position, velocity))
    (concern,) = warned(scenario, "feedback")
    radius = loop_radius(scenario.vehicles[0])
    assert f"A + BK has a spectral radius of {radius:.3g}" in concern.text
    assert radius > 1.01
    assert ("sign is opposite" in concern.text) == (position > 0.0)
    near = replace(scenario, obstacles=of_scene("goal-too-near").obstacles)
    told = " ".join(one.text for one in concerns_of(outlook_of(near)))
    assert "soften" not in told
    assert "stiffen" not in told


def test_a_gain_of_the_wrong_sign_is_turned_where_that_is_enough() -> None:
    scenario = steered(gain_of(0.02, 0.1))
    (concern,) = warned(scenario, "feedback")
    assert "turn the sign of the gain" in concern.text
    assert not is_unstable(steered(gain_of(-0.02, -0.1)).vehicles[0])
    # Without damping it is unstable either way.
    (undamped,) = warned(steered(gain_of(0.01, 0.0)), "feedback")
    assert "turn the sign" not in undamped.text


def test_no_feedback_and_feedback_that_brings_back_are_not_unstable() -> None:
    assert warned(steered(None), "feedback") == []
    assert warned(steered(gain_of(-0.02, -0.1)), "feedback") == []
    # It leaves places alone: a deviation stays, and does not grow.
    assert warned(steered(gain_of(0.0, -0.1)), "feedback") == []
