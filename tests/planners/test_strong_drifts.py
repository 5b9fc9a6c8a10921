"""Drifts that are faster than a vehicle are named as the reason that there is no plan."""

from __future__ import annotations

from dataclasses import replace

import pytest

import radmpc
from radmpc import Scenario, Vehicle
from radmpc.planners.reaching.drifting import strong_drift_text
from radmpc.preflight.concerns import concerns_of
from radmpc.preflight.outlook import outlook_of


def drifting(rate: float, goal: float = 20.0, axis: int = 0, **more: object) -> Vehicle:
    drift = [0.0] * 4
    drift[axis] = 0.5 * rate
    values = {
        "name": "a",
        "system": radmpc.double_integrator(0.5, 2),
        "start": [0.0, 0.0],
        "goal": radmpc.Goal.at([goal, 0.0], 0.5),
        "radius": 0.5,
        "control_limit": 1.5,
        "speed_limit": 3.0,
        "initial_covariance": 1e-4,
        "disturbance_covariance": 1e-4,
        "drift": drift,
    }
    return Vehicle(**values | more)  # type: ignore[arg-type] # fields by name


@pytest.mark.parametrize(
    ("vehicle", "told"),
    [
        (drifting(-3.5), "the drift of -3.5 m/s along x is faster than speed_limit 3"),
        (drifting(4.0, axis=1), "the drift of 4 m/s along y is faster than speed_limit 3"),
        (drifting(-2.9), None),  # slow, but ahead
        (drifting(4.0), None),  # along the way
        (drifting(9.0), "the drift of 9 m/s along x is faster than speed_limit 3"),  # past it
        (drifting(-3.5, speed_limit=None), None),
        (drifting(-3.5, drift=None), None),
    ],
)
def test_a_drift_is_named_where_it_carries_a_vehicle_past_its_goal(vehicle, told) -> None:
    assert strong_drift_text(vehicle, 0.5, 28) == told


def test_check_and_plan_name_the_drift_and_no_feedback() -> None:
    scenario = Scenario("river", 0.5, 28, 0.05, [drifting(-3.5)])
    [time] = [one.text for one in concerns_of(outlook_of(scenario)) if one.kind == "time"]
    assert "the drift of -3.5 m/s along x is faster than speed_limit 3" in time
    assert "units" not in time
    explanation = radmpc.plan(scenario, "certified(0)", rng=0).explanation
    assert "the drift of -3.5 m/s along x is faster than speed_limit 3" in explanation
    assert "feedback" not in explanation


def pushed(rate: float, axis: int = 0, **more: object) -> Vehicle:
    """A vehicle that something pushes, at a rate [m/s²], of 1.5 that its control takes."""
    drift = [0.0] * 4
    drift[2 + axis] = 0.5 * rate
    return drifting(0.0, drift=drift, **more)


@pytest.mark.parametrize(
    ("vehicle", "told"),
    [
        (pushed(-1.8), "the push of -1.8 m/s² by drift along x is stronger than its control"),
        (pushed(2.0, axis=1), "the push of 2 m/s² by drift along y is stronger than its control"),
        (
            pushed(-1.8, speed_limit=None),
            "the push of -1.8 m/s² by drift along x is stronger than its control",
        ),
        (
            pushed(1.8),  # past its speed limit
            "the push of 1.8 m/s² by drift along x is stronger than its control",
        ),
        (pushed(-1.4), None),  # its control is stronger
        (
            replace(pushed(1.51, speed_limit=None), goal=radmpc.Goal.at([20.0, 0.0], 0.5, None)),
            None,
        ),
        (
            pushed(1.51, speed_limit=None),  # too fast to stop
            "the push of 1.51 m/s² by drift along x is stronger than its control",
        ),
    ],
)
def test_a_push_is_named_where_it_carries_a_vehicle_off_against_all_of_its_control(
    vehicle, told
) -> None:
    assert strong_drift_text(vehicle, 0.5, 28) == told


def checked(vehicle: Vehicle, horizon: int) -> str:
    """What a check says of the time of a vehicle."""
    outlook = outlook_of(Scenario("river", 0.5, horizon, 0.05, [vehicle]))
    [time] = [one.text for one in concerns_of(outlook) if one.kind == "time"]
    return time


@pytest.mark.parametrize("limit", [3.0, None])
def test_check_names_a_push_that_is_stronger_than_the_control_and_no_units(limit) -> None:
    for horizon in (5, 28):
        told = checked(pushed(-1.8, speed_limit=limit), horizon)
        assert "the push of -1.8 m/s² by drift along x is stronger than its control" in told
        assert "units" not in told


def test_check_names_a_drift_that_no_speed_holds_against_at_a_goal_on_its_way() -> None:
    # Fewer steps than these 40 would do; the least time is looked for in more of them alone.
    vehicle = drifting(3.4, goal=20.0)
    vehicle = replace(vehicle, goal=radmpc.Goal.at([20.0, 0.0], 0.5, 0.05), speed_limit=2.5)
    told = checked(vehicle, 40)
    assert "the drift of 3.4 m/s along x is faster than speed_limit 2.5" in told
    assert "units" not in told
