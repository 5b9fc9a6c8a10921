"""Of several routes around obstacles a first plan begins with the one of least effort."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import pytest

from radmpc.arrays import Matrix
from radmpc.experiments.families import clutter, paper
from radmpc.model.obstacle import Obstacle
from radmpc.planners.certified.turned.detours import Toll, detours
from radmpc.planners.certified.turned.grid import Grid
from radmpc.planners.certified.turned.narrow import cheapest
from radmpc.planners.certified.turned.narrow.cheapest import cheapest_routes
from radmpc.planners.certified.turned.paths import timed_by_visits
from radmpc.planners.certified.turned.successive import SuccessiveLp
from radmpc.planners.certified.turned.tuning import TUNING
from radmpc.program.build import condensed_models
from radmpc.program.hazards import Hazards
from radmpc.solvers.solution import Limits

CLEARANCE = 2.5


def efforts(hazards: Hazards, routes: Mapping[int, Matrix]) -> list[float]:
    """Return everyone's effort once all are kept apart, begun with some routes."""
    successive = SuccessiveLp(hazards, Limits())
    assert successive.begin_alone()
    for i, route in routes.items():
        successive.refer(i, timed_by_visits(hazards.models[i], route))
    assert successive.keep_apart(CLEARANCE, TUNING.max_sweeps)
    return [float(np.abs(u).sum()) for u in successive.paths.controls]


def chosen(hazards: Hazards) -> dict[int, Matrix]:
    """Return the routes of all vehicles that a first plan would begin with."""
    alone = SuccessiveLp(hazards, Limits())
    assert alone.begin_alone()
    everyone = range(hazards.count)
    return cheapest_routes(hazards, alone.paths, everyone, CLEARANCE, Limits())


def test_who_would_go_far_around_goes_through_a_gap_where_that_takes_less_effort() -> None:
    scenario = clutter(2, 100, 9)
    hazards = Hazards.of(scenario, condensed_models(scenario))
    shortest = efforts(hazards, detours(hazards, [0, 1], CLEARANCE))
    ours = efforts(hazards, chosen(hazards))
    assert ours[0] < 0.7 * shortest[0]


def test_in_large_fleets_the_shortest_way_is_taken(monkeypatch: pytest.MonkeyPatch) -> None:
    scenario = clutter(2, 100, 9)
    hazards = Hazards.of(scenario, condensed_models(scenario))
    monkeypatch.setattr(cheapest, "TUNING", replace(TUNING, weighed=1))
    routes, shortest = chosen(hazards), detours(hazards, [0, 1], CLEARANCE)
    assert routes.keys() == shortest.keys()
    assert all(np.array_equal(routes[i], shortest[i]) for i in routes)


def test_a_way_beside_another_leads_through_another_gap() -> None:
    (vehicle,) = paper(1, 1).vehicles
    goal = replace(vehicle.goal, lower=[9.5, -0.5], upper=[10.5, 0.5])
    vehicle = replace(vehicle, start=[0.0, 0.0, 0.0, 0.0], goal=goal)
    # Gaps at y = 0 and y = 3.
    bars = [(-8.0, -1.0), (1.0, 2.0), (4.0, 12.0)]
    walls = [Obstacle.box(f"bar{k}", [4.8, low], [5.2, high]) for k, (low, high) in enumerate(bars)]
    scenario = replace(paper(1, 1), vehicles=(vehicle,), obstacles=tuple(walls), workspace=None)
    hazards = Hazards.of(scenario, condensed_models(scenario))
    grid = Grid.of(hazards)
    first = detours(hazards, [0], 0.0, grid)[0]
    second = detours(hazards, [0], 0.0, grid, Toll(beside=(first,)))[0]
    heights = [route[np.abs(route[:, 0] - 5.0).argmin(), 1] for route in (first, second)]
    assert abs(heights[0]) < 1.0
    assert 2.0 < heights[1] < 4.0
