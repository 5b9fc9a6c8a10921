"""Whom a first look by boxes lets through to the look window by window."""

from __future__ import annotations

import numpy as np
import pytest

from radmpc.experiments.families import fleet
from radmpc.planners.certified.turned import neighbors
from radmpc.planners.certified.turned.half_spaces import half_spaces
from radmpc.planners.certified.turned.near import Near
from radmpc.planners.certified.turned.paths import Paths
from radmpc.program.build import condensed_models
from radmpc.program.hazards import Hazards

NEAR = Near(3.0, 6.0, is_refined=False)


@pytest.fixture(scope="module")
def scene() -> tuple[Hazards, Paths]:
    """Twenty-four vehicles on random paths."""
    scenario = fleet(24, 1)
    hazards = Hazards.of(scenario, condensed_models(scenario))
    paths, rng = Paths(hazards), np.random.default_rng(4)
    for i, model in enumerate(hazards.models):
        paths.fly(i, rng.uniform(-0.3, 0.3, model.control_bounds.shape))
    return hazards, paths


@pytest.mark.parametrize("group", [(3,), (0, 5, 6, 17), tuple(range(24))])
def test_every_window_in_which_vehicles_come_near_gets_a_half_space(
    scene: tuple[Hazards, Paths], group: tuple[int, ...]
) -> None:
    hazards, paths = scene
    expected = set()
    for i in group:
        for j in range(hazards.count):
            if j == i or (j in group and j < i):
                continue
            apart = np.linalg.norm(paths.means[i, 1:] - paths.means[j, 1:], axis=1)
            spread = np.sqrt(hazards.variances[i] + hazards.variances[j])
            limit = hazards.radii[i] + hazards.radii[j] + 3.0 * spread + 6.0
            expected |= {(i, j, int(k)) for k in np.flatnonzero(apart < limit)}
    found = half_spaces(hazards, paths, group, NEAR)
    pairs = zip(found.first.tolist(), found.second.tolist(), found.windows.tolist(), strict=True)

    assert expected
    assert {pair for pair in pairs if pair[1] >= 0} == expected


def test_many_vehicles_are_looked_through_by_a_tree_to_the_same_end(
    scene: tuple[Hazards, Paths], monkeypatch: pytest.MonkeyPatch
) -> None:
    by_boxes = half_spaces(*scene, tuple(range(24)), NEAR)
    monkeypatch.setattr(neighbors, "_MANY_PAIRS", 0)
    by_tree = half_spaces(*scene, tuple(range(24)), NEAR)

    assert set(by_tree.keys.tolist()) == set(by_boxes.keys.tolist())
