"""What a lattice search keeps of obstacles: where they block, and how near they are elsewhere."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest

from radmpc.planners.certified.lattice import slacks
from radmpc.planners.certified.lattice.half_planes import AvoidanceHalfPlanes
from radmpc.planners.certified.lattice.positions import Lattice
from radmpc.planners.certified.lattice.slacks import slacks_of


@pytest.fixture(params=["as installed", "without compiled code"])
def code(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    """Measure with and without compiled code."""
    if request.param == "without compiled code":
        monkeypatch.setattr(slacks, "is_compiled", lambda: False)


@pytest.mark.usefixtures("code")
@pytest.mark.parametrize("seed", range(4))
def test_displacements_are_blocked_or_near_as_the_best_alternative_says(seed: int) -> None:
    rng = np.random.default_rng(seed)
    shape, moves, bounds = (7, 6), 2, (-0.1, 0.8)
    first = np.array([-3, -2])
    reference = np.zeros((3, 2), dtype=np.int64)
    lattice = Lattice(np.array([0.5, 0.4]), rng.normal(size=2), reference, first, shape, moves)
    angles = rng.uniform(0.0, 2.0 * np.pi, 3)
    normals = np.column_stack([np.cos(angles), np.sin(angles)])
    here = np.column_stack([normals, rng.normal(size=3)])
    ahead = np.column_stack([normals, here[:, 2] + 0.1])
    move = np.array([1, 0])
    avoidance = AvoidanceHalfPlanes(here, ahead, 0.2)
    found = slacks_of(lattice, reference[0], move, avoidance, bounds)
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
    blocked = np.unpackbits(found.bits, count=expected.size).view(np.bool_)
    np.testing.assert_array_equal(blocked, expected.ravel() < bounds[0])
    near = np.flatnonzero((expected.ravel() >= bounds[0]) & (expected.ravel() < bounds[1]))
    np.testing.assert_array_equal(np.sort(found.numbers), near)
    single = np.finfo(np.float32).eps
    np.testing.assert_allclose(found.values, expected.ravel()[found.numbers], rtol=single)
    assert blocked.any()
    assert near.size


@pytest.mark.usefixtures("code")
def test_where_nothing_is_blocked_nothing_is_kept_of_it() -> None:
    lattice = Lattice(
        np.ones(2), np.zeros(2), np.zeros((2, 2), dtype=np.int64), np.zeros(2, int), (3, 3), 1
    )
    far = np.array([[1.0, 0.0, 50.0]])
    found = slacks_of(
        lattice, np.zeros(2, int), np.zeros(2, int), AvoidanceHalfPlanes(far, far, 1.0), (-1.0, 5.0)
    )
    assert not found.bits.size
    assert not found.numbers.size


@pytest.mark.parametrize("seed", range(3))
def test_lines_in_the_middles_of_gaps_are_measured_alike_by_both(
    seed: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    rng = np.random.default_rng(seed)
    lines = np.sort(rng.uniform(0.0, 4.0, 9)), np.sort(rng.uniform(0.0, 4.0, 8))
    still = np.zeros((2, 2), dtype=np.int64)
    lattice = Lattice(np.full(2, 0.5), np.zeros(2), still, still[0], (9, 8), 2, lines)
    angles = rng.uniform(0.0, 2.0 * np.pi, 4)
    normals = np.column_stack([np.cos(angles), np.sin(angles)])
    planes = np.column_stack([normals, normals.sum(axis=1) * 2.0 - 0.3])
    nothing = np.tile([0.0, 0.0, np.inf], (4, 1))
    avoidance = AvoidanceHalfPlanes(nothing, planes, 0.2)
    first = slacks_of(lattice, still[0], still[0], avoidance, (-0.1, 0.8))
    monkeypatch.setattr(slacks, "is_compiled", lambda: False)
    second = slacks_of(lattice, still[0], still[0], avoidance, (-0.1, 0.8))
    np.testing.assert_array_equal(first.bits, second.bits)
    one, two = (
        dict(zip(s.numbers.tolist(), s.values.tolist(), strict=True)) for s in (first, second)
    )
    assert one == two
    assert one
