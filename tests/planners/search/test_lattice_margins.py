"""What a lattice search keeps of obstacles: where they block, and how near they are elsewhere."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest

from radmpc.planners.certified.lattice.half_planes import AvoidanceHalfPlanes
from radmpc.planners.certified.lattice.margins import measured
from radmpc.planners.certified.lattice.moves import Lattice


@pytest.mark.parametrize("seed", range(4))
def test_displacements_are_blocked_or_near_as_the_best_alternative_says(seed: int) -> None:
    rng = np.random.default_rng(seed)
    shape, moves, slacks = (7, 6), 2, (-0.1, 0.8)
    first = np.array([-3, -2])
    reference = np.zeros((3, 2), dtype=np.int64)
    lattice = Lattice(np.array([0.5, 0.4]), rng.normal(size=2), reference, first, shape, moves)
    angles = rng.uniform(0.0, 2.0 * np.pi, 3)
    normals = np.column_stack([np.cos(angles), np.sin(angles)])
    here = np.column_stack([normals, rng.normal(size=3)])
    ahead = np.column_stack([normals, here[:, 2] + 0.1])
    move = np.array([1, 0])
    avoidance = AvoidanceHalfPlanes(here, ahead, 0.2)
    margin = measured(lattice, reference[0], move, avoidance, slacks)
    width = 2 * moves + 1
    expected = np.full((width, width, *shape), np.inf)
    for i, j, a, b in product(range(width), range(width), range(shape[0]), range(shape[1])):
        begin = lattice.start + lattice.stride * (first + np.array([a, b]))
        end = begin + lattice.stride * (np.array([i, j]) - moves + move)
        rooms = [
            min(one[2] - one[:2] @ begin, two[2] - two[:2] @ end)
            for one, two in zip(here, ahead, strict=True)
        ]
        expected[i, j, a, b] = max(rooms)
    blocked = margin.blocked(expected.size)
    assert blocked is not None
    np.testing.assert_array_equal(blocked, expected.ravel() < slacks[0])
    near = np.flatnonzero((expected.ravel() >= slacks[0]) & (expected.ravel() < slacks[1]))
    np.testing.assert_array_equal(np.sort(margin.places), near)
    np.testing.assert_allclose(margin.slacks, expected.ravel()[margin.places])
    assert blocked.any()
    assert near.size


def test_where_nothing_is_blocked_nothing_is_kept_of_it() -> None:
    lattice = Lattice(
        np.ones(2), np.zeros(2), np.zeros((2, 2), dtype=np.int64), np.zeros(2, int), (3, 3), 1
    )
    far = np.array([[1.0, 0.0, 50.0]])
    margin = measured(
        lattice, np.zeros(2, int), np.zeros(2, int), AvoidanceHalfPlanes(far, far, 1.0), (-1.0, 5.0)
    )
    assert margin.blocked(81) is None
    assert not margin.places.size
