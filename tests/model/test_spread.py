"""Covariances of vehicles with a memory, against sums written out over all that ever happened."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from radmpc.errors import ArgumentError, ScenarioError
from radmpc.model.dynamics import LinearSystem, double_integrator
from radmpc.model.noise import kept
from radmpc.model.noise.measurement import Measurement
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
        **more,
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


def seen(vehicle: Vehicle) -> tuple[np.ndarray, list[np.ndarray], list[np.ndarray]]:
    """Return a covariance of all that ever happened, each δ_k, and each δ̂_k, as matrices over it.

    An estimate is the conditional mean of the state, given all that was measured: by conditioning
    on the whole past at once, as no filter does.
    """
    n, sensor = 4, vehicle.measurement
    assert sensor is not None
    p = len(sensor.matrix)
    past, states = history(replace(vehicle, measurement=None, gain=None))
    size = len(past)
    whole = np.zeros((size + p * (HORIZON + 1),) * 2)
    whole[:size, :size] = past
    whole[size:, size:] = np.kron(np.eye(HORIZON + 1), sensor.covariance)
    # What would have happened without feedback, and what would have been measured then: feedback
    # is known to the vehicle, and changes neither what is new nor what is learned of it.
    free = [np.hstack([x, np.zeros((n, p * (HORIZON + 1)))]) for x in states]
    noises = np.eye(len(whole))[size:].reshape(HORIZON + 1, p, -1)
    measured = [sensor.matrix @ x + v for x, v in zip(free, noises, strict=True)]
    learned = []
    for k in range(HORIZON + 1):
        y = np.vstack(measured[: k + 1])
        learned.append(free[k] @ whole @ y.T @ np.linalg.inv(y @ whole @ y.T) @ y)
    A, K = vehicle.system.A, vehicle.gain
    push = np.zeros((n, n)) if K is None else vehicle.system.B @ K
    moved = np.zeros((n, len(whole)))
    flown, thought = [], []
    for k in range(HORIZON + 1):
        flown.append(free[k] + moved)
        thought.append(learned[k] + moved)
        moved = A @ moved + push @ thought[k]
    return whole, flown, thought


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("rho", [0.0, 0.8])
def test_who_measures_strays_as_the_best_guess_from_all_measurements_says(seed, rho):
    rng = np.random.default_rng(seed)
    sensor = Measurement(rng.normal(size=(1 + seed % 2, 4)), 0.1)
    vehicle = craft(seed, disturbance_correlation=rho, measurement=sensor)
    whole, flown, thought = seen(vehicle)
    spread = vehicle.spread(HORIZON)
    for states, found in ((flown, spread.states), (thought, spread.estimates)):
        expected = np.array([x @ whole @ x.T for x in states])
        assert found == pytest.approx(expected, rel=1e-7, abs=1e-10)
    assert np.array_equal(vehicle.covariances(HORIZON), spread.states)
    bounds = vehicle.control_bounds(vehicle.covariances(HORIZON))
    if vehicle.gain is None:
        assert np.all(bounds == 5.0)
    else:
        asked = [vehicle.gain @ x @ whole @ x.T @ vehicle.gain.T for x in thought[:-1]]
        expected = [5.0 - 3.0 * np.sqrt(np.diag(one)) for one in asked]
        assert bounds == pytest.approx(np.array(expected), rel=1e-7)


@pytest.mark.parametrize("seed", range(6))
def test_positions_between_steps_bend_by_what_the_vehicle_thinks(seed):
    rng = np.random.default_rng(seed)
    sensor = Measurement(rng.normal(size=(2, 4)), 0.1)
    vehicle = craft(seed, disturbance_correlation=0.6, measurement=sensor)
    whole, flown, thought = seen(vehicle)
    prediction = PredictionMatrices.of(vehicle.system, HORIZON)
    covariances, bounds = vehicle.covariances(HORIZON), np.ones((HORIZON, 2))
    place, bend = np.eye(4)[:2], np.zeros((2, 4))
    if vehicle.gain is not None and vehicle.system.is_double_integrator:
        bend = vehicle.system.B[:2] @ vehicle.gain
    for first in (0, 2):
        model = condense(
            vehicle, prediction, vehicle.start, covariances[first:], bounds[first:], first
        )
        if model.bent_covariances is not None:
            turned = [
                place @ x - bend @ z
                for x, z in zip(flown[first:-1], thought[first:-1], strict=True)
            ]
            bent = np.array([t @ whole @ t.T for t in turned])
            assert model.bent_covariances == pytest.approx(bent, rel=1e-7, abs=1e-10)
    model = condense(vehicle, prediction, vehicle.start, covariances, bounds)
    instants = Instants.of(model, Part(1.0, 0, 0, bounds, vehicle.system.sagitta), (0.4,))
    expected = []
    for k in range(HORIZON):
        path = 0.6 * place @ flown[k] - 0.24 * bend @ thought[k] + 0.4 * place @ flown[k + 1]
        expected.append(path @ whole @ path.T)
    assert instants.covariances == pytest.approx(np.array(expected), rel=1e-7, abs=1e-10)


@pytest.mark.parametrize("seed", [0, 3])
def test_who_measures_everything_exactly_knows_everything(seed):
    exact = craft(seed, measurement=Measurement(np.eye(4), 0.0))
    known = craft(seed)
    covariances = known.covariances(HORIZON)
    assert exact.covariances(HORIZON) == pytest.approx(covariances, rel=1e-7, abs=1e-10)
    assert exact.control_bounds(covariances) == pytest.approx(known.control_bounds(covariances))
    blind = craft(seed, measurement=Measurement(np.eye(4), 1e9))
    open_loop = replace(known, gain=None).covariances(HORIZON)
    assert blind.covariances(HORIZON) == pytest.approx(open_loop, rel=1e-5)


def test_wrong_sensors_are_refused():
    with pytest.raises(ScenarioError, match=r"^measurement.matrix: must have 4 columns like the"):
        craft(0, measurement=Measurement(np.eye(2), 0.1))
    with pytest.raises(ScenarioError, match=r"^of: must be distinct state indices from 0 to 3, "):
        Measurement.of([0, 4], 4, 0.1)
    with pytest.raises(ScenarioError, match=r"^of: must be distinct state indices from 0 to 3, "):
        Measurement.of([1, 1], 4, 0.1)
    with pytest.raises(ScenarioError, match=r"^covariance: must be positive semi-definite"):
        Measurement.of([0, 1], 4, -0.1)
    with pytest.raises(ScenarioError, match=r"^measurement: must be a Measurement, got \[0, 1\]"):
        craft(0, measurement=[0, 1])


def test_covariances_are_propagated_once_for_a_vehicle_and_anew_for_another(monkeypatch):
    asked = []
    propagate = kept.spread_of
    monkeypatch.setattr(kept, "spread_of", lambda *given: asked.append(1) or propagate(*given))
    one = craft(0, disturbance_correlation=0.5, measurement=Measurement.of([0, 1], 4, 0.01))
    states = one.covariances(HORIZON)
    one.control_bounds(states)
    assert not one.spread(HORIZON).known.flags.writeable
    assert len(asked) == 1
    louder = replace(one, disturbance_covariance=4.0 * one.disturbance_covariance)
    assert np.all(
        np.trace(louder.covariances(HORIZON)[1:], axis1=1, axis2=2)
        > np.trace(states[1:], axis1=1, axis2=2)
    )
    one.covariances(HORIZON + 1)
    assert len(asked) == 3


@pytest.mark.parametrize("rho", [0.0, 0.5])
@pytest.mark.parametrize(
    ("horizon", "message"),
    [
        (-1, r"^horizon must be an integer >= 0, got -1$"),
        (1.5, r"^horizon must be an integer >= 0, got 1\.5$"),
        (2.0, r"^horizon must be an integer >= 0, got 2\.0: write 2$"),
        (True, r"^horizon must be an integer >= 0, got True$"),
        ("3", r"^horizon must be an integer >= 0, got '3'$"),
        ([3], r"^horizon must be an integer >= 0, got \[3\]$"),
        (None, r"^horizon must be an integer >= 0, got None$"),
        (10**9, r"^horizon: must be at most 1000000 steps, got 1000000000$"),
    ],
)
def test_a_horizon_that_is_none_is_refused_in_one_line(
    rho: float, horizon: object, message: str
) -> None:
    vehicle = craft(0, disturbance_correlation=rho)
    for ahead in (vehicle.spread, vehicle.covariances):
        with pytest.raises((ArgumentError, ScenarioError), match=message):
            ahead(horizon)


def test_nothing_ahead_leaves_what_is_known_at_the_start() -> None:
    vehicle = craft(0, disturbance_correlation=0.5)
    assert vehicle.spread(np.int64(0)).states == pytest.approx(vehicle.initial_covariance[None])
