"""What a fleet makes of one wind that lasts: alarms, evidence, and what it cannot do."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from adversary import SIGMA
from noisy_scenes import STEPS, blown, estimated_as_another_sees, estimated_in_a_new_wind_and_unsure
from test_flown_noise import waiting

import radmpc
from radmpc.flying.mission import Mission
from radmpc.flying.model import Model
from radmpc.flying.nature import Estimator
from radmpc.flying.sensing.alarms import Watcher
from radmpc.model.goal import Goal
from radmpc.model.plan import Plan
from radmpc.model.scenario import Scenario


def many(correlation: float) -> Scenario:
    """Eight far from each other, in a wind that shakes them more than all else."""
    [vehicle] = blown().vehicles
    wind = replace(vehicle.shared[0], correlation=correlation)
    vehicle = replace(vehicle, shared=(wind,))
    fleet = []
    for i in range(8):
        place = [900.0 * (i % 2), 200.0 * (i + 1)]
        goal = Goal.at(place, 1e3, None)
        quiet = 0.01 * SIGMA**2
        one = replace(vehicle, name=f"v{i}", start=place, goal=goal, disturbance_covariance=quiet)
        fleet.append(replace(one, initial_covariance=quiet))
    return replace(blown(), vehicles=tuple(fleet), horizon=8)


def counted(correlation: float, missions: int = 20) -> tuple[float, float]:
    """Return mean and deviation of the squares that are summed over a mission, as of χ² they are.

    Both are 1 where nothing is counted twice.
    """
    scenario = many(correlation)
    plan, sums = waiting(scenario), []
    for seed in range(missions):
        mission = Mission(plan, planner=None)
        radmpc.fly(mission, Model(scenario, seed))
        sums.append(sum(total for total, _, _ in mission._sensing.watcher.squares))
        components = sum(count for _, count, _ in mission._sensing.watcher.squares)
    return float(np.mean(sums) / components), float(np.std(sums) / np.sqrt(2.0 * components))


@pytest.mark.slow
@pytest.mark.parametrize("correlation", [0.9, 0.0])
def test_what_moves_all_of_them_counts_once_as_a_sign_against_the_model(correlation):
    mean, deviation = counted(correlation)
    assert 0.95 < mean < 1.05
    assert 0.6 < deviation < 1.5


@pytest.mark.slow
def test_counted_for_each_it_would_be_an_alarm_time_and_again(monkeypatch):
    right = Watcher.look
    monkeypatch.setattr(Watcher, "look", lambda *given: right(*given[:-1]))
    _, deviation = counted(0.9)
    assert deviation > 1.7


@pytest.mark.slow
def test_measurements_of_all_tell_the_factor_of_covariances_up_to_chance():
    """What is summed for it has the law that it is taken to have."""
    scenario = replace(estimated_in_a_new_wind_and_unsure(), covariance_samples=3)
    ratios = []
    for seed in range(60):
        mission, model = Mission(waiting(scenario), planner=None), Model(scenario, seed)
        radmpc.fly(mission, model)
        scale = mission._sensing.evidence.scale
        assert scale.samples == 3 + 6 * (STEPS + 1)
        # Σ of squared deviations, in deviations as drawn, is χ² of so many directions.
        squares = scale.samples * float(scale.factor) - 3.0
        ratios.append(squares / model._nature._larger**2 / (6 * (STEPS + 1)))
    error = np.sqrt(2.0 / (6 * (STEPS + 1)) / 60)
    assert abs(np.mean(ratios) - 1.0) < 4.0 * error
    assert 0.5 < np.std(ratios) / np.sqrt(2.0 / (6 * (STEPS + 1))) < 2.0


def steered() -> Scenario:
    """Three in one wind that steer after where they believe they are; two of them estimate that."""
    scenario = estimated_as_another_sees()
    gain = np.array([[-0.6, 0.1], [0.0, -0.5]])
    vehicles = tuple(replace(v, gain=gain) for v in scenario.vehicles)
    return replace(scenario, vehicles=vehicles, horizon=5)


def once(scenario: Scenario, seconds: float | None = None) -> Plan | None:
    """Return another plan at the second step, and never again."""
    del seconds
    return waiting(scenario, 1.0) if scenario.horizon == 4 else None


def textbook(leg: Plan, number: int, told: list[np.ndarray], flown: list[np.ndarray]) -> np.ndarray:
    """Return what a Kalman filter that begins with a leg makes of what a vehicle measures."""
    vehicle = leg.scenario.vehicles[number]
    [part], n, rho = vehicle.shared, 2, vehicle.disturbance_correlation
    F = np.eye(6)
    F[:n, n : 2 * n], F[:n, 2 * n :] = np.eye(n), part.matrix
    F[n : 2 * n, n : 2 * n], F[2 * n :, 2 * n :] = rho * np.eye(n), part.correlation * np.eye(n)
    Q = np.zeros((6, 6))
    Q[n : 2 * n, n : 2 * n] = (1.0 - rho**2) * vehicle.disturbance_covariance
    Q[2 * n :, 2 * n :] = (1.0 - part.correlation**2) * part.covariance
    P = vehicle.belief.common @ vehicle.belief.common.T
    P[: 2 * n, : 2 * n] += vehicle.belief.covariance
    C, R = np.eye(2, 6), vehicle.measurement.covariance
    hat = np.concatenate([vehicle.start, vehicle.belief.disturbance, vehicle.belief.lasting])
    for y, control in zip(told, flown, strict=True):
        hat, P = F @ hat, F @ P @ F.T + Q
        hat[:n] += control
        L = P @ C.T @ np.linalg.inv(C @ P @ C.T + R)
        hat, P = hat + L @ (y - C @ hat), P - L @ C @ P
    return hat[:n]


def test_feedback_of_a_leg_acts_on_a_filter_that_begins_with_what_all_know(monkeypatch):
    told: dict[str, list[np.ndarray]] = {}
    right = Estimator.measured

    def measured(self, found):
        told.setdefault(self.vehicle.name, []).append(found)
        return right(self, found)

    monkeypatch.setattr(Estimator, "measured", measured)
    scenario = steered()
    mission = Mission(waiting(scenario), planner=once, share=1.0)
    flight = radmpc.fly(mission, Model(scenario, 4))
    assert [tick.choice for tick in flight.ticks] == ["tail", "candidate", *["tail"] * 4]
    leg = mission.leg
    for i in (0, 2):
        vehicle = leg.plan.scenario.vehicles[i]
        for step in range(1, 5):
            flown = [tick.controls[i] for tick in flight.ticks[1:step]]
            hat = textbook(leg.plan, i, told[vehicle.name][2 : step + 1], flown)
            k = step - 1
            nominal = leg.plan.trajectories[i]
            due = nominal.controls[k] + vehicle.gain @ (hat - nominal.means[k])
            np.testing.assert_allclose(flight.ticks[step].controls[i], due, atol=1e-9)
            # That is not what the vehicle believes by its own filter.
            own = nominal.controls[k] + vehicle.gain @ (flight.states[step][i] - nominal.means[k])
            assert i or np.abs(own - due).max() > 1e-4
