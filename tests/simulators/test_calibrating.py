from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from boats import sea

from radmpc.errors import ArgumentError
from radmpc.flying.model import Backend, Model
from radmpc.identification.intervals import Interval
from radmpc.model.dynamics import double_integrator
from radmpc.model.plan import Plan
from radmpc.model.scenario import Scenario
from radmpc.model.vehicle import Vehicle
from radmpc.planning import plan
from radmpc.simulators.boat import Boat
from radmpc.simulators.calibration.calibrate import Calibration, calibrate
from radmpc.simulators.calibration.covering import Strays, deviation_ratio, white_covariance
from radmpc.simulators.calibration.missions import flown, rate_of

pytestmark = pytest.mark.slow


def boats(scenario: Scenario, rng: np.random.Generator) -> Backend:
    """Return what everything here is flown with."""
    return Boat(scenario, rng=rng)


@pytest.fixture(scope="module")
def hopeful() -> Plan:
    """Return a plan that takes waves for a fifth of what they are."""
    return plan(sea(deviation=0.02), rng=0, time_limit=10).require()


def calibrated(made: Plan, missions: int) -> tuple[Calibration, Plan]:
    """Return what a boat's missions tell, and a plan that knows it."""
    found = calibrate(made, boats, missions=missions, seed=1, day="2026-01-01")
    return found, plan(found.scenario, rng=0, time_limit=10).require()


def test_boats_contradict_noise_that_is_made_up_and_not_their_own(hopeful: Plan) -> None:
    found, better = calibrated(hopeful, 8)
    assert found.rate.doubted == 8
    before, after = (p.scenario.vehicles[0].disturbance_covariance for p in (hopeful, better))
    assert np.all(np.diag(after) > 4.0 * np.diag(before))
    rate = rate_of(better.scenario, flown(better, boats, 8, 2))
    assert rate.doubted <= 2
    assert rate.low <= better.risk.certified <= better.scenario.risk_bound
    assert found.scenario.source["noise"]["logs"] == ["8 missions"]
    assert found.scenario.source["noise"]["by_deviations"] == [round(found.covers[0].ratio, 3)]


def test_feedback_is_found_again_and_a_softer_one_is_not_taken_for_it(hopeful: Plan) -> None:
    def linear(scenario: Scenario, rng: np.random.Generator) -> Backend:
        return Model(scenario, rng)

    found = calibrate(hopeful, linear, missions=10, seed=3, day="2026-01-01")
    assert [loop.vehicle for loop in found.loops] == ["east", "west"]
    assert not any(loop.differs for loop in found.loops)
    assert all(replace(loop, planned=0.3 * loop.planned).differs for loop in found.loops)


@pytest.mark.sampled(1)
@pytest.mark.parametrize("is_common", [True, False])
def test_a_drift_is_planned_with_if_vehicles_have_it_in_common(
    hopeful: Plan, is_common: bool
) -> None:
    east, west = hopeful.scenario.vehicles
    drift = np.array([0.1, 0.05, 0.0, 0.0])
    ways = (drift, drift if is_common else -drift)
    pair = [replace(v, drift=way) for v, way in zip((east, west), ways, strict=True)]

    def drifting(scenario: Scenario, rng: np.random.Generator) -> Backend:
        return Model(replace(scenario, vehicles=pair), rng)

    found = calibrate(hopeful, drifting, missions=6, seed=3, day="2026-01-01").scenario
    for vehicle in found.vehicles:
        if is_common:
            assert vehicle.drift == pytest.approx(drift, abs=0.02)
        else:
            assert vehicle.drift is None
            assert vehicle.disturbance_covariance[0, 0] > 0.1**2


@pytest.mark.nightly
def test_certificates_hold_in_boats_whose_noise_was_identified_and_not_otherwise(
    hopeful: Plan,
) -> None:
    _, better = calibrated(hopeful, 40)
    lucky = rate_of(hopeful.scenario, flown(hopeful, boats, 150, 3))
    assert lucky.low > hopeful.risk.certified
    assert lucky.doubted == 150
    rate = rate_of(better.scenario, flown(better, boats, 150, 4))
    assert rate.rate <= better.risk.certified
    assert rate.doubted <= 15


def strays(vehicle: Vehicle, covariance: np.ndarray, drift: np.ndarray, count: int) -> np.ndarray:
    """Return deviations of a linear vehicle, (count, 9, n)."""
    rng = np.random.default_rng(5)
    F = vehicle.system.A + vehicle.system.B @ vehicle.gain
    off = [rng.multivariate_normal(np.zeros(4), vehicle.initial_covariance, count)]
    for _ in range(8):
        noise = rng.multivariate_normal(np.zeros(4), covariance, count)
        off.append(off[-1] @ F.T + drift + noise)
    return np.stack(off, axis=1)


@pytest.mark.sampled(1)
@pytest.mark.parametrize("factor", [1.0, 4.0])
def test_deviations_larger_than_the_noise_makes_them_are_measured_with_it(factor: float) -> None:
    vehicle = sea().vehicles[0]
    W, drift = vehicle.disturbance_covariance, np.array([0.1, 0.0, 0.02, 0.0])
    missions = strays(vehicle, factor * W, drift, 4000)
    made = [Strays(0, vehicle, (0, 1, 2, 3), missions)]
    assert deviation_ratio(made, W, drift) == pytest.approx(factor, rel=0.08)
    # What is taken for chance, and always the same way, looks like more of it.
    assert deviation_ratio(made, W, None) > 1.2 * factor


def test_few_flights_by_the_model_do_not_look_like_more_noise() -> None:
    vehicle = sea().vehicles[0]
    W, none = vehicle.disturbance_covariance, np.zeros(4)
    missions = strays(vehicle, W, none, 4000).reshape(400, 10, 9, 4)
    ratios = [deviation_ratio([Strays(0, vehicle, (0, 1, 2, 3), x)], W, None) for x in missions]
    assert 0.9 < np.mean(ratios) < 1.3


def test_white_noise_for_colored_leads_to_deviations_at_least_as_large() -> None:
    rng = np.random.default_rng(1)
    rows = rng.normal(size=(4000, 4)) * [0.2, 0.2, 0.1, 0.1]
    system = double_integrator(2.0, 2)
    for color in (0.0, 0.4, 0.8):
        none = Interval(*np.zeros((3, 4)))
        one: Any = SimpleNamespace(noise=[("east", 0, rows)], color=color, drift=none)
        white = white_covariance(one, None)
        vehicle = sea().vehicles[0]
        colored, plain = (
            Vehicle(
                name="east",
                system=system,
                radius=1.2,
                start=[0.0, 0.0],
                goal=vehicle.goal,
                control_limit=1.0,
                initial_covariance=0.0,
                disturbance_covariance=W,
                disturbance_correlation=rho,
                gain=vehicle.gain,
            ).covariances(30)
            for W, rho in ((np.cov(rows.T), color), (white, 0.0))
        )
        least = np.linalg.eigvalsh(plain[1:] - colored[1:])[:, 0]
        assert least.min() > -1e-4 * np.trace(plain[1])
    assert np.trace(plain[30]) < 10.0 * np.trace(colored[30])


def test_none_but_a_number_of_flights_is_flown(hopeful: Plan) -> None:
    with pytest.raises(ArgumentError, match=r"^missions must be an integer >= 1, got 0$"):
        calibrate(hopeful, boats, missions=0, day="2026-01-01")


@pytest.mark.parametrize("error", [KeyboardInterrupt, ArgumentError])
def test_what_a_plan_is_flown_with_is_closed_also_if_that_is_interrupted(
    hopeful: Plan, error: type[BaseException]
) -> None:
    class Vehicles(Model):
        closed = 0

        def advance(self, segments: Any) -> Any:
            raise error

        def close(self) -> None:
            self.closed += 1

    vehicles = Vehicles(hopeful.scenario, 0)
    with pytest.raises(error):
        flown(hopeful, lambda scenario, rng: vehicles, 2, 0)
    assert vehicles.closed == 1
