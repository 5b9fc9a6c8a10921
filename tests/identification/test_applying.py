"""What goes into scenarios: true, or on the safe side."""

from __future__ import annotations

import numpy as np
import pytest

from radmpc import Scenario
from radmpc.identification import Track, identify
from radmpc.importing.logs.applying import with_noise
from radmpc.importing.logs.block import noise_block
from radmpc.io.native.scenario_file import decode_scenario
from simulator import Truth, fly


def renamed(track: Track, name: str) -> Track:
    return Track(name, track.source, track.clock, track.times, track.positions, track.velocities,
                 track.controls, track.references)  # fmt: skip


def scenario(*names: str) -> Scenario:
    goal = {"center": [10.0, 0.0], "half_width": 1.0}
    return decode_scenario(
        {
            "format": "radmpc/scenario/1",
            "name": "fleet",
            "dt": 0.5,
            "horizon": 20,
            "risk_bound": 0.05,
            "defaults": {"radius": 0.5, "control_limit": 5.0},
            "vehicles": [
                {"name": name, "start": [0.0, 5.0 * i], "goal": {**goal, "center": [10.0, 5.0 * i]}}
                for i, name in enumerate(names)
            ],
        }
    )


def test_a_vehicle_in_no_log_gets_the_largest_noise_of_those_that_differ() -> None:
    [calm], [wild] = fly(Truth(), 1), fly(Truth(scale=4.0), 2)
    found = identify([renamed(calm, "calm"), renamed(wild, "wild")])
    assert found.differ
    changed, warnings = with_noise(scenario("calm", "other"), found, "today")
    calm_one, other = (np.array(one.disturbance_covariance) for one in changed.vehicles)
    assert np.diag(other) == pytest.approx(4.0 * np.diag(calm_one), rel=0.5)
    assert any("it gets the largest noise of any of them" in line for line in warnings)
