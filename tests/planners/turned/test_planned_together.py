"""Vehicles with visits that are in each other's way, planned together, and goals side by side."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from visiting import scene, vehicle

from radmpc import Scenario, Visit
from radmpc.planners.certified.turned.half_spaces import half_spaces
from radmpc.planners.certified.turned.near import Near
from radmpc.planners.certified.turned.successive import SuccessiveLp
from radmpc.planners.certified.turned.touring.one_by_one import OneByOne
from radmpc.planners.certified.turned.touring.solo_plan import heights_on
from radmpc.program.build import condensed_models
from radmpc.program.hazards import Hazards
from radmpc.solvers.solution import Limits


def two_at_one_place() -> OneByOne:
    """Two that visit the same box at the same step, wide enough for both if each makes room."""
    visit = Visit.at([4.5, 0.0], 0.8, between=(5, 5))
    pair = (
        vehicle("a", [0.0, 0.0], [9.0, 0.0], visit),
        vehicle("b", [4.5, -5.0], [4.5, 5.0], visit),
    )
    given = Scenario("one place", 1.0, 10, 0.01, pair)
    successive = OneByOne(Hazards.of(given, condensed_models(given)), Limits())
    assert successive.begin_alone()
    return successive


def test_two_that_visit_one_place_at_once_make_room_together() -> None:
    successive = two_at_one_place()
    missing, pairs = successive.conflicts(3.0)
    assert pairs == [(0, 1)]
    assert missing.min() > 0.1
    successive.keep_clear_together((0, 1), 3.0, (6, 300.0))
    assert successive.missing(3.0).max() < 0.01


def test_heights_are_those_that_half_spaces_have_on_their_own_paths() -> None:
    given = scene(Visit.at([4.0, 3.0], 0.5, between=(4, 4)), horizon=8)
    other = vehicle("b", [9.0, 3.0], [0.0, 3.0])
    given = replace(given, vehicles=(*given.vehicles, other))
    successive = SuccessiveLp(Hazards.of(given, condensed_models(given)), Limits())
    assert successive.begin_alone()
    near = Near(3.0, 3.0, is_refined=False)
    spaces = half_spaces(successive.hazards, successive.paths, (0, 1), near)
    assert {-1, 1} <= set(spaces.second.tolist())
    found = heights_on(successive.paths, spaces)
    assert np.allclose(found, spaces.heights, rtol=0.0, atol=1e-9)
    before = found.copy()
    successive.refer(0, successive.paths.means[0] + [0.0, 1.0])
    moved = heights_on(successive.paths, spaces) - before
    # Straight chords, all a meter further north: what the normal makes of it, and no reserve less.
    mine = (spaces.first == 0) & (spaces.windows > 0)
    assert np.all(moved[mine] >= spaces.normals[mine, 1:] - 1e-9)
    assert moved[mine][:, 1].max() > 0.5


@pytest.mark.parametrize("gap", [1.0, 1.2])
def test_neighbors_whose_last_legs_cross_arrive_side_by_side(gap: float) -> None:
    north = vehicle("a", [0.0, 9.0], [12.0, 0.0], Visit.at([10.0, 9.0], 0.5, between=(7, 7)))
    south = vehicle("b", [0.0, -9.0], [12.0, gap], Visit.at([10.0, -9.0], 0.5, between=(6, 6)))
    pair = tuple(replace(each, control_limit=4.0) for each in (north, south))
    given = Scenario("side by side", 1.0, 10, 0.01, pair)
    successive = SuccessiveLp(Hazards.of(given, condensed_models(given)), Limits())
    assert successive.begin_alone()
    assert successive.keep_apart(3.0, 20)
