"""What is worth a closer look: the same whether all is looked at or a tree and boxes tell."""

from __future__ import annotations

import numpy as np
import pytest

from radmpc.referee import neighbors
from radmpc.referee.neighbors import Balls, far_from_boxes, near_pairs


@pytest.mark.parametrize("few", [0, 1000])
@pytest.mark.parametrize("least", [0.0, 0.5], ids=["balls of all sizes", "balls alike"])
@pytest.mark.parametrize("count", [1, 2, 40])
def test_pairs_whose_balls_meet_in_some_window_are_found(
    count: int, least: float, few: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(neighbors, "_FEW", few)
    rng = np.random.default_rng(8)
    centers = rng.uniform(0.0, 10.0, (count, 3, 2))
    reaches = rng.uniform(least, 0.6, (count, 3))
    wanted = [
        [i, j]
        for i in range(count)
        for j in range(i + 1, count)
        if np.any(np.linalg.norm(centers[i] - centers[j], axis=1) <= reaches[i] + reaches[j])
    ]
    assert near_pairs(Balls(centers, reaches)).tolist() == wanted


@pytest.mark.parametrize("at_once", [1, 50, 10_000])
def test_who_is_far_from_a_box_has_an_axis_between_in_every_window(
    at_once: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(neighbors, "_AT_ONCE", at_once)
    rng = np.random.default_rng(9)
    centers, reaches = rng.uniform(0.0, 10.0, (30, 4, 2)), rng.uniform(0.0, 1.0, (30, 4))
    lower = rng.uniform(0.0, 9.0, (20, 4, 2))
    # Some stand still, and some are met by nobody.
    lower[::2] = lower[::2, :1]
    lower[:3] += 20.0
    boxes = [(each, each + 1.0) for each in lower]
    found = [far.tolist() for far in far_from_boxes(Balls(centers, reaches), boxes)]
    wanted = [
        [
            all(
                any(c[axis] - r >= high[axis] or c[axis] + r <= low[axis] for axis in range(2))
                for c, r, low, high in zip(centers[i], reaches[i], *box, strict=True)
            )
            for i in range(30)
        ]
        for box in boxes
    ]
    assert found == wanted
    assert 0 < np.sum(wanted) < np.size(wanted)


def test_without_boxes_there_is_nobody_to_tell_of() -> None:
    assert list(far_from_boxes(Balls(np.zeros((2, 3, 2)), np.ones((2, 3))), [])) == []


def test_a_box_that_stands_still_is_given_once_for_all_windows() -> None:
    rng = np.random.default_rng(4)
    balls = Balls(rng.uniform(0.0, 10.0, (9, 5, 3)), rng.uniform(0.0, 2.0, (9, 5)))
    lower = rng.uniform(0.0, 9.0, (12, 1, 3))
    once = [(each, each + 1.0) for each in lower]
    repeated = [(np.repeat(low, 5, axis=0), np.repeat(high, 5, axis=0)) for low, high in once]
    found = [far.tolist() for far in far_from_boxes(balls, once)]
    assert found == [far.tolist() for far in far_from_boxes(balls, repeated)]
    assert 0 < np.sum(found) < np.size(found)
