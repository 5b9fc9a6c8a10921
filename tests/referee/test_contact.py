"""Segment distances against brute force and against shapely."""

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import minimize_scalar, nnls

from radmpc.geometry import box, hull
from radmpc.referee.contact import Solid, origin_distances, solid_distances, solid_of
from radmpc.referee.simulation.sweep import swept
from sampling import examples

SEEDS = st.integers(0, 2**32 - 1)
QUICK = settings(max_examples=examples(40), deadline=None, derandomize=True)


def test_a_box_in_space_has_twelve_edges():
    solid = solid_of(box([0, 0, 0], [1, 2, 3]))
    assert solid.edges.shape == (12, 2, 3)
    lengths = np.linalg.norm(solid.edges[:, 1] - solid.edges[:, 0], axis=1)
    assert sorted(lengths) == [1] * 4 + [2] * 4 + [3] * 4


def test_a_polygon_has_as_many_sides_as_corners():
    angles = np.arange(7) * 2 * np.pi / 7
    solid = solid_of(hull(np.column_stack([np.cos(angles), np.sin(angles)])))
    assert solid.edges.shape == (7, 2, 2)


@pytest.mark.parametrize(
    ("begin", "end", "distance"),
    [
        ([-1, 0.5], [-1, 0.5], 1.0),  # a point beside a side
        ([-3, -4], [-3, -4], 5.0),  # a point off a corner
        ([0.5, 0.5], [0.5, 0.5], 0.0),  # a point inside
        ([-1, 0.5], [2, 0.5], 0.0),  # straight through
        ([-1, -1], [2, -1], 1.0),  # past a side
        ([-1, 1], [1, 3], np.sqrt(0.5) * 1.0),  # past a corner
        ([0.2, 0.2], [5, 5], 0.0),  # from inside to outside
    ],
)
def test_distances_from_the_unit_square(begin, end, distance):
    solid = solid_of(box([0, 0], [1, 1]))
    found = solid_distances(np.array([begin], float), np.array([end], float), solid)
    assert found[0] == pytest.approx(distance, abs=1e-12)


@QUICK
@given(SEEDS)
def test_planar_distances_are_those_of_shapely(seed):
    rng = np.random.default_rng(seed)
    shape = hull(rng.uniform(-1, 1, (6, 2)))
    begin, end = rng.uniform(-3, 3, (2, 30, 2))
    end[:5] = begin[:5]
    found = solid_distances(begin, end, solid_of(shape))
    polygon = shapely.Polygon(shape.vertices)
    lines = shapely.linestrings(np.stack([begin, end], axis=1))
    lines[:5] = shapely.points(begin[:5])
    np.testing.assert_allclose(found, shapely.distance(lines, polygon), atol=1e-9)


def point_distance(point, shape):
    """Distance from the hull of corners by non-negative least squares."""
    corners = shape.vertices - point
    rows = np.vstack([corners.T, np.full(len(corners), 1e4)])
    _, residual = nnls(rows, np.append(np.zeros(3), 1e4))
    return residual


@settings(max_examples=examples(15), deadline=None, derandomize=True)
@given(SEEDS)
def test_distances_in_space_are_the_least_over_the_segment(seed):
    rng = np.random.default_rng(seed)
    shape = hull(rng.uniform(-1, 1, (7, 3)))
    begin, end = rng.uniform(-2.5, 2.5, (2, 6, 3))
    found = solid_distances(begin, end, solid_of(shape))
    for b, e, distance in zip(begin, end, found, strict=True):
        # The distance from a convex set is convex along a line.
        best = minimize_scalar(
            lambda t, b=b, e=e: point_distance(b + t * (e - b), shape),
            bounds=(0.0, 1.0),
            method="bounded",
            options={"xatol": 1e-9},
        )
        assert distance == pytest.approx(best.fun, abs=2e-4)


def test_origin_distances_clip_to_the_segment():
    begin = np.array([[1.0, -1.0], [1.0, 1.0], [3.0, 4.0]])
    end = np.array([[1.0, 1.0], [2.0, 2.0], [3.0, 4.0]])
    np.testing.assert_allclose(origin_distances(begin, end), [1.0, np.sqrt(2.0), 5.0])


def test_a_shift_is_swept_exactly():
    square = box([0, 0], [1, 1])
    moved = box([3, 1], [4, 2])
    (part,) = swept(square, moved)
    assert isinstance(part.solid, Solid)
    np.testing.assert_allclose(part.drift, [3.0, 1.0])
