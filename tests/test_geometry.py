"""Convex sets as half-spaces and vertices: both say the same set."""

from __future__ import annotations

import numpy as np
import pytest

from radmpc.errors import ScenarioError
from radmpc.geometry import box, convex_pieces, halfspaces, hull, planar, sphere_directions


@pytest.mark.parametrize("dimension", [1, 2, 3])
def test_a_box_and_the_hull_of_its_corners_reach_equally_far_everywhere(dimension: int) -> None:
    solid = box(np.zeros(dimension), np.arange(1.0, dimension + 1.0))
    directions = np.random.default_rng(0).normal(size=(20, dimension))
    assert len(solid.vertices) == 2**dimension
    assert hull(solid.vertices).support(directions) == pytest.approx(solid.support(directions))


def test_every_vertex_of_a_hull_lies_on_faces_and_no_point_lies_outside() -> None:
    points = np.random.default_rng(1).normal(size=(40, 3))
    solid = hull(points)
    assert np.linalg.norm(solid.normals, axis=1) == pytest.approx(1.0)
    assert np.all(points @ solid.normals.T <= solid.offsets + 1e-9)
    on_face = np.abs(solid.vertices @ solid.normals.T - solid.offsets) < 1e-9
    assert np.all(on_face.sum(axis=1) >= 3)


def test_corners_in_the_plane_go_round_counter_clockwise() -> None:
    corners = hull([[0, 0], [2, 0], [1, 0.2], [2, 2], [0, 2]]).vertices
    assert len(corners) == 4
    x, y = corners.T
    assert 0.5 * (x @ np.roll(y, -1) - y @ np.roll(x, -1)) == pytest.approx(4.0)


def test_halfspaces_of_any_length_describe_the_same_set() -> None:
    triangle = halfspaces([[-2.0, 0.0], [0.0, -0.5], [3.0, 3.0]], [0.0, 0.0, 3.0])
    assert sorted(triangle.vertices.tolist()) == [[0.0, 0.0], [0.0, 1.0], [1.0, 0.0]]
    assert triangle.offsets == pytest.approx([0.0, 0.0, np.sqrt(0.5)])


@pytest.mark.parametrize(
    ("normals", "offsets", "message"),
    [
        ([[1, 0], [0, 1]], [1, 1], "bounded set"),
        # Flat strips, which go on for ever.
        ([[1, 0], [-1, 0]], [5, -5], "bounded set"),
        ([[1, 0], [-1, 0], [0, 1]], [5, -5, 9], "bounded set"),
        ([[1, 0], [-1, 0], [0, 1], [0, -1]], [0, -1, 1, 1], "empty set"),
        ([[1, 0], [-1, 0], [0, 1], [0, -1]], [1, -3, 9, -7], "empty set"),
        ([[0, 0], [1, 0]], [1, 1], "different from zero"),
        ([[1, 0], [0, 0], [0, 1]], [5, -5, 9], "different from zero"),
    ],
)
def test_halfspaces_without_a_bounded_set_are_refused(
    normals: list[list[float]], offsets: list[float], message: str
) -> None:
    with pytest.raises(ScenarioError, match=message):
        halfspaces(normals, offsets)


def test_a_flat_set_of_halfspaces_is_its_segment() -> None:
    # x = 0.5 both ways, y in [0, 2].
    segment = halfspaces([[1, 0], [-1, 0], [0, 1], [0, -1]], [0.5, -0.5, 2.0, 0.0])
    assert np.sort(segment.vertices, axis=0) == pytest.approx(np.array([[0.5, 0.0], [0.5, 2.0]]))
    assert planar(segment).length == pytest.approx(2.0)


def test_pieces_of_a_hooked_polygon_are_convex_and_cover_it_exactly() -> None:
    hook = [[0, 0], [3, 0], [3, 1], [1, 1], [1, 3], [0, 3]]
    pieces = convex_pieces(hook)
    assert len(pieces) == 2
    assert sum(planar(piece).area for piece in pieces) == pytest.approx(5.0)
    assert planar(pieces[0]).intersection(planar(pieces[1])).area == pytest.approx(0.0)
    assert len(convex_pieces([[0, 0], [1, 0], [1, 1], [0, 1]])) == 1


def test_an_outline_that_crosses_itself_is_refused() -> None:
    with pytest.raises(ScenarioError, match="simple polygon"):
        convex_pieces([[0, 0], [2, 2], [2, 0], [0, 3]])


@pytest.mark.parametrize(("count", "dimension"), [(4, 2), (7, 2), (6, 3), (20, 3)])
def test_directions_are_unit_vectors_that_leave_no_half_of_the_sphere_out(
    count: int, dimension: int
) -> None:
    directions = sphere_directions(count, dimension)
    assert directions.shape == (count, dimension)
    assert np.linalg.norm(directions, axis=1) == pytest.approx(1.0)
    anywhere = np.random.default_rng(2).normal(size=(200, dimension))
    assert np.all((anywhere @ directions.T).max(axis=1) > 0.0)


def test_an_inverted_box_is_refused_with_its_corners() -> None:
    with pytest.raises(ScenarioError, match=r"min must not be above max .* \[2\.0, 0\.0\]"):
        box([2.0, 0.0], [1.0, 1.0])
