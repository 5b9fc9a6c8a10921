"""The hull in the plane against Qhull's, on what is random and on what is degenerate."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial import ConvexHull

from radmpc.facets import facets
from radmpc.geometry import Polytope, convex_pieces, hull
from radmpc.outline import outline


def turned(points: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """Points turned by any angle and moved, some of them far."""
    angle = rng.uniform(0.0, 2.0 * np.pi)
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    return points @ turn.T + rng.uniform(-1.0, 1.0, 2) * 10.0 ** rng.integers(-1, 5)


def scattered(rng: np.random.Generator) -> np.ndarray:
    return turned(rng.normal(size=(rng.integers(3, 40), 2)) * 10.0 ** rng.integers(-3, 4, 2), rng)


def on_a_grid(rng: np.random.Generator) -> np.ndarray:
    """Many are doubled, many lie on one line."""
    return rng.integers(0, rng.integers(2, 7), (rng.integers(3, 30), 2)).astype(float)


def beside_the_edges(rng: np.random.Generator) -> np.ndarray:
    """A turned rectangle with points on its sides, up to rounding."""
    corners = np.array([[0, 0], [2, 0], [2, 1], [0, 1]]) * rng.uniform(0.5, 9.0, 2)
    shares = rng.uniform(size=(rng.integers(1, 30), 1))
    sides = rng.integers(4, size=len(shares))
    along = corners[sides] + shares * (corners[(sides + 1) % 4] - corners[sides])
    return turned(rng.permutation(np.concatenate([corners, along])), rng)


def on_a_circle(rng: np.random.Generator) -> np.ndarray:
    angles = rng.uniform(0.0, 2.0 * np.pi, rng.integers(3, 60))
    return turned(np.column_stack([np.cos(angles), np.sin(angles)]), rng)


def in_heaps(rng: np.random.Generator) -> np.ndarray:
    """Corners in heaps of points a rounding apart."""
    corners = rng.normal(size=(rng.integers(3, 8), 2))
    heaps = np.repeat(corners, 5, axis=0)
    return turned(heaps * (1.0 + rng.integers(-2, 3, heaps.shape) * 2.0**-52), rng)


def slender(rng: np.random.Generator) -> np.ndarray:
    """A strip a millionth as wide as it is long and less."""
    points = rng.uniform(size=(rng.integers(4, 20), 2))
    return turned(points * [1.0, 10.0 ** -rng.uniform(3.0, 6.0)], rng)


SHAPES = [scattered, on_a_grid, beside_the_edges, on_a_circle, in_heaps, slender]


def spans_the_plane(points: np.ndarray) -> bool:
    return facets(points).dimension == 2


@pytest.mark.slow
@pytest.mark.sampled(1)
@pytest.mark.parametrize("shape", SHAPES)
def test_the_outline_reaches_as_far_as_that_of_qhull(shape) -> None:
    rng = np.random.default_rng(5)
    directions = rng.normal(size=(50, 2))
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    num_compared = 0
    for _ in range(700):
        points = shape(rng)
        if not spans_the_plane(points):
            continue
        num_compared += 1
        ours, theirs = outline(points), ConvexHull(points).vertices
        rounding = 1e-14 * np.abs(points).max()
        reach = (directions @ points.T).max(axis=1)
        assert np.all((directions @ points[ours].T).max(axis=1) >= reach - rounding)
        assert np.all((directions @ points[theirs].T).max(axis=1) >= reach - rounding)
        # Counter-clockwise, and a corner at each.
        before, after = points[np.roll(ours, 1)], points[np.roll(ours, -1)]
        (x, y), (u, v) = (points[ours] - before).T, (after - points[ours]).T
        assert np.all(x * v - y * u > 0.0)
    assert num_compared > 600


@pytest.mark.sampled(2)
@pytest.mark.parametrize("shape", [scattered, on_a_grid, beside_the_edges, on_a_circle])
def test_the_outline_has_the_corners_of_qhull(shape) -> None:
    rng = np.random.default_rng(6)
    num_compared = 0
    for _ in range(700):
        points = shape(rng)
        if spans_the_plane(points):
            num_compared += 1
            ours = {tuple(corner) for corner in points[outline(points)].tolist()}
            theirs = {tuple(corner) for corner in points[ConvexHull(points).vertices].tolist()}
            assert ours == theirs
    assert num_compared > 600


@pytest.mark.sampled(3)
@pytest.mark.parametrize("shape", SHAPES)
def test_faces_hold_all_points_and_touch_them(shape) -> None:
    rng = np.random.default_rng(7)
    num_planar = 0
    for _ in range(300):
        points = shape(rng)
        found = facets(points)
        slack = found.offsets - (found.normals @ points.T).max(axis=1)
        np.testing.assert_allclose(slack, 0.0, atol=1e-12 * np.abs(points).max())
        np.testing.assert_allclose(np.linalg.norm(found.normals, axis=1), 1.0, atol=1e-12)
        if found.dimension == 2:
            num_planar += 1
            # Each side's own ends are on its face, up to rounding.
            assert len(found.edges) == len(found.corners) >= len(found.normals) >= 3
    assert num_planar > 200


def test_a_polygon_with_axis_parallel_sides_has_exact_faces() -> None:
    square = hull([[0.1, 0.3], [0.7, 0.3], [0.7, 1.1], [0.1, 1.1], [0.4, 0.3]])
    assert square.normals.tolist() == [[0, -1], [1, 0], [0, 1], [-1, 0]]
    assert square.offsets.tolist() == [-0.3, 0.7, 1.1, -0.1]
    assert not np.signbit(square.normals[square.normals == 0.0]).any()


@pytest.mark.parametrize("size", [1e-200, 1e-9, 1.0, 1e9, 1e100])
def test_an_outline_may_have_any_size(size: float) -> None:
    square = np.array([[0, 0], [2, 0], [1, 1], [2, 2], [0, 2]]) * size
    assert outline(square).tolist() == [0, 1, 3, 4]


def test_a_side_with_a_corner_that_rounding_made_at_its_far_left_has_none() -> None:
    points = np.array([[0, 0], [4, 0], [4, 4], [0, 4], [-2e-17, 2]])
    assert sorted(outline(points).tolist()) == [0, 1, 2, 3]


@pytest.mark.parametrize("step", [1, -1])
@pytest.mark.parametrize("first", [0, 1, 3])
def test_a_convex_polygon_is_one_piece_whichever_way_its_corners_are_told(
    step: int, first: int
) -> None:
    corners = np.array([[0, 0], [4, 0], [5, 2], [3, 4], [1, 3]])
    (piece,) = convex_pieces(np.roll(corners, first, axis=0)[::step])
    assert sorted(piece.vertices.tolist()) == sorted(corners.tolist())


def test_corners_of_a_convex_polygon_in_another_order_cross_themselves() -> None:
    pentagram = np.array([[0, 0], [5, 2], [1, 3], [4, 0], [3, 4]])
    with pytest.raises(ValueError, match="simple polygon"):
        convex_pieces(pentagram)


def test_a_corner_on_a_straight_side_leaves_one_piece() -> None:
    pieces: tuple[Polytope, ...] = convex_pieces([[0, 0], [2, 0], [4, 0], [4, 4], [0, 4]])
    assert [len(piece.normals) for piece in pieces] == [4]
