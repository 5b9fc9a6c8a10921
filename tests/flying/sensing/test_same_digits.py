"""How well vehicles are known is the same to the last digit, whatever legs were flown before."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

import radmpc
from radmpc.experiments.families import paper
from radmpc.flying.mission import Mission
from radmpc.flying.model import Model
from radmpc.model.noise.measurement import Measurement
from radmpc.model.scenario import Scenario


def uncertain(mission: Mission, scenario: Scenario) -> list[bytes]:
    """Fly a mission; return to the last bit how well vehicles are known at its steps."""
    model, found = Model(scenario, 0), []
    states, contacts = model.reset()
    while not mission.is_over:
        if len(mission.ticks) < scenario.horizon:
            for vehicle in mission.remainder(states).vehicles:
                known = vehicle.belief
                found.append(vehicle.initial_covariance.tobytes())
                found.append(b"" if known is None else known.covariance.tobytes())
        tick = mission.step(states, contacts=contacts)
        if tick.segments:
            states, contacts = model.advance(tick.segments)
    return found


def with_inertia() -> Scenario:
    """Return a vehicle in gusts that measures sums of its states, and nothing in its way."""
    [vehicle] = paper(1, 1).vehicles
    sums = np.random.default_rng(1).normal(size=(4, 4))
    sensor = Measurement(sums, 2e-4 * np.diag([1.0, 0.4, 1.1, 1.2]))
    pushed = np.random.default_rng(2).normal(size=(4, 2))
    noisy = 3e-5 * pushed @ pushed.T
    vehicle = replace(vehicle, measurement=sensor, disturbance_correlation=0.5)
    vehicle = replace(vehicle, disturbance_covariance=noisy, initial_covariance=noisy)
    scenario = replace(paper(1, 1), vehicles=(vehicle,), obstacles=(), workspace=None)
    return replace(scenario, horizon=8)


def test_how_well_vehicles_are_known_does_not_depend_on_the_legs_before() -> None:
    # Otherwise a flight that goes on from its file would differ in the last digits.
    scenario = with_inertia()
    plan = radmpc.plan(scenario, rng=0).require()
    kept, anew = (Mission(plan, planner=planner) for planner in (None, "certified"))
    first, second = uncertain(kept, scenario), uncertain(anew, scenario)
    assert sum(entry.what == "adopted" for entry in anew.account) >= 3
    assert first == second
