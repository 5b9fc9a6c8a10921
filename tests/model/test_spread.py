"""Covariances of vehicles with a memory, against sums written out over all that ever happened."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from radmpc.errors import ScenarioError
from radmpc.model.dynamics import LinearSystem, double_integrator
from radmpc.model.vehicle import Goal, Vehicle
from radmpc.program.condensed import PredictionMatrices, condense
from radmpc.program.relaxed.instants import Instants, Part

HORIZON = 6


def craft(seed: int, **more: object) -> Vehicle:
    """Return a vehicle with full covariances, a double integrator or not."""
    rng = np.random.default_rng(seed)
    system = double_integrator(0.7, 2)
    if seed % 3 == 2:
        system = LinearSystem(
            0.5 * rng.normal(size=(4, 4)), rng.normal(size=(4, 2)), (0, 1), (2, 3)
        )
    roots = 0.2 * rng.normal(size=(2, 4, 4))
    initial, disturbance = roots @ roots.transpose(0, 2, 1)
    return Vehicle(
        name="a",
        system=system,
        start=rng.normal(size=4),
        goal=Goal([-9.0, -9.0], [9.0, 9.0], None),
        radius=0.4,
        control_limit=5.0,
        initial_covariance=initial,
        disturbance_covariance=disturbance,
        gain=None if seed % 3 == 1 else -0.2 * rng.normal(size=(2, 4)),
        **more,  # type: ignore[arg-type]
    )


def history(vehicle: Vehicle) -> tuple[np.ndarray, list[np.ndarray]]:
    """Return the covariance of (δ_0, w_0, w_1, …), and each δ_k as a matrix over them."""
    n, rho = 4, vehicle.disturbance_correlation
    lags = np.abs(np.subtract.outer(np.arange(HORIZON + 1), np.arange(HORIZON + 1)))
    whole = np.zeros((n * (HORIZON + 2),) * 2)
    whole[:n, :n] = vehicle.initial_covariance
    whole[n:, n:] = np.kron(rho**lags, vehicle.disturbance_covariance)
    A = vehicle.system.A
    loop = A if vehicle.gain is None else A + vehicle.system.B @ vehicle.gain
    pick = np.eye(n * (HORIZON + 2)).reshape(HORIZON + 2, n, -1)
    noises = list(pick[1:])
    states = [pick[0]]
    for k in range(HORIZON):
        states.append(loop @ states[-1] + noises[k])
    return whole, states


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("rho", [0.3, 0.95])
def test_covariances_are_those_of_the_sum_over_all_disturbances(seed, rho):
    vehicle = craft(seed, disturbance_correlation=rho)
    whole, states = history(vehicle)
    expected = [state @ whole @ state.T for state in states]
    assert vehicle.covariances(HORIZON) == pytest.approx(np.array(expected), rel=1e-9, abs=1e-12)


@pytest.mark.parametrize("seed", range(6))
def test_without_correlation_they_are_what_they_always_were(seed):
    vehicle = craft(seed)
    close = replace(vehicle, disturbance_correlation=1e-12)
    assert not vehicle.has_memory
    assert close.covariances(HORIZON) == pytest.approx(vehicle.covariances(HORIZON), abs=1e-10)


@pytest.mark.parametrize("seed", range(6))
def test_positions_between_steps_spread_as_the_path_that_is_flown(seed):
    vehicle = craft(seed, disturbance_correlation=0.8)
    whole, states = history(vehicle)
    covariances = vehicle.covariances(HORIZON)
    prediction = PredictionMatrices.of(vehicle.system, HORIZON)
    bounds = np.ones((HORIZON, 2))
    model = condense(vehicle, prediction, vehicle.start, covariances, bounds)
    place = np.eye(4)[:2]
    bend = np.zeros((2, 4))
    if vehicle.gain is not None and vehicle.system.is_double_integrator:
        bend = vehicle.system.B[:2] @ vehicle.gain
    shares = (0.3, 1.0)
    part = Part(1.0, 0, 0, bounds, vehicle.system.sagitta)
    instants = Instants.of(model, part, shares)
    expected = []
    for k in range(HORIZON):
        for s in shares:
            path = (1 - s) * place @ states[k] - s * (1 - s) * bend @ states[k]
            path = path + s * place @ states[k + 1]
            expected.append(path @ whole @ path.T)
    assert instants.covariances == pytest.approx(np.array(expected), rel=1e-9, abs=1e-12)
    if model.bent_covariances is not None:
        turned = [(place - bend) @ state for state in states[:-1]]
        bent = np.array([t @ whole @ t.T for t in turned])
        assert model.bent_covariances == pytest.approx(bent, rel=1e-9, abs=1e-12)


@pytest.mark.parametrize("rho", [-0.1, 1.0, np.nan])
def test_no_stationary_disturbance_has_such_a_correlation(rho):
    with pytest.raises(ScenarioError, match=r"^disturbance.correlation: must be from 0 to below 1"):
        craft(0, disturbance_correlation=rho)
