"""Half-spaces for starts and goals that the faces alone call contact."""

from __future__ import annotations

import numpy as np
import pytest

from radmpc.gaussian import tail_probability
from radmpc.model.dynamics import double_integrator
from radmpc.model.scenario import Scenario
from radmpc.model.vehicle import Goal, Vehicle
from radmpc.program.openings import best_clearance, clearances, opening_directions
from radmpc.program.start import start_pair_risk

AXES = np.concatenate([np.eye(2), -np.eye(2)])
ORIGIN = np.zeros((1, 2))


@pytest.mark.parametrize("seed", range(10))
def test_no_direction_clears_a_corner_by_more_than_the_best(seed):
    rng = np.random.default_rng(seed)
    mean = rng.uniform(0.5, 2.0, 2)
    root = rng.normal(size=(2, 2)) * 10 ** rng.uniform(-2, 0)
    corners = np.array([[-1.0, -1.0], [0.2, -1.0], [0.2, 0.1], [-1.0, 0.1]])
    angles = np.linspace(0.0, 2.0 * np.pi, 20_001)
    every = np.column_stack([np.cos(angles), np.sin(angles)])
    covariance = root @ root.T
    found, direction = best_clearance(mean, covariance, AXES, corners, 0.3)
    most = clearances(mean, covariance, every, corners, 0.3).max()
    assert np.linalg.norm(direction) == pytest.approx(1.0)
    if most > 0.0:
        assert found >= most - 1e-6 * (1.0 + abs(most))


def test_a_pair_apart_along_a_diagonal_gets_that_direction_and_no_other():
    place = np.array([0.45, 0.45])
    noise = 1e-6 * np.eye(2)
    [direction] = opening_directions(((place, place, noise),), AXES, (ORIGIN,), 0.6)
    assert direction == pytest.approx(np.full(2, np.sqrt(0.5)))


def test_a_place_that_a_face_sees_apart_needs_no_direction():
    place, noise = np.array([0.7, 0.0]), 1e-6 * np.eye(2)
    assert len(opening_directions(((place, place, noise),), AXES, (ORIGIN,), 0.6)) == 0


def test_a_place_in_contact_by_every_direction_gets_none():
    place, noise = np.array([0.3, 0.3]), 1e-6 * np.eye(2)
    assert len(opening_directions(((place, place, noise),), AXES, (ORIGIN,), 0.6)) == 0


def test_touching_without_noise_is_no_contact():
    place = 0.6 * np.full(2, np.sqrt(0.5))
    for mean in (place, place * (1.0 - 5e-10)):
        found, _ = best_clearance(mean, np.zeros((2, 2)), AXES, ORIGIN, 0.6)
        assert tail_probability(found) == 0.0
    found, _ = best_clearance(0.99 * place, np.zeros((2, 2)), AXES, ORIGIN, 0.6)
    assert tail_probability(found) == 1.0


def test_starts_apart_along_a_diagonal_are_charged_next_to_nothing():
    fleet = [
        Vehicle(
            name=name,
            system=double_integrator(1.0, 2),
            start=np.full(2, place),
            goal=Goal.at((9 * place, 9)),
            radius=0.3,
            control_limit=9.0,
            initial_covariance=1e-6,
            disturbance_covariance=1e-6,
        )
        for name, place in (("a", 0.0), ("b", 0.45))
    ]
    problem = Scenario("diagonal", 1.0, 4, 0.02, tuple(fleet))
    noise = [v.covariances(problem.horizon) for v in problem.vehicles]
    assert start_pair_risk(problem, noise) < 1e-6
