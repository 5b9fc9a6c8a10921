"""Flat and turning solids: hits are those that a fine search in time finds."""

from __future__ import annotations

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import nnls

from radmpc.arrays import Matrix
from radmpc.geometry import Polytope, box, hull
from radmpc.referee.contact import solid_distances, solid_of
from radmpc.referee.simulation.collisions import meets_solid
from radmpc.referee.simulation.sweep import resting, swept
from radmpc.referee.simulation.turning import TurningSolid
from sampling import examples

SEEDS = st.integers(0, 2**32 - 1)
COUNT = 40


def turned(points: Matrix, rng: np.random.Generator) -> Matrix:
    d = points.shape[1]
    spin = np.linalg.qr(np.eye(d) + 0.5 * rng.normal(size=(d, d)))[0]
    return np.asarray(points @ spin + rng.uniform(-2.0, 2.0, d))


def gap(place: Matrix, corners: Matrix) -> float:
    """Distance from the hull of corners by non-negative least squares."""
    rows = np.vstack([(corners - place).T, np.full(len(corners), 1e4)])
    return float(nnls(rows, np.append(np.zeros(len(place)), 1e4))[1])


def least_gap(begin: Matrix, end: Matrix, sagitta: Matrix, before: Matrix, after: Matrix) -> float:
    """Least distance over 161 times of the interval."""
    d = begin.size
    gaps = []
    for t in np.linspace(0.0, 1.0, 161):
        place = begin + t * (end - begin) - 4.0 * t * (1.0 - t) * sagitta
        corners = ((1.0 - t) * before[:, None] + t * after[None]).reshape(-1, d)
        gaps.append(gap(place, corners))
    return min(gaps)


@pytest.mark.slow
@settings(max_examples=examples(12), deadline=None, derandomize=True)
@given(SEEDS, st.sampled_from([2, 3]), st.booleans(), st.booleans())
def test_what_hits_a_turning_solid_is_what_comes_near_it(
    seed: int, d: int, is_flat: bool, is_bent: bool
) -> None:
    rng = np.random.default_rng(seed)
    before = rng.uniform(-1.0, 1.0, (d if is_flat else d + 2, d))
    after = turned(before, rng)
    begin, end = rng.uniform(-3.0, 3.0, (2, 12, d))
    sagittas = np.tile(0.2 * is_bent * rng.normal(size=d), (12, 1))
    gaps = [least_gap(b, e, w, before, after) for b, e, w in zip(begin, end, sagittas, strict=True)]
    radius = float(np.median(gaps)) + 1e-3
    found = meets_solid(begin, end, sagittas, np.full(12, radius), swept(hull(before), hull(after)))
    # Between two of the times nothing moves by more than 7 m / 160 / 2; chords are off by 1 mm.
    slack = 0.03 + 1e-3 * is_bent
    for is_hit, least in zip(found, gaps, strict=True):
        assert is_hit == (least < radius) or radius <= least <= radius + slack


@pytest.mark.parametrize("d", [2, 3])
def test_grazing_a_turning_solid_is_decided_to_the_micrometer(d: int) -> None:
    # A wall that swings down past a vehicle at rest: nearest at the end, 0.5 m away.
    wall = np.zeros((2, d))
    wall[1, 1] = 2.0
    fallen = np.zeros((2, d))
    fallen[1, 0] = 2.0
    place = np.zeros((2, d))
    place[:, :2] = [1.0, -0.5]
    found = meets_solid(
        place, place, np.zeros((2, d)), np.array([0.5 - 1e-6, 0.5 + 1e-6]),
        swept(hull(wall), hull(fallen)),
    )  # fmt: skip
    assert found.tolist() == [False, True]


def test_what_turns_is_one_solid_however_far_it_turns() -> None:
    square = box([-1, -1], [1, 1])
    (part,) = swept(square, hull(square.vertices @ np.array([[0.6, 0.8], [-0.8, 0.6]])))
    assert isinstance(part.solid, TurningSolid)
    for t in np.linspace(0.0, 1.0, 9):
        angles = np.linspace(0.0, 2.0 * np.pi, 50)
        directions = np.column_stack([np.cos(angles), np.sin(angles)])
        wanted = (1.0 - t) * square.support(directions)
        wanted += t * (directions @ (part.solid.corners[1]).T).max(axis=1)
        now = part.solid.during(t, 1.0)
        np.testing.assert_allclose((directions @ now.corners[0].T).max(axis=1), wanted, atol=1e-9)
        np.testing.assert_allclose(
            now.offsets[0], (now.normals @ now.corners[0].T).max(axis=1), atol=1e-9
        )


@settings(max_examples=examples(40), deadline=None, derandomize=True)
@given(SEEDS, st.sampled_from([1, 2]))
def test_planar_distances_from_walls_and_posts_are_those_of_shapely(
    seed: int, corners: int
) -> None:
    rng = np.random.default_rng(seed)
    points = rng.uniform(-1.0, 1.0, (corners, 2))
    begin, end = rng.uniform(-3.0, 3.0, (2, COUNT, 2))
    end[:5] = begin[:5]
    found = solid_distances(begin, end, solid_of(hull(points)))
    lines = shapely.linestrings(np.stack([begin, end], axis=1))
    lines[:5] = shapely.points(begin[:5])
    thing = shapely.LineString(points) if corners == 2 else shapely.Point(points[0])
    np.testing.assert_allclose(found, shapely.distance(lines, thing), atol=1e-9)


FLAT: list[tuple[Polytope, list[float], list[float], float]] = [
    (hull([[0, 0], [3, 4]]), [0, 4], [3, 0], 0.0),  # across a wall
    (box([1, -2], [1, 5]), [-3, 0], [7, 0.3], 0.0),
    (box([1, -2], [1, 5]), [-3, 6], [7, 6], 1.0),  # past its end
    (box([1, 0, 0], [1, 2, 2]), [-1, 1, 1], [4, 1, 1.5], 0.0),  # through a plate
    (box([1, 0, 0], [1, 2, 2]), [-1, 3, 1], [4, 3, 1], 1.0),  # past its edge
    (box([1, 0, 0], [1, 2, 2]), [3, 1, 1], [3, 1, 1], 2.0),  # above it
    (hull([[0, 0, 0], [0, 0, 4]]), [-1, 1, 2], [1, 1, 2], 1.0),  # past a wire
    (hull([[0, 0, 0]]), [-1, 1, 0], [1, 1, 0], 1.0),  # past a ball's center
]


@pytest.mark.parametrize(("piece", "begin", "end", "distance"), FLAT)
def test_distances_from_things_without_thickness(
    piece: Polytope, begin: list[float], end: list[float], distance: float
) -> None:
    found = solid_distances(np.array([begin], float), np.array([end], float), solid_of(piece))
    assert found[0] == pytest.approx(distance, abs=1e-12)


@settings(max_examples=examples(60), deadline=None, derandomize=True)
@given(SEEDS, st.sampled_from([2, 3]), st.booleans())
def test_a_wall_without_thickness_cannot_be_jumped(seed: int, d: int, is_moving: bool) -> None:
    rng = np.random.default_rng(seed)
    scale = 10.0 ** rng.uniform(-1.0, 4.0)
    corners = scale * rng.uniform(-1.0, 1.0, (d, d))
    drift = scale * rng.uniform(-1.0, 1.0, d) * is_moving
    inner = rng.dirichlet(np.ones(d), COUNT) @ corners
    normal = np.linalg.svd(corners[1:] - corners[0])[2][-1]
    away = scale * rng.uniform(0.2, 1.0, (2, COUNT, 1)) * normal
    begin, end = inner + away[0], inner - away[1] + drift
    # A hair's radius: only the crossing itself can be seen.
    radii = np.full(COUNT, 1e-6)
    still = np.zeros((COUNT, d))
    parts = swept(hull(corners), hull(corners + drift)) if is_moving else resting(hull(corners))
    assert meets_solid(begin, end, still, radii, parts).all()
    assert not meets_solid(begin, begin + drift, still, radii, parts).any()
