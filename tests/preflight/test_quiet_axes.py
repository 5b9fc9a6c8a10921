"""Axes without any disturbance, where others have one: as of a log in which they never moved."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scenes_checked import of_scene, warned

from radmpc import Scenario, SharedDisturbance


def disturbed(covariance: list[float], **changes: object) -> Scenario:
    """A scene of one vehicle with other disturbances."""
    scenario = of_scene("goal-too-near")
    vehicle = replace(scenario.vehicles[0], disturbance_covariance=covariance, **changes)
    return replace(scenario, vehicles=(vehicle,))


def test_an_axis_without_disturbances_is_told_where_others_have_some() -> None:
    scenario = disturbed([1e-4, 0.0, 1e-5, 0.0])
    name = scenario.vehicles[0].name
    (concern,) = warned(scenario, "noise")
    assert concern.vehicles == (name,)
    assert not concern.is_fatal
    assert concern.text == (
        f"Vehicle {name!r}: disturbances reach x and never y, and certificates count on that; "
        "state disturbance_covariance along y, too, unless it is so"
    )


def test_a_fleet_without_disturbances_along_an_axis_is_told_in_one_line() -> None:
    scenario = of_scene("starts-clash")
    quiet = [0.0, 1e-4, 0.0, 1e-5]
    vehicles = tuple(replace(v, disturbance_covariance=quiet) for v in scenario.vehicles)
    (concern,) = warned(replace(scenario, vehicles=vehicles), "noise")
    assert concern.vehicles == tuple(vehicle.name for vehicle in vehicles)
    assert "disturbances reach y and never x" in concern.text


def test_disturbances_of_velocities_reach_positions() -> None:
    assert warned(disturbed([0.0, 0.0, 1e-5, 1e-5]), "noise") == []
    assert warned(disturbed([1e-4, 0.0, 1e-5, 1e-5]), "noise") == []


def test_a_shared_disturbance_counts_along_its_axis() -> None:
    wind = SharedDisturbance("wind", np.eye(4)[:, 1:2], [[1e-4]])
    assert warned(disturbed([1e-4, 0.0, 1e-5, 0.0], shared=(wind,)), "noise") == []


def test_no_disturbance_at_all_is_no_quiet_axis() -> None:
    assert warned(disturbed([0.0, 0.0, 0.0, 0.0], initial_covariance=1e-4), "noise") == []
