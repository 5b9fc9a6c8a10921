"""The exact integral against closed forms and against itself from other directions."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import quad
from scipy.special import ndtr
from scipy.stats import ncx2

from radmpc.geometry import hull
from radmpc.referee.planar import grown_polygon_risks


def risk(mean, covariance, vertices, radius, normal, bound=np.inf):
    return grown_polygon_risks(
        np.atleast_2d(np.asarray(mean, dtype=float)),
        np.asarray(covariance, dtype=float)[None],
        np.asarray(vertices, dtype=float)[None],
        np.array([float(radius)]),
        np.atleast_2d(np.asarray(normal, dtype=float)),
        np.array([float(bound)]),
    )[0]


@pytest.mark.parametrize("distance", [0.0, 0.3, 1.0, 2.0, 3.0, 3.8])
@pytest.mark.parametrize("sigma", [0.3, 0.5, 3.0])
def test_a_disc_is_the_noncentral_chi_square(distance, sigma):
    expected = ncx2.cdf(0.8**2 / sigma**2, 2, distance**2 / sigma**2)
    # scipy's tail is good to seven digits only where the value is not tiny.
    found = risk([distance, 0.0], sigma**2 * np.eye(2), [[0.0, 0.0]], 0.8, [1.0, 0.0], 1.0)
    if expected > 1e-10:
        assert found == pytest.approx(expected, rel=1e-6)
    else:
        assert found == pytest.approx(expected, rel=1e-3)


def disc_by_quadrature(mean, deviations, radius):
    """Integrate over the first axis, where both axes are independent."""

    def column(x):
        half = np.sqrt(max(radius**2 - x**2, 0.0))
        low, high = (-half - mean[1]) / deviations[1], (half - mean[1]) / deviations[1]
        if low + high > 0.0:
            low, high = -high, -low
        z = (x - mean[0]) / deviations[0]
        return (ndtr(high) - ndtr(low)) * np.exp(-0.5 * z**2) / np.sqrt(2 * np.pi) / deviations[0]

    edges = np.linspace(-radius, radius, 41)
    pieces = [quad(column, a, b, epsabs=0.0, epsrel=1e-12)[0] for a, b in pairwise(edges)]
    return sum(pieces)


@pytest.mark.parametrize("mean", [(2.5, 0.0), (0.0, 2.5), (2.0, 1.0), (3.5, 1.0), (0.1, 0.2)])
@pytest.mark.parametrize("deviations", [(0.4, 0.2), (0.2, 0.4), (2.0, 0.3)])
def test_a_disc_under_an_anisotropic_covariance_is_exact_far_into_the_tail(mean, deviations):
    expected = disc_by_quadrature(mean, deviations, 0.8)
    variances = np.diag(np.square(deviations))
    whitened = np.linalg.solve(variances, mean)
    found = risk(mean, variances, [[0, 0]], 0.8, whitened / np.linalg.norm(whitened), 1.0)
    if expected > 1e-15:
        assert expected * (1 - 1e-9) <= found <= expected * (1 + 1e-6)
    else:
        assert found <= 1e-14


def test_a_long_wall_is_two_tails():
    wall = [[1.0, -200.0], [2.0, -200.0], [2.0, 200.0], [1.0, 200.0]]
    covariance = np.array([[0.09, 0.02], [0.02, 0.2]])
    expected = ndtr(-(1.0 - 0.4) / 0.3) - ndtr(-(2.4) / 0.3)
    found = risk([0.0, 0.0], covariance, wall, 0.4, [-1.0, 0.0], 1.0)
    assert found == pytest.approx(expected, rel=1e-6)


def test_a_bare_box_is_a_product_of_tails():
    box = [[1.0, 0.5], [2.0, 0.5], [2.0, 3.0], [1.0, 3.0]]
    expected = (ndtr(2 / 0.4) - ndtr(1 / 0.4)) * (ndtr(3 / 0.7) - ndtr(0.5 / 0.7))
    found = risk([0, 0], np.diag([0.16, 0.49]), box, 1e-9, [-0.8, -0.6], 1.0)
    assert found == pytest.approx(expected, rel=1e-6)


def test_the_order_of_corners_and_their_repetition_do_not_matter():
    box = np.array([[1.0, 0.5], [2.0, 0.5], [2.0, 3.0], [1.0, 3.0]])
    arguments = ([0, 0], np.diag([0.16, 0.49]))
    sorted_risk = risk(*arguments, box, 0.3, [-1.0, 0.0], 1.0)
    mixed = box[[2, 0, 3, 1, 0, 0]]
    assert risk(*arguments, mixed, 0.3, [-1.0, 0.0], 1.0) == pytest.approx(sorted_risk, rel=1e-6)


@settings(max_examples=40, deadline=None, derandomize=True)
@given(st.integers(0, 2**32 - 1))
def test_the_direction_of_integration_does_not_matter(seed):
    rng = np.random.default_rng(seed)
    cloud = rng.uniform(-1.0, 1.0, (7, 2)) + rng.uniform(-2.0, 2.0, 2)
    root = 0.5 * rng.standard_normal((2, 2)) + 0.2 * np.eye(2)
    shape = hull(cloud).vertices
    radius = rng.uniform(0.01, 0.8)
    found = []
    for angle in rng.uniform(0.0, 2.0 * np.pi, 4):
        normal = [np.cos(angle), np.sin(angle)]
        found.append(risk([0.0, 0.0], root @ root.T, shape, radius, normal, 1.0))
    # A set wholly more than 8.5 deviations aside of a direction is not found from there.
    if min(found) > 1e-12:
        np.testing.assert_allclose(found, min(found), rtol=1e-6)


@settings(max_examples=15, deadline=None, derandomize=True)
@given(st.integers(0, 2**32 - 1))
def test_sampling_agrees(seed):
    rng = np.random.default_rng(seed)
    shape = hull(rng.uniform(-1.0, 1.0, (6, 2)) + rng.uniform(-1.0, 1.0, 2))
    root = 0.6 * rng.standard_normal((2, 2)) + 0.3 * np.eye(2)
    found = risk([0.0, 0.0], root @ root.T, shape.vertices, 0.3, [1.0, 0.0], 1.0)
    points = rng.standard_normal((20_000, 2)) @ root.T
    heights = points @ shape.normals.T - shape.offsets
    inside = (heights <= 0.0).all(axis=1)
    following = np.roll(shape.vertices, -1, axis=0)
    along = following - shape.vertices
    gaps = points[:, None] - shape.vertices
    t = np.clip((gaps * along).sum(axis=2) / np.square(along).sum(axis=1), 0.0, 1.0)
    distance = np.linalg.norm(gaps - t[:, :, None] * along, axis=2).min(axis=1)
    share = (inside | (distance < 0.3)).mean()
    assert abs(share - found) < 6.0 * np.sqrt(max(found * (1 - found), 1e-4) / 20_000)


def test_a_flat_covariance_is_left_to_the_half_space():
    assert risk([2.0, 0.0], np.diag([0.1, 0.0]), [[0, 0]], 0.8, [1.0, 0.0], 0.25) == 0.25


def test_the_half_space_is_kept_where_it_is_smaller():
    found = risk([2.0, 0.0], np.eye(2), [[0, 0]], 0.8, [1.0, 0.0], 1e-9)
    assert found == 1e-9
