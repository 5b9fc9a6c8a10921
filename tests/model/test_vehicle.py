"""What a vehicle is made of, as people write it."""

from __future__ import annotations

import numpy as np
import pytest

from radmpc import Goal, Scenario, ScenarioError, Vehicle, double_integrator


def make(**changes: object) -> Vehicle:
    fields: dict[str, object] = {
        "name": "tug",
        "system": double_integrator(1.0, 2),
        "start": [1.0, 2.0],
        "goal": Goal.at([5.0, 5.0]),
        "radius": 0.5,
        "control_limit": 2.0,
        "initial_covariance": 0.0,
        "disturbance_covariance": [1e-3, 1e-3, 1e-4, 1e-4],
    }
    return Vehicle(**(fields | changes))  # type: ignore[arg-type] # fields by name


def test_a_position_is_a_start_at_rest() -> None:
    np.testing.assert_array_equal(make().start, [1.0, 2.0, 0.0, 0.0])
    np.testing.assert_array_equal(make(start=[1, 2, 3, 4]).start, [1.0, 2.0, 3.0, 4.0])
    with pytest.raises(ScenarioError, match=r"2 numbers \(a position\) or 4 \(a full state\)"):
        make(start=[1.0])


def test_one_number_is_a_limit_on_every_axis() -> None:
    vehicle = make(speed_limit=3)
    np.testing.assert_array_equal(vehicle.control_limit, [2.0, 2.0])
    np.testing.assert_array_equal(vehicle.speed_limit, [3.0, 3.0])
    with pytest.raises(ScenarioError, match="control_limit"):
        make(control_limit=[1.0, 2.0, 3.0])
    with pytest.raises(ScenarioError, match="control_limit"):
        make(control_limit="fast")


def test_a_goal_stands_around_its_center() -> None:
    goal = Goal.at([4, 5], half_width=[0.2, 0.3], speed=0.1)
    np.testing.assert_allclose([goal.lower, goal.upper], [[3.8, 4.7], [4.2, 5.3]])
    np.testing.assert_array_equal(goal.speed, [0.1, 0.1])
    assert Goal.at([4, 5], speed=None).speed is None
    with pytest.raises(ScenarioError, match="min must not exceed max"):
        Goal.at([4, 5], half_width=-1.0)


def test_values_are_frozen_whatever_they_were_made_of() -> None:
    vehicle = make()
    for array in (vehicle.start, vehicle.control_limit, vehicle.goal.lower):
        assert not array.flags.writeable


def test_a_double_integrator_of_another_step_is_refused() -> None:
    with pytest.raises(ScenarioError, match=r"vehicles\[0\].dynamics: .* dt = 0.5 s"):
        Scenario("bay", dt=0.5, horizon=5, risk_bound=0.05, vehicles=(make(),))
