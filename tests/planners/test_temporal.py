"""Temporal obstacles bound plans; couplings are what the graph says."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from scipy.optimize import brentq
from scipy.stats import norm

from radmpc.geometry import hull
from radmpc.model.dynamics import double_integrator, rollout
from radmpc.model.vehicle import Goal, Vehicle
from radmpc.planners.paper.coupling import connected_sets, face_risk
from radmpc.planners.paper.temporal import make_temporal_obstacle, standing_obstacle
from sampling import examples


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
@settings(max_examples=examples(40), deadline=None)
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


@pytest.mark.parametrize("dimension", [2, 3])
@settings(max_examples=examples(40), deadline=None)
@given(seed=st.integers(0, 10**6))
def test_along_intervals_a_temporal_obstacle_touches_every_square_along_the_curve(dimension, seed):
    rng = np.random.default_rng(seed)
    vehicle = _vehicle(dimension)
    controls = rng.normal(size=(4, dimension)) * rng.choice([0.0, 0.5, 4.0], (4, 1))
    start = rng.normal(size=2 * dimension)
    means, noise = rollout(vehicle.system, start, controls), vehicle.covariances(4)
    obstacle = make_temporal_obstacle(vehicle, means, noise, 2, intervals=True, controls=controls)
    half = 3.0 * np.sqrt(noise[:, 0, 0]) + 0.5
    share = np.linspace(0.0, 1.0, 1001)[:, None]
    for i in range(4):
        # Constant acceleration, from its start on.
        place, speed = means[i, :dimension], means[i, dimension:]
        path = place + share * speed + 0.5 * share**2 * controls[i]
        sides = (1.0 - share) * half[i] + share * half[i + 1]
        normals, offsets = obstacle.at(2 + i)
        reach = path @ normals.T + sides * np.abs(normals).sum(axis=1)
        assert reach.max(axis=0) == pytest.approx(offsets, abs=1e-5)


def test_a_way_across_a_goal_counts_along_intervals():
    vehicle = _vehicle(2)
    means = np.array([[90.0, 90.0, 0.0, 0.0], [91.0, 90.0, 0.0, 0.0]])
    noise = vehicle.covariances(1)
    around = make_temporal_obstacle(vehicle, means, noise, 1, intervals=True).at(1)
    ahead = int(np.argmax(around[0] @ np.array([1.0, 0.0])))
    assert around[1][ahead] == pytest.approx(91.0 + 3.0 * np.sqrt(noise[1, 0, 0]) + 0.5)


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
    risk = face_risk(faces, 0.5, [(np.array([2.0, 1.8]), np.diag([0.04, 0.01]))])
    assert risk == pytest.approx(norm.sf(3.0))  # (1.8 − 1.5)/0.1 beats (2 − 1.5)/0.2
    assert face_risk(faces, 0.5, [(np.array([2.0, 0.0]), np.zeros((2, 2)))]) == 0.0
    assert face_risk(faces, 0.5, [(np.zeros(2), np.zeros((2, 2)))]) == 1.0
    # Programs and referee let it touch by rounding.
    touching = np.array([1.5 - 1e-12, 0.0])
    assert face_risk(faces, 0.5, [(touching, np.zeros((2, 2)))]) == 0.0


def test_along_an_interval_one_face_is_held_from_end_to_end():
    normals = np.array([[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]])
    faces, noise = (normals, np.ones(4)), 0.01 * np.eye(2)
    east, north = np.array([2.0, 0.0]), np.array([0.0, 2.0])
    assert face_risk(faces, 0.5, [(east, noise)]) == pytest.approx(norm.sf(5.0))
    # Around the corner each end is clear of a face, and no face is clear of both.
    assert face_risk(faces, 0.5, [(east, noise)], (north, noise)) == pytest.approx(norm.sf(-15.0))
    wide = 0.04 * np.eye(2)
    for ends in (([(east, wide)], (east, noise)), ([(east, noise), (east, wide)], (east, noise))):
        assert face_risk(faces, 0.5, *ends) == pytest.approx(norm.sf(2.5))


@settings(max_examples=examples(40), deadline=None)
@given(seed=st.integers(0, 10**6))
@example(seed=34266)
def test_the_curve_toward_a_face_is_charged_as_the_best_share_of_the_reserve_leaves_it(seed):
    rng = np.random.default_rng(seed)
    faces = (np.array([[1.0, 0.0]]), np.zeros(1))
    margins, deviations = rng.uniform(0.0, 1.0, 2), rng.uniform(0.05, 0.2, 2)
    places = [(np.array([margins[e], 7.0]), deviations[e] ** 2 * np.eye(2)) for e in (0, 1)]
    height = rng.uniform(0.0, 1.0)

    def clearances(share):
        kept = 4.0 * height * np.array([share**2, (1.0 - share) ** 2])
        return (margins - kept) / deviations

    # More of the reserve for one end leaves the other less: the best share leaves both the same.
    shares = [0.0, 1.0]
    excess = [float(np.subtract(*clearances(share))) for share in shares]
    if excess[0] > 0.0 > excess[1]:
        shares.append(brentq(lambda share: float(np.subtract(*clearances(share))), 0.0, 1.0))
    best = max(clearances(share).min() for share in shares)
    for sagitta in (np.array([height, 3.0]), np.array([height, -3.0])):
        risk = face_risk(faces, 0.0, places[:1], places[1], sagitta)
        assert risk == pytest.approx(norm.sf(best), rel=1e-6)
    away = face_risk(faces, 0.0, places[:1], places[1], np.array([-height, 3.0]))
    assert away == pytest.approx(norm.sf((margins / deviations).min()), rel=1e-6)


def test_sets_are_the_connected_components_either_way_round():
    risk = np.zeros((5, 5))
    risk[3, 1] = 2e-6
    risk[0, 4] = 1e-6
    assert connected_sets(risk, 1e-6) == ((0,), (1, 3), (2,), (4,))
    assert connected_sets(risk, 1e-6, [(2, 1)]) == ((0,), (1, 2, 3), (4,))
