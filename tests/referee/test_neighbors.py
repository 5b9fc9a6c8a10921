"""Pairs worth a closer look: the same whether all are looked at or a tree proposes them."""

from __future__ import annotations

import numpy as np
import pytest

from radmpc.referee import neighbors
from radmpc.referee.neighbors import Balls, near_pairs


@pytest.mark.parametrize("few", [0, 1000])
@pytest.mark.parametrize("count", [1, 2, 40])
def test_pairs_whose_balls_meet_in_some_window_are_found(
    count: int, few: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(neighbors, "_FEW", few)
    rng = np.random.default_rng(8)
    centers = rng.uniform(0.0, 10.0, (count, 3, 2))
    reaches = rng.uniform(0.0, 0.6, (count, 3))
    wanted = [
        [i, j]
        for i in range(count)
        for j in range(i + 1, count)
        if np.any(np.linalg.norm(centers[i] - centers[j], axis=1) <= reaches[i] + reaches[j])
    ]
    assert near_pairs(Balls(centers, reaches)).tolist() == wanted
