"""Temporal obstacles bound plans; couplings are what the graph says."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.stats import norm

from radmpc.geometry import hull
from radmpc.model.dynamics import double_integrator
from radmpc.model.vehicle import Goal, Vehicle
from radmpc.planners.coupling import connected_sets, face_risk
from radmpc.planners.temporal import make_temporal_obstacle, standing_obstacle


def _vehicle(dimension):
    return Vehicle(
        name="a",
        system=double_integrator(1.0, dimension),
        start=np.zeros(2 * dimension),
        goal=Goal(np.full(dimension, 90.0), np.full(dimension, 91.0), np.full(dimension, 0.1)),
        radius=0.5,
        control_limit=np.full(dimension, 2.0),
        initial_covariance=0.01,
        disturbance_covariance=0.02,
    )


@pytest.mark.parametrize("dimension", [2, 3])
@settings(max_examples=40, deadline=None)
@given(seed=st.integers(0, 10**6))
def test_a_temporal_obstacle_is_the_hull_of_the_squares_at_both_ends(dimension, seed):
    rng = np.random.default_rng(seed)
    vehicle = _vehicle(dimension)
    means = rng.normal(size=(5, 2 * dimension)) * rng.choice([0.0, 0.1, 3.0], (5, 1))
    noise = vehicle.covariances(4)
    obstacle = make_temporal_obstacle(vehicle, means, noise, 2)
    half = 3.0 * np.sqrt(noise[:, 0, 0]) + 0.5
    signs = np.array(np.meshgrid(*[[-1, 1]] * dimension)).reshape(dimension, -1).T
    for i in range(4):
        corners = np.concatenate([means[j, :dimension] + half[j] * signs for j in (i, i + 1)])
        normals, offsets = obstacle.at(2 + i)
        assert np.linalg.norm(normals, axis=1) == pytest.approx(1.0)
        assert np.all(corners @ normals.T <= offsets + 1e-9)
        truth = hull(corners)
        directions = rng.normal(size=(30, dimension))
        probes = corners.mean(axis=0) + directions * rng.uniform(0.1, 3.0, (30, 1))
        inside = np.max(probes @ truth.normals.T - truth.offsets, axis=1)
        ours = np.max(probes @ normals.T - offsets, axis=1)
        clear = np.abs(inside) > 1e-6
        assert np.array_equal(ours[clear] > 0, inside[clear] > 0)


def test_at_the_start_at_the_horizon_and_in_the_goal_it_is_the_square_alone():
    vehicle = _vehicle(2)
    means = np.array([[0, 0, 0, 0], [4, 1, 0, 0], [90.5, 90.5, 0, 0], [90.6, 90.6, 0, 0]], float)
    obstacle = make_temporal_obstacle(vehicle, means, vehicle.covariances(3), 0)
    for step in (0, 2, 3):
        normals, offsets = obstacle.at(step)
        assert len(normals) == 4
        extent = offsets[:2] + offsets[2:]
        assert extent[0] == pytest.approx(extent[1])
    assert len(obstacle.at(1)[0]) == 6


def test_a_vehicle_without_a_plan_stands_at_its_start():
    vehicle = _vehicle(2)
    obstacle = standing_obstacle(vehicle, vehicle.covariances(3))
    _, offsets = obstacle.at(3)
    assert offsets == pytest.approx(3.0 * 0.1 + 0.5)


def test_the_risk_of_the_active_face_is_the_least_of_all_faces():
    normals = np.array([[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]])
    faces = (normals, np.array([1.0, 1.0, 1.0, 1.0]))
    risk = face_risk(faces, 0.5, np.array([2.0, 1.8]), np.diag([0.04, 0.01]))
    assert risk == pytest.approx(norm.sf(3.0))  # (1.8 − 1.5)/0.1 beats (2 − 1.5)/0.2
    assert face_risk(faces, 0.5, np.array([2.0, 0.0]), np.zeros((2, 2))) == 0.0
    assert face_risk(faces, 0.5, np.zeros(2), np.zeros((2, 2))) == 1.0


def test_sets_are_the_connected_components_either_way_round():
    risk = np.zeros((5, 5))
    risk[3, 1] = 2e-6
    risk[0, 4] = 1e-6
    assert connected_sets(risk, 1e-6) == ((0,), (1, 3), (2,), (4,))
    assert connected_sets(risk, 1e-6, [(2, 1)]) == ((0,), (1, 2, 3), (4,))
