"""Drift and noise as they are measured, against the second simulator, which knows each in loops."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from fleets import permuted, stepper
from physical_scenes import DI, KINDS, craft, pd, pushed, still, wall
from second_opinion import check_certificate, check_counts

from radmpc.model.dynamics import double_integrator, lqr_gain
from radmpc.model.noise.measurement import Measurement
from radmpc.model.obstacle import Obstacle
from radmpc.model.plan import Plan
from radmpc.model.vehicle import Vehicle

MISSIONS = 20_000


def against_a_current() -> Plan:
    """Carried to a wall, and held off it by the nominal control alone."""
    vehicle = replace(craft("a", DI, [-1.0, 0]), drift=[0.3, 0.05, 0.0, 0.0])
    push = np.tile([-0.02, 0.0], (5, 1))
    return pushed((vehicle,), [push], obstacles=(wall(0.3),))


def pair_in_a_wind() -> Plan:
    """Both are blown the same way, one of them with its states in another order."""
    system = permuted(1.0, 2, np.random.default_rng(3))
    gust = np.zeros(4)
    gust[list(system.position)] = [0.2, 0.1]
    a = replace(craft("a", DI, [0, 0], gain=pd(0.3, 0.9)), drift=[0.2, 0.1, 0.02, 0.0])
    b = replace(craft("b", system, [1.0, 0.1]), drift=gust)
    post = Obstacle.box("post", [2.1, 0.0], [2.3, 0.2])
    return still(a, b, obstacles=(post,), horizon=4)


def clipped_in_a_current() -> Plan:
    vehicle = craft("a", DI, [0, 0], gain=pd(1.0, 1.5), limit=0.15)
    return still(replace(vehicle, drift=[0.0, 0.1, 0.0, 0.0]), obstacles=(wall(0.3),))


def drifting_past_a_ferry() -> Plan:
    deck = np.array([[-1.0, -0.4], [1.0, -0.4], [1.0, 0.4], [-1.0, 0.4]])
    places = [np.add(deck, [2.6 - 0.5 * k, 1.04 - 0.04 * k]) for k in range(6)]
    vehicle = replace(craft("a", DI, [0, 0], gain=pd(1.0, 1.5)), drift=[0.1, 0.02, 0.01, 0.0])
    return still(vehicle, obstacles=(Obstacle.moving("ferry", places),), horizon=5)


def in_long_gusts() -> Plan:
    vehicle = craft("a", DI, [0, 0], gain=pd(0.3, 0.9), noise=0.05)
    return still(replace(vehicle, disturbance_correlation=0.8), obstacles=(wall(0.15),), horizon=6)


def pair_in_gusts_of_their_own() -> Plan:
    system = permuted(1.0, 2, np.random.default_rng(3))
    a = replace(craft("a", DI, [0, 0], gain=pd(1.0, 1.5)), disturbance_correlation=0.9)
    b = replace(craft("b", system, [1.4, 0.3], noise=0.05), disturbance_correlation=0.5)
    c = craft("c", DI, [0.1, -1.0], noise=0.05)
    return still(a, b, c, horizon=4)


def stepper_in_gusts() -> Plan:
    system = stepper(1.0, 2, np.random.default_rng(1))
    vehicle = craft("a", system, [0, 0], gain=-0.5 * np.linalg.inv(system.B))
    return still(replace(vehicle, disturbance_correlation=0.7), obstacles=(wall(0.35),))


def clipped_in_gusts() -> Plan:
    vehicle = craft("a", DI, [0, 0], gain=pd(1.0, 1.5), limit=0.15, noise=0.07)
    return still(replace(vehicle, disturbance_correlation=0.6), obstacles=(wall(0.3),))


def in_space_in_gusts() -> Plan:
    box = Obstacle.box("box", [0.4, 0.35, -5.0], [3.0, 3.0, 5.0])
    system = double_integrator(1.0, 3)
    a = craft("a", system, [0, 0, 0], gain=pd(1.0, 1.5, 3))
    b = craft("b", system, [-0.5, -0.45, -0.4], gain=pd(0.3, 0.9, 3))
    a, b = (replace(v, disturbance_correlation=0.7) for v in (a, b))
    return still(a, b, obstacles=(box,), horizon=4)


def sees(vehicle: Vehicle, sigma: float, states: tuple[int, ...] = (0, 1)) -> Vehicle:
    """A vehicle that measures some of its states with a standard deviation."""
    sensor = Measurement.of(states, vehicle.system.num_states, sigma**2)
    return replace(vehicle, measurement=sensor)


def poor_receiver() -> Plan:
    return still(sees(craft("a", DI, [0, 0], gain=pd(0.3, 0.9)), 0.3), obstacles=(wall(0.7),))


def quick_on_poor_estimates() -> Plan:
    return still(sees(craft("a", DI, [0, 0], gain=pd(1.0, 1.5)), 0.2), obstacles=(wall(0.4),))


def exact_positions() -> Plan:
    return still(sees(craft("a", DI, [0, 0], gain=pd(1.0, 1.5)), 0.0), obstacles=(wall(0.25),))


def mixed_sensor() -> Plan:
    system = permuted(1.0, 2, np.random.default_rng(3))
    rows = np.random.default_rng(7).normal(size=(3, 4))
    gain = lqr_gain(system, np.eye(4), np.eye(2))
    vehicle = replace(
        craft("a", system, [0, 0], gain=gain),
        measurement=Measurement(rows, [0.02, 0.04, 0.1]),
        disturbance_correlation=0.7,
        drift=[0.02, 0.0, 0.01, 0.02],
    )
    push = np.random.default_rng(0).normal(0.0, 0.05, (6, 2))
    return pushed((vehicle,), [push], obstacles=(wall(0.55),))


def clipped_on_estimates() -> Plan:
    vehicle = sees(craft("a", DI, [0, 0], gain=pd(1.0, 1.5), limit=0.15), 0.1)
    return still(vehicle, obstacles=(wall(0.35),))


def pair_of_which_one_measures() -> Plan:
    a = sees(craft("a", DI, [0, 0], gain=pd(1.0, 1.5)), 0.15)
    b = craft("b", stepper(1.0, 2, np.random.default_rng(2)), [0.95, 0.1])
    c = sees(craft("c", DI, [-0.2, 1.1], noise=0.05), 0.3)
    return still(a, b, c, horizon=3)


def measuring_in_space() -> Plan:
    box = Obstacle.box("box", [0.45, 0.4, -5.0], [3.0, 3.0, 5.0])
    system = double_integrator(1.0, 3)
    a = sees(craft("a", system, [0, 0, 0], gain=pd(1.0, 1.5, 3)), 0.1, (0, 1, 2))
    b = sees(craft("b", system, [-0.6, -0.5, -0.4], gain=pd(0.3, 0.9, 3)), 0.2, (0, 1, 2, 5))
    return still(a, b, obstacles=(box,), horizon=4)


DRIFTING = [against_a_current, pair_in_a_wind, clipped_in_a_current, drifting_past_a_ferry]
GUSTY = [
    in_long_gusts,
    pair_in_gusts_of_their_own,
    stepper_in_gusts,
    clipped_in_gusts,
    in_space_in_gusts,
]
MEASURING = [
    poor_receiver,
    quick_on_poor_estimates,
    exact_positions,
    mixed_sensor,
    clipped_on_estimates,
    pair_of_which_one_measures,
    measuring_in_space,
]
SCENES = [*DRIFTING, *GUSTY, *MEASURING]
FALSE_ALARM = 1e-4 / (len(SCENES) * len(KINDS))


@pytest.mark.slow
@pytest.mark.sampled(2)
@pytest.mark.parametrize("scene", SCENES, ids=lambda scene: scene.__name__)
def test_simulation_counts_what_the_second_simulator_counts(scene):
    check_counts(scene(), MISSIONS, FALSE_ALARM)


@pytest.mark.slow
@pytest.mark.sampled(2)
@pytest.mark.parametrize("scene", SCENES, ids=lambda scene: scene.__name__)
def test_the_certificate_is_just_above_the_second_simulator(scene):
    check_certificate(scene(), MISSIONS)
