"""Noise that is missing, and keys about noise that change nothing."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scenes_checked import of_scene, warned

from radmpc import Measurement, Obstacle, Scenario, SharedDisturbance


def changed(**changes: object) -> Scenario:
    """A scene of one vehicle with other fields, and nothing that a check has to find a cure for."""
    scenario = of_scene("goal-too-near")
    return replace(scenario, obstacles=(), vehicles=(replace(scenario.vehicles[0], **changes),))


def quiet(**changes: object) -> Scenario:
    return changed(initial_covariance=0.0, disturbance_covariance=0.0, **changes)


def astray(*names: str) -> tuple[Obstacle, ...]:
    hull = [[-1.0, -1.0], [1.0, -1.0], [0.0, 1.0]]
    return tuple(Obstacle.tracked(n, hull, [300.0, 300.0, 0.0, 0.0], 1e-2) for n in names)


def test_without_any_noise_a_certificate_says_nothing() -> None:
    (concern,) = warned(quiet(), "noise")
    assert "their certificate says nothing" in concern.text


@pytest.mark.parametrize(
    ("names", "told"), [(["ship"], "'ship' will be"), (["ship", "tug"], "'ship' and 1 more will")]
)
def test_a_track_with_noise_is_what_a_certificate_speaks_of(names, told) -> None:
    (concern,) = warned(replace(quiet(), obstacles=astray(*names)), "noise")
    assert told in concern.text
    assert "speaks of that alone" in concern.text
    assert "nothing" not in concern.text


def test_a_shared_disturbance_is_noise() -> None:
    wind = SharedDisturbance("wind", np.eye(4), 1e-4)
    assert warned(quiet(shared=(wind,)), "noise") == []


def test_a_shared_disturbance_that_acts_on_nobody_is_told() -> None:
    idle = SharedDisturbance("wind", np.zeros((4, 2)), 1e-4)
    (concern,) = warned(changed(shared=(idle,)), "noise")
    assert "Shared disturbance 'wind' acts on nobody" in concern.text


def test_a_measurement_without_feedback_is_told() -> None:
    places = Measurement.of([0, 1], 4, 0.01)
    (concern,) = warned(changed(measurement=places, gain=None), "noise")
    assert "measurement changes no plan without feedback" in concern.text


def test_a_measurement_of_nothing_is_told() -> None:
    gain = np.hstack([-0.02 * np.eye(2), -0.1 * np.eye(2)])
    nothing = Measurement(np.zeros((2, 4)), 0.01)
    (concern,) = warned(changed(measurement=nothing, gain=gain), "noise")
    assert "measurement.matrix is all zeros" in concern.text
    some = Measurement.of([0, 1], 4, 0.01)
    assert warned(changed(measurement=some, gain=gain), "noise") == []
