"""Whether controls keep a vehicle's limits is told the same in whatever units."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from radmpc.model.dynamics import double_integrator
from radmpc.model.scenario import Scenario
from radmpc.model.vehicle import Goal, Vehicle
from radmpc.program.build import condensed_models
from radmpc.program.limits.hard import keeps_hard_rows
from rescaling import in_units

UNITS = [(1.0, 1.0), (1e3, 1.0), (1e-3, 1.0), (1.0, 3600.0), (1e-3, 1e3), (1e3, 1e-3)]

THERE = np.repeat([[0.25, 0.0], [-0.25, 0.0]], 4, axis=0)
"""Controls that go 4 m along the first axis and stop; the fastest is 1 m/s."""


def scene(**more: object) -> Scenario:
    options: dict[str, object] = {"control_limit": [0.25, 0.25], "speed_limit": [1.0, 1.0]}
    vehicle = Vehicle(
        name="a",
        system=double_integrator(1.0, 2),
        start=np.zeros(4),
        radius=0.3,
        initial_covariance=1e-4,
        disturbance_covariance=1e-4,
        **({"goal": Goal.at([4.0, 0.0], 0.1)} | options | more),  # type: ignore[arg-type] # keys by name
    )
    return Scenario("kept", 1.0, 8, 0.05, (vehicle,))


@pytest.mark.parametrize(("length", "time"), UNITS)
def test_controls_within_limits_keep_them_and_those_one_percent_beyond_do_not(
    length: float, time: float
) -> None:
    push = length / time**2
    faults = (
        scene(control_limit=[0.2475, 0.25]),
        scene(speed_limit=[0.99, 1.0]),
        scene(goal=Goal.at([4.043, 0.0], 0.04)),
    )
    (model,) = condensed_models(in_units(scene(), length, time))
    assert keeps_hard_rows(model, push * THERE)
    for wrong in faults:
        (model,) = condensed_models(in_units(wrong, length, time))
        assert not keeps_hard_rows(model, push * THERE)


@pytest.mark.parametrize(("length", "time"), UNITS)
def test_a_stop_is_one_in_all_units(length: float, time: float) -> None:
    push = length / time**2
    rolling = np.array(THERE)
    rolling[-1, 0] *= 0.99
    for goal, kept in ((Goal.at([4.0, 0.0], 0.1), False), (Goal.at([4.0, 0.0], 0.1, None), True)):
        plain = scene()
        vehicle = replace(plain.vehicles[0], goal=goal)
        (model,) = condensed_models(in_units(replace(plain, vehicles=(vehicle,)), length, time))
        assert keeps_hard_rows(model, push * rolling) == kept
