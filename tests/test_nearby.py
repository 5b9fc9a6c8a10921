"""Pairs of near points: few and many of them alike, each pair once and in order."""

from __future__ import annotations

import numpy as np
import pytest

from radmpc.nearby import near_pairs


@pytest.mark.parametrize("dimension", [2, 3])
@pytest.mark.parametrize("count", [0, 1, 2, 30, 64, 65, 200])
def test_every_near_pair_is_found_once_and_in_order(count: int, dimension: int) -> None:
    rng = np.random.default_rng(count)
    points = rng.uniform(0.0, 10.0, size=(count, dimension))
    wanted = [
        [i, j]
        for i in range(count)
        for j in range(i + 1, count)
        if np.linalg.norm(points[i] - points[j]) <= 2.0
    ]
    assert near_pairs(points, 2.0).tolist() == wanted
    assert near_pairs(points, 2.0).dtype == np.int64
