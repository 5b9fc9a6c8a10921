from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
import shapely

from radmpc.geometry import Polytope, box, hull
from radmpc.geometry.between import nearest_points, outlines_of_equal_length
from radmpc.geometry.openings import Barriers, Opening

LOW, HIGH = np.zeros(2), np.array([10.0, 10.0])


def opening(pieces: list[Polytope], *, radius: float = 10.0, walled: bool = True) -> Opening | None:
    """The widest opening from (2, 5) to around (8, 5)."""
    barriers = Barriers.of(pieces, (LOW, HIGH) if walled else None, radius)
    assert barriers is not None
    return barriers.opening(np.array([2.0, 5.0]), (np.array([7.9, 4.9]), np.array([8.1, 5.1])))


def ring(gap: float = 0.0) -> list[Polytope]:
    """Walls without thickness around (8, 5), perhaps with a gap in the north."""
    corners = [(7.0 + gap, 6.0), (9.0, 6.0), (9.0, 4.0), (7.0, 4.0), (7.0, 6.0)]
    return [hull(np.array(pair)) for pair in pairwise(corners)]


def test_a_room_without_a_gap_has_no_opening() -> None:
    found = opening(ring())
    assert found is not None
    assert found.radius == 0.0
    assert set(found.around) == {0, 1, 2, 3}


@pytest.mark.parametrize("gap", [1e-6, 0.01, 0.3, 1.7])
def test_a_gap_is_as_wide_as_it_is(gap: float) -> None:
    found = opening(ring(gap))
    assert found is not None
    assert found.radius == pytest.approx(0.5 * gap, rel=1e-6)
    assert found.position == pytest.approx((7.0 + 0.5 * gap, 6.0))
    assert opening(ring(gap), radius=0.49 * gap) is None


def test_a_wall_from_border_to_border_is_a_closed_way_and_one_to_no_border_is_none() -> None:
    wall = hull(np.array([[5.0, -1.0], [5.0, 11.0]]))
    found = opening([wall])
    assert found is not None
    assert found.radius == 0.0
    assert opening([wall], walled=False) is None
    short = hull(np.array([[5.0, 0.5], [5.0, 11.0]]))
    assert opening([short], radius=0.4) is None
    # The center stays within the border, so that a disc larger than the gap is too large.
    found = opening([short], radius=0.6)
    assert found is not None
    assert found.radius == pytest.approx(0.5)
    assert set(found.between) == {0, 1}


def test_one_that_starts_in_its_goal_is_there() -> None:
    barriers = Barriers.of(ring(), None, 1.0)
    assert barriers is not None
    place = np.array([8.0, 5.0])
    assert barriers.opening(place, (place - 0.2, place + 0.2)) is None


@pytest.mark.parametrize("seed", range(40))
def test_openings_are_those_of_another_library(seed: int) -> None:
    rng = np.random.default_rng(seed)
    pieces = []
    for _ in range(rng.integers(5, 40)):
        middle = rng.uniform(0.0, 10.0, 2)
        pieces.append(hull(middle + rng.uniform(-1.4, 1.4, (rng.integers(2, 6), 2))))
    place, end = np.array([2.0, 5.0]), np.array([8.0, 5.0])
    shapes = [shapely.MultiPoint(piece.vertices).convex_hull for piece in pieces]
    apart = [
        (piece, shape)
        for piece, shape in zip(pieces, shapes, strict=True)
        if min(shape.distance(shapely.Point(place)), shape.distance(shapely.Point(end))) > 0.2
    ]
    pieces, shapes = [piece for piece, _ in apart], [shape for _, shape in apart]
    barriers = Barriers.of(pieces, (LOW, HIGH), 3.0)
    assert barriers is not None
    found = barriers.opening(place, (end, end))

    def is_open(radius: float) -> bool:
        blocked = shapely.union_all([shape.buffer(radius, quad_segs=64) for shape in shapes])
        free = shapely.box(0.0, 0.0, 10.0, 10.0).difference(blocked)
        parts = shapely.get_parts(free)
        one, other = (shapely.contains(parts, shapely.Point(p)) for p in (place, end))
        return bool(np.any(one & other))

    widest = 3.0 if found is None else found.radius
    # Places themselves are taken by hulls that are too large.
    nearest = min(min(s.distance(shapely.Point(p)) for s in shapes) for p in (place, end))
    for radius in (0.98 * widest - 1e-3, 1.02 * widest + 1e-3):
        if 0.0 <= radius < 0.98 * nearest:
            assert is_open(radius) is (radius < widest)


@pytest.mark.parametrize("seed", range(20))
def test_nearest_points_are_those_of_another_library(seed: int) -> None:
    rng = np.random.default_rng(seed)
    pieces = [
        hull(rng.uniform(0.0, 3.0, 2) + rng.uniform(-1.0, 1.0, (rng.integers(1, 7), 2)))
        for _ in range(12)
    ]
    pieces.append(box([-9.0, -9.0], [9.0, 9.0]))
    pairs = np.array([(i, j) for i in range(13) for j in range(i)])
    distances, first, second = nearest_points(outlines_of_equal_length(pieces), pairs)
    shapes = [shapely.MultiPoint(piece.vertices).convex_hull for piece in pieces]
    for (i, j), distance, one, other in zip(pairs, distances, first, second, strict=True):
        assert distance == pytest.approx(shapes[i].distance(shapes[j]), abs=1e-9)
        assert np.linalg.norm(one - other) == pytest.approx(distance, abs=1e-9)
        assert shapes[i].distance(shapely.Point(one)) < 1e-9
        assert shapes[j].distance(shapely.Point(other)) < 1e-9
