"""Vehicles planned one after the other on a grid in space and time."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from grid_worlds import cells

from radmpc.planners.certified.turned.narrow import prioritized
from radmpc.planners.certified.turned.narrow.prioritized import prioritized_ticks
from radmpc.program.build import condensed_models
from radmpc.program.hazards import Hazards


def never() -> bool:
    return False


def lane(path: Path, bays: list[int], robots: list) -> Hazards:
    """Seven cells in a row, and bays beside some of them."""
    free = {(x, 0) for x in range(7)} | {(x, 1) for x in bays}
    scenario = cells(path, (7, 2), free, robots)
    return Hazards.of(scenario, condensed_models(scenario))


def test_who_was_planned_among_the_same_vehicles_before_is_not_planned_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    hazards = lane(tmp_path, [3, 2], [((5, 0), (5, 0)), ((0, 0), (2, 1)), ((6, 0), (2, 0))])
    planned: list[tuple[int, ...]] = []
    blocked = prioritized._blocked

    def counted(*given: object) -> object:
        _, _, i, placed, _ = given
        planned.append((*placed, i))
        return blocked(*given)

    monkeypatch.setattr(prioritized, "_blocked", counted)
    assert prioritized_ticks(hazards, never)[0] == {}
    firsts = [each for each in planned if len(each) == 1]
    assert len(firsts) > 1
    assert len(set(planned)) == len(planned)


def test_routes_are_the_same_whether_the_costs_of_all_ticks_are_kept_or_of_some(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    hazards = lane(tmp_path, [3], [((0, 0), (6, 0)), ((3, 1), (3, 1))])
    placed, ticks = prioritized_ticks(hazards, never)
    assert sorted(placed) == [0, 1]
    monkeypatch.setattr(prioritized, "_MOST_KEPT", 0)
    again, same = prioritized_ticks(hazards, never)
    assert same == ticks
    for i, route in placed.items():
        assert np.array_equal(route, again[i])


def test_a_route_is_the_shortest_and_waits_where_that_costs_least(tmp_path: Path) -> None:
    hazards = lane(tmp_path, [], [((0, 0), (6, 0))])
    placed, _ = prioritized_ticks(hazards, never)
    moves = np.linalg.norm(np.diff(placed[0], axis=0), axis=1)
    goal = hazards.models[0].vehicle.goal.center
    # From one end of the lane to the other, past no point twice.
    assert np.count_nonzero(moves) < len(moves)
    assert moves.sum() == pytest.approx(np.linalg.norm(placed[0][0] - placed[0][-1]))
    assert np.linalg.norm(placed[0][-1] - goal) < 0.5 * float(hazards.radii[0])
