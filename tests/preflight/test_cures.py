"""What a check advises cures what it warns of."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import radmpc
from radmpc import Scenario, Vehicle, load_scenario
from radmpc.preflight.concerns import Concern, concerns_of
from radmpc.preflight.outlook import outlook_of

SCENES = Path(__file__).parent.parent / "data" / "scenes"


def warned(scenario: Scenario, kind: str) -> list[Concern]:
    return [one for one in concerns_of(outlook_of(scenario)) if one.kind == kind]


def of_scene(name: str) -> Scenario:
    return load_scenario(SCENES / f"{name}.yaml")


def number(text: str, before: str) -> float:
    """The number that follows some words."""
    found = re.search(re.escape(before) + r" ?([0-9.e+-]+[0-9])", text)
    assert found is not None, text
    return float(found[1])


def with_vehicle(scenario: Scenario, **changes: object) -> Scenario:
    (vehicle,) = scenario.vehicles
    return replace(scenario, vehicles=(replace(vehicle, **changes),))  # type: ignore[arg-type]


def alone(**more: object) -> Scenario:
    """A vehicle that is late with its limits, alone."""
    vehicle = Vehicle(
        **{
            "name": "a",
            "system": radmpc.double_integrator(1.0, 2),
            "start": [0.0, 0.0],
            "goal": radmpc.Goal.at([30.0, 0.0], 0.5),
            "radius": 0.5,
            "control_limit": 1.0,
            "speed_limit": 20.0,
            "initial_covariance": 1e-4,
            "disturbance_covariance": 1e-4,
        }
        | more,  # type: ignore[arg-type]
    )
    return Scenario("late", 1.0, 9, 0.05, [vehicle])


def regulated(vehicle: Vehicle, weight: float) -> Vehicle:
    n, m = vehicle.system.num_states, vehicle.system.num_controls
    return replace(vehicle, gain=radmpc.lqr_gain(vehicle.system, np.eye(n), weight * np.eye(m)))


def test_every_cure_of_a_gain_that_eats_the_control_cures_it() -> None:
    scenario = of_scene("soft-gain-is-the-cure")
    (concern,) = warned(scenario, "control")
    limit = number(concern.text, "raise control_limit to")
    assert warned(with_vehicle(scenario, control_limit=limit), "control") == []
    assert warned(with_vehicle(scenario, control_limit=0.98 * limit), "control") != []
    softer = regulated(scenario.vehicles[0], number(concern.text, "R ="))
    assert warned(replace(scenario, vehicles=(softer,)), "control") == []
    factor = number(concern.text, "reduce the noise to")
    vehicle = scenario.vehicles[0]
    quiet = {
        "initial_covariance": factor**2 * vehicle.initial_covariance,
        "disturbance_covariance": factor**2 * vehicle.disturbance_covariance,
    }
    assert warned(with_vehicle(scenario, **quiet), "control") == []


def test_every_cure_of_a_saturating_gain_cures_it() -> None:
    scenario = of_scene("saturates")
    (concern,) = warned(scenario, "saturation")
    cures = {
        "control_sigmas": "raise control_sigmas to",
        "control_limit": "raise control_limit to",
    }
    told = {key: words for key, words in cures.items() if words in concern.text}
    for key, words in told.items():
        assert (
            warned(with_vehicle(scenario, **{key: number(concern.text, words)}), "saturation") == []
        )
    if "R =" in concern.text:
        softer = regulated(scenario.vehicles[0], number(concern.text, "R ="))
        assert warned(replace(scenario, vehicles=(softer,)), "saturation") == []
    else:
        assert told or "none did" in concern.text


def test_a_limit_is_named_only_where_raising_it_alone_is_enough() -> None:
    scenario = alone()
    (concern,) = warned(scenario, "time")
    assert concern.is_fatal
    assert "speed_limit" not in concern.text  # it never gets that fast
    limit = number(concern.text, "raise control_limit to")
    cured = warned(with_vehicle(scenario, control_limit=limit), "time")
    assert not any(one.is_fatal for one in cured)
    slow = alone(speed_limit=3.5, control_limit=4.0)
    (concern,) = warned(slow, "time")
    assert "control_limit" not in concern.text
    limit = number(concern.text, "raise speed_limit to")
    cured = warned(with_vehicle(slow, speed_limit=limit), "time")
    assert not any(one.is_fatal for one in cured)


@pytest.mark.parametrize("limits", [(1e-3, 20.0), (1.0, 1e-3)])
def test_a_goal_out_of_reach_names_the_limit_that_was_tried(limits: tuple[float, float]) -> None:
    control, speed = limits
    scenario = alone(control_limit=control, speed_limit=speed)
    (concern,) = warned(scenario, "time")
    assert "check units" in concern.text
    # A hundred times as much of either is too little still.
    assert "raise" not in concern.text
