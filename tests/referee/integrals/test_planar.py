"""The exact integral against closed forms and against itself from other directions."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import quad
from scipy.special import log_ndtr, ndtr
from scipy.stats import ncx2

from radmpc.geometry import hull
from radmpc.referee.bound.planar import grown_polygon_risks
from sampling import examples


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


@settings(max_examples=examples(40), deadline=None, derandomize=True)
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
    # Far aside of the direction digits are lost, to the safe side.
    if min(found) > 1e-8:
        np.testing.assert_allclose(found, min(found), rtol=1e-6)


@settings(max_examples=examples(15), deadline=None, derandomize=True)
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


def test_a_singular_covariance_is_left_to_the_half_space():
    assert risk([2.0, 0.0], np.diag([0.1, 0.0]), [[0, 0]], 0.8, [1.0, 0.0], 0.25) == 0.25


def chord_ends(x, corners, radius):
    """Return where the grown polygon begins and ends above each x."""
    low, high = np.full(x.shape, np.inf), np.full(x.shape, -np.inf)
    for corner, following in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        square = (radius - x + corner[0]) * (radius + x - corner[0])
        half = np.sqrt(np.maximum(square, 0.0))
        low = np.where(square >= 0.0, np.minimum(low, corner[1] - half), low)
        high = np.where(square >= 0.0, np.maximum(high, corner[1] + half), high)
        along = following - corner
        outward = np.array([along[1], -along[0]]) / max(np.hypot(*along), 1e-300)
        begin, end = corner + radius * outward, following + radius * outward
        if begin[0] != end[0]:
            share = (x - begin[0]) / (end[0] - begin[0])
            y = begin[1] + share * (end[1] - begin[1])
            above = (share >= 0.0) & (share <= 1.0)
            low = np.where(above, np.minimum(low, y), low)
            high = np.where(above, np.maximum(high, y), high)
    return low, high


def by_columns(mean, variances, corners, radius):
    """Integrate column by column over independent axes, on grids that halve toward every mark.

    Marks are where the outline changes its kind and the largest column, which is the only local
    one: columns of a convex set are log-concave.
    """
    corners = corners - mean
    sigmas = np.sqrt(variances)
    following = np.roll(corners, -1, axis=0)
    along = following - corners
    length = np.maximum(np.hypot(along[:, 0], along[:, 1]), 1e-300)
    moved = radius * along[:, 1] / length
    low, high = corners[:, 0].min() - radius, corners[:, 0].max() + radius

    def columns(x):
        begin, end = (each / sigmas[1] for each in chord_ends(x, corners, radius))
        missed = begin >= end
        begin, end = np.where(missed, 0.0, begin), np.where(missed, 0.0, end)
        flip = begin + end < 0.0
        return np.where(flip, -end, begin), np.where(flip, -begin, end), missed

    def heights(x):
        begin, end, missed = columns(x)
        mass = np.where(missed, 0.0, ndtr(-begin) - ndtr(-end))
        return mass * np.exp(-0.5 * np.square(x / sigmas[0])) / np.sqrt(2.0 * np.pi) / sigmas[0]

    def logarithms(x):
        begin, end, missed = columns(x)
        share = np.exp(np.minimum(log_ndtr(-end) - log_ndtr(-begin), -1e-300))
        mass = log_ndtr(-begin) + np.log1p(-np.minimum(share, 1.0 - 1e-16))
        return np.where(missed, -np.inf, mass - 0.5 * np.square(x / sigmas[0]))

    span, peak = (low, high), 0.0
    for _ in range(25):
        grid = np.linspace(*span, 41)
        best = int(logarithms(grid).argmax())
        peak, span = grid[best], (grid[max(best - 1, 0)], grid[min(best + 1, 40)])
    tips = [corners[:, 0] - radius, corners[:, 0] + radius]
    marks = np.concatenate([*tips, corners[:, 0] + moved, following[:, 0] + moved, [peak]])
    marks = np.unique(np.clip(marks, low, high))
    shares = np.concatenate([[0.0], 2.0 ** np.arange(-45.0, 0.0)])
    grids = [
        np.concatenate([a + (b - a) * shares, b - (b - a) * shares]) for a, b in pairwise(marks)
    ]
    cells = np.unique(np.concatenate(grids))
    cells = np.unique(np.concatenate([cells[:-1] + np.diff(cells) * k / 4 for k in range(4)]))
    nodes, weights = np.polynomial.legendre.leggauss(12)
    widths = 0.5 * np.diff(cells)[:, None]
    return (heights(cells[:-1, None] + widths * (1.0 + nodes)) * widths * weights).sum()


def scene(rng):
    """Return a mean beside or inside a disc, a wedge, a thin plate or a hull, and the way out."""
    kind = rng.integers(4)
    turn = rng.uniform(0.0, 2.0 * np.pi)
    rotation = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
    length, thin = rng.uniform(0.5, 10.0), 10.0 ** rng.uniform(-5.0, -1.0)
    corners = [
        np.zeros((1, 2)),
        np.array([[0.0, 0.0], [-10.0 * thin, -length], [10.0 * thin, -length]]) @ rotation.T,
        np.array([[-length, -thin], [length, -thin], [length, thin], [-length, thin]]) @ rotation.T,
        hull(rng.uniform(-1.0, 1.0, (7, 2))).vertices,
    ][kind]
    radius = 10.0 ** rng.uniform(-3.0, 0.3)
    sigma = 10.0 ** rng.uniform(-2.0, 0.5) * np.array([1.0, 10.0 ** rng.uniform(-7.0, 0.0)])
    variances = np.square(sigma if rng.random() < 0.5 else sigma[::-1])
    angle = rng.uniform(0.0, 2.0 * np.pi)
    normal = np.array([np.cos(angle), np.sin(angle)])
    place = corners[(corners @ normal).argmax()] + radius * normal
    spread = variances * normal
    mean = place + spread / np.sqrt(spread @ normal) * rng.uniform(-1.0, 7.5)
    return mean, variances, corners, radius, normal


@pytest.mark.slow
@settings(max_examples=examples(100), deadline=None, derandomize=True)
@given(st.integers(0, 2**32 - 1))
def test_the_risk_is_never_below_the_truth_at_any_ratio_of_deviations(seed):
    mean, variances, corners, radius, normal = scene(np.random.default_rng(seed))
    expected = by_columns(mean, variances, corners, radius)
    swapped = by_columns(mean[::-1], variances[::-1], corners[::-1, ::-1], radius)
    # Columns one way and the other show what rounding does to the quadrature.
    doubt = 2.0 * abs(expected - swapped) + 1e-11 * expected
    found = risk(mean, np.diag(variances), corners, radius, normal)
    assert expected - doubt <= found <= expected * (1.0 + 1e-3) + doubt


def test_a_peak_far_narrower_than_the_set_is_not_stepped_over():
    wedge = np.array([[-0.002, 0.0], [-20.0, -20.0], [20.0, -20.0], [0.002, 0.0]])
    variances, mean = np.array([1.0, 1.6e-9]), np.array([0.0, 0.10012])
    expected = by_columns(mean, variances, wedge, 0.1)
    assert expected > 1e-6
    assert risk(mean, np.diag(variances), wedge, 0.1, [0.0, 1.0], 1.0) >= expected * (1.0 - 1e-9)


@settings(max_examples=examples(30), deadline=None, derandomize=True)
@given(st.integers(0, 2**32 - 1))
def test_a_wrong_direction_costs_tightness_only(seed):
    rng = np.random.default_rng(seed)
    mean, variances, corners, radius, normal = scene(rng)
    angle = rng.uniform(0.0, 2.0 * np.pi)
    right = risk(mean, np.diag(variances), corners, radius, normal)
    wrong = risk(mean, np.diag(variances), corners, radius, [np.cos(angle), np.sin(angle)])
    # Both are bounds; the first is known to be this tight.
    assert wrong >= right / (1.0 + 1e-3)


def test_a_turned_flat_covariance_keeps_its_smaller_deviation():
    # Deviations of 1 and 1e-6 on a diagonal: a long wall is passed at 4 of the smaller ones.
    covariance = np.array([[0.5 + 5e-13, 0.5 - 5e-13], [0.5 - 5e-13, 0.5 + 5e-13]])
    small = (covariance[0, 0] - covariance[0, 1]) * 1.0
    normal = np.array([1.0, -1.0]) / np.sqrt(2.0)
    along = np.array([1.0, 1.0]) / np.sqrt(2.0)
    wall = np.array([a * along - b * normal for a, b in [(-9, 0), (9, 0), (9, 1), (-9, 1)]])
    mean = (0.1 + 4.0 * np.sqrt(small)) * normal
    found = risk(mean, covariance, wall, 0.1, normal)
    assert found == pytest.approx(ndtr(-4.0), rel=1e-4)
    assert found >= ndtr(-4.0) * (1.0 - 1e-9)


def test_corners_on_a_side_and_all_but_repeated_do_not_matter():
    box = np.array([[1.0, 0.5], [2.0, 0.5], [2.0, 3.0], [1.0, 3.0]])
    more = np.concatenate([box, [[1.0, 1.0], [1.0, 0.5 + 1e-16], [1.0 + 1e-15, 3.0], [1.5, 0.5]]])
    arguments = ([0, 0], np.diag([0.16, 0.49]))
    plain = risk(*arguments, box, 0.3, [-1.0, 0.0], 1.0)
    assert risk(*arguments, more, 0.3, [-1.0, 0.0], 1.0) == pytest.approx(plain, rel=1e-6)


def test_the_half_space_is_kept_where_it_is_smaller():
    found = risk([2.0, 0.0], np.eye(2), [[0, 0]], 0.8, [1.0, 0.0], 1e-9)
    assert found == 1e-9
