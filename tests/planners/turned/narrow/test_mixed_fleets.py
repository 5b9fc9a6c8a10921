"""Vehicles of several sizes in narrow ways, and those that hurry so that others find a way."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pytest
from grid_worlds import cells

from radmpc.experiments.families import paper
from radmpc.model.obstacle import Obstacle
from radmpc.model.scenario import Scenario, Workspace
from radmpc.planners.certified.turned.detours import detours
from radmpc.planners.certified.turned.narrow.clear import Clear
from radmpc.planners.certified.turned.narrow.pacing import Pacing
from radmpc.planners.certified.turned.narrow.routes import shortest_routes
from radmpc.program.build import condensed_models
from radmpc.program.hazards import Hazards
from radmpc.records import replace


def hazards_of(scenario: Scenario) -> Hazards:
    return Hazards.of(scenario, condensed_models(scenario))


def never() -> bool:
    return False


def both_paced(hazards: Hazards) -> Mapping[int, np.ndarray]:
    """Return where two vehicles are at each step, each at a pace along its shortest route."""
    clear = Clear.of(hazards)
    assert clear is not None
    pacing = Pacing(hazards, clear, 1.0)
    pacing.offer(shortest_routes(hazards, clear, 1.0))
    placed = pacing.run(range(2), never)
    assert set(placed) == {0, 1}
    return placed


def test_the_center_of_any_hull_may_be_on_the_border() -> None:
    scenario = replace(paper(2, 0), workspace=Workspace([-20.0, -20.0], [20.0, 20.0]))
    small, large = scenario.vehicles
    vehicles = (replace(small, radius=0.5), replace(large, radius=2.0))
    clear = Clear.of(hazards_of(replace(scenario, vehicles=vehicles)))
    assert clear is not None
    for radius in (0.5, 2.0):
        room = clear.within_borders(radius).at(np.array([20.0, -20.0]))
        assert room == pytest.approx(radius, abs=0.5 * clear.grid.spacing)


def wedge_scene() -> Scenario:
    """One vehicle that has to pass a sharp wedge, where its center has a meter of room."""
    (vehicle,) = paper(1, 1).vehicles
    goal = replace(vehicle.goal, lower=[17.5, 1.5], upper=[18.5, 2.5])
    vehicle = replace(vehicle, radius=1.0, start=[2.0, 2.0, 0.0, 0.0], goal=goal)
    wedge = Obstacle.polygon("wedge", [[8.5, 0.0], [11.5, 0.0], [10.0, 6.0]])
    workspace = Workspace([0.0, 0.0], [20.0, 8.0])
    return replace(paper(1, 1), vehicles=(vehicle,), obstacles=(wedge,), workspace=workspace)


def test_a_route_leads_past_a_sharp_corner_where_there_is_room() -> None:
    hazards = hazards_of(wedge_scene())
    route = detours(hazards, [0])[0]
    beside = route[np.abs(route[:, 0] - 10.0).argmin()]
    assert 7.0 - 1e-9 <= beside[1] <= 8.0


def test_who_passes_first_hurries_if_others_find_no_pace_behind_it(tmp_path: Path) -> None:
    """The second one has just time to follow the first one, who starts in its way."""
    free = {(x, 0) for x in range(9)} | {(6, 1), (6, 2)}
    scenario = cells(tmp_path, (9, 3), free, [((2, 0), (6, 2)), ((8, 0), (0, 0))])
    scenario = replace(scenario, horizon=20)
    hazards = hazards_of(scenario)
    placed = both_paced(hazards)
    apart = np.linalg.norm(placed[0] - placed[1], axis=1)
    assert apart.min() >= hazards.radii.sum()


def test_who_stays_has_a_pace_like_all_others(tmp_path: Path) -> None:
    free = {(x, 0) for x in range(6)}
    scenario = cells(tmp_path, (6, 1), free, [((0, 0), (0, 0)), ((4, 0), (2, 0))])
    hazards = hazards_of(scenario)
    placed = both_paced(hazards)
    assert np.abs(placed[0] - placed[0][0]).max() < 1e-3
