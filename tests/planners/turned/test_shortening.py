"""Joint routes that are shortened are still joint routes, and nobody comes later."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from radmpc.planners.certified.turned.narrow.joint_search import joint_search
from radmpc.planners.certified.turned.narrow.shortening import shortened

SIDE = 6


def graph(rng: np.random.Generator) -> list[list[int]]:
    """Return the cells of a grid next to each cell, some of them blocked."""
    is_open = rng.random((SIDE, SIDE)) > 0.12
    numbers = np.full((SIDE + 2, SIDE + 2), -1)
    numbers[1:-1, 1:-1][is_open] = np.arange(int(is_open.sum()))
    around = ((0, 1), (1, 0), (0, -1), (-1, 0))
    return [
        [int(numbers[x + a, y + b]) for a, b in around if numbers[x + a, y + b] >= 0]
        for x, y in np.argwhere(numbers >= 0).tolist()
    ]


def arrivals(routes: list[tuple[int, ...]]) -> list[int]:
    """Return the tick from which on each vehicle stays where it ends."""
    at = np.array(routes)
    return [
        max((k + 1 for k in range(len(at)) if at[k, i] != at[-1, i]), default=0)
        for i in range(at.shape[1])
    ]


@pytest.mark.parametrize("seed", range(25))
def test_shortened_routes_keep_apart_and_arrive_no_later(seed: int) -> None:
    rng = np.random.default_rng(seed)
    neighbors = graph(rng)
    count = 8
    starts, goals = (
        tuple(rng.choice(len(neighbors), count, replace=False).tolist()) for _ in range(2)
    )
    drawn = joint_search(neighbors, starts, goals, 2000, rng, lambda: False)
    if not drawn:
        return
    found = shortened(neighbors, drawn, 4)
    assert found[0] == starts
    assert found[-1] == goals
    for here, there in pairwise(found):
        assert len(set(there)) == count
        edges = {(a, b) for a, b in zip(here, there, strict=True) if a != b}
        assert all(b in neighbors[a] for a, b in edges)
        assert not any((b, a) in edges for a, b in edges)
    late = zip(arrivals(found), arrivals(drawn), strict=True)
    assert all(now <= before for now, before in late)
    assert len(found) == max(arrivals(found)) + 1


def test_who_wanders_goes_straight() -> None:
    lane = [[1], [0, 2], [1, 3], [2]]
    wandering = [(0,), (1,), (0,), (1,), (2,), (2,), (3,), (2,), (3,)]
    assert shortened(lane, wandering, 1) == [(0,), (1,), (2,), (3,)]
