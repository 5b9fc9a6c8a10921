"""Obstacles without inner points: walls, plates, wires and posts."""

from __future__ import annotations

import numpy as np
import pytest

from radmpc.facets import facets, surface
from radmpc.geometry import Polytope, box, halfspaces, hull, planar
from radmpc.model.obstacle import Obstacle

WALL = [[4.0, -1.0], [6.0, 2.0]]
PLATE = [[4.0, 0.0, 0.0], [4.0, 3.0, 0.0], [4.0, 3.0, 2.0], [4.0, 0.0, 2.0], [4.0, 1.0, 1.0]]


def assert_tight(piece: Polytope, points: object) -> None:
    """Faces hold the points, touch them, and stand on both sides where the set is flat."""
    cloud = np.array(points, dtype=float)
    np.testing.assert_allclose(np.linalg.norm(piece.normals, axis=1), 1.0, atol=1e-12)
    np.testing.assert_allclose(piece.offsets, piece.support(piece.normals), atol=1e-9)
    np.testing.assert_allclose(piece.offsets, (piece.normals @ cloud.T).max(axis=1), atol=1e-9)
    # What is bounded has normals whose cone is everything.
    directions = np.random.default_rng(3).normal(size=(200, piece.dimension))
    assert np.all((directions @ piece.normals.T).max(axis=1) > 0.0)


@pytest.mark.parametrize(
    ("points", "faces", "corners"),
    [
        (WALL, 4, 2),
        ([[1.0, 2.0]], 4, 1),
        ([[0.0, 0.0], [0.1, 0.3], [0.2, 0.6], [1.0, 3.0]], 4, 2),
        ([[5.0, 5.0], [5.0, 5.0]], 4, 1),
        (PLATE, 6, 4),
        ([[0.0, 0.0, 0.0], [1.0, 2.0, 3.0]], 6, 2),
        ([[1.0, 2.0, 3.0]], 6, 1),
    ],
)
def test_a_flat_hull_has_faces_both_ways_and_at_its_ends(
    points: list[list[float]], faces: int, corners: int
) -> None:
    piece = hull(points)
    assert (len(piece.normals), len(piece.vertices)) == (faces, corners)
    assert_tight(piece, points)


def test_a_wall_far_away_and_askew_is_still_flat() -> None:
    along = np.array([0.6, 0.8]) * np.linspace(0.0, 3.0, 7)[:, None]
    piece = hull(along + np.array([1e5, -3e5]))
    assert len(piece.vertices) == 2


@pytest.mark.parametrize(
    ("low", "high", "corners"),
    [
        ([5, -1], [5, 2], 2),
        ([5, 2], [5, 2], 1),
        ([5, 0, 0], [5, 1, 2], 4),
        ([1, 0, 0], [1, 0, 2], 2),
    ],
)
def test_a_flat_box_is_a_wall_a_plate_a_wire_or_a_post(
    low: list[int], high: list[int], corners: int
) -> None:
    piece = box(low, high)
    assert len(piece.vertices) == corners
    assert_tight(piece, [low, high])


@pytest.mark.parametrize(
    ("normals", "offsets", "corners"),
    [
        ([[1, 0], [-1, 0], [0, 1], [0, -1]], [5, -5, 2, 1], [[5, -1], [5, 2]]),
        ([[1, 1], [-1, -1], [1, 0], [-1, 0]], [1, -1, 1, 0], [[0, 1], [1, 0]]),
        ([[1, 0], [-1, 1], [-1, -1]], [0, 0, 0], [[0, 0]]),
        # Rounded: 0.1 + 0.2 and 0.3.
        ([[1, 0], [-1, 0], [0, 1], [0, -1]], [0.1 + 0.2, -0.3, 1, 0], [[0.3, 0], [0.3, 1]]),
        (
            [[-1, 0, 0], [1, 0, 0], [0, -1, 0], [0, 1, 0], [0, 0, -1], [0, 0, 1]],
            [12, -8, -2, 2, 0, 5.8],
            [[-12, 2, 0], [-12, 2, 5.8], [-8, 2, 0], [-8, 2, 5.8]],
        ),
    ],
)
def test_half_spaces_may_leave_no_inner_point(
    normals: list[list[float]], offsets: list[float], corners: list[list[float]]
) -> None:
    piece = halfspaces(normals, offsets)
    np.testing.assert_allclose(sorted(piece.vertices.tolist()), corners, atol=1e-9)
    assert_tight(piece, corners)


def test_a_line_is_one_piece_per_straight_part() -> None:
    fence = Obstacle.line("fence", [[0, 0], [4, 0], [4, 0], [4, 3]])
    lengths = [planar(piece).length for piece in fence.at(0)]
    assert lengths == [4.0, 3.0]


def test_a_line_that_goes_nowhere_is_a_post() -> None:
    (piece,) = Obstacle.line("post", [[2, 1], [2, 1]]).at(0)
    assert planar(piece).equals(planar(hull([[2, 1]])))


def test_a_plate_has_its_own_edges_and_one_sheet_of_triangles() -> None:
    plate = np.array(PLATE)
    assert len(facets(plate).edges) == 4
    a, b, c = surface(plate).transpose(1, 0, 2)
    assert 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() == pytest.approx(6.0)
    assert not len(surface(plate[:2]))


def test_a_box_has_no_edges_across_its_faces() -> None:
    assert len(facets(box([0, 0, 0], [1, 2, 3]).vertices).edges) == 12
