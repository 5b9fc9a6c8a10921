"""Flights whose control limits are small numbers, as in kilometers and steps of 1,000 s."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from recorded_flights import certified, forged

import radmpc
from radmpc.flying.leg import leg_of
from radmpc.flying.recording.campaign import begin_flight
from radmpc.flying.recording.verifying import flight_problems
from radmpc.io.flight.flight_file import load_flight
from radmpc.io.flight.record import FlightSettings

LIMIT = 2e-10
"""Of control, 0.2 µm/s² [km/s²]."""


def _drifter() -> radmpc.Plan:
    """A plan that pushes a drifting buoy at half of its limit for a while."""
    vehicle = radmpc.Vehicle(
        name="buoy",
        system=radmpc.double_integrator(1000.0, 2),
        start=[0.0, 0.0, 0.0, 0.0],
        goal=radmpc.Goal.at([0.0, 0.0], 1.0, None),
        radius=3e-4,
        control_limit=LIMIT,
        initial_covariance=0.0,
        disturbance_covariance=np.diag([1e-9, 1e-9, 1e-17, 1e-17]),
    )
    scenario = radmpc.Scenario("drifter", 1000.0, 4, 0.05, (vehicle,))
    return certified(leg_of(scenario, [np.full((4, 2), 0.5 * LIMIT)], 0).plan)


def test_a_control_that_is_not_the_legs_is_found_out_however_small(tmp_path: Path) -> None:
    path = tmp_path / "drifter.flight.jsonl"
    begin_flight(_drifter(), FlightSettings(replan=None, missions=1, seed=0), path=path)
    assert flight_problems(load_flight(path)) == ()
    forged(path, 3, lambda row: row.update({"controls": [[0.5 * LIMIT, 0.0]]}))
    problems = flight_problems(load_flight(path))
    assert any("the leg says" in problem for problem in problems), problems
